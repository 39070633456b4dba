// The Morton code of every photon: its lower word, twice, and its higher word.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "search/map_records.glsl"
#include "index/morton.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    MapState state;
    // The keys that are sorted first.
    Words keys;
    Words low;
    Words high;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uvec3 low = from_ordered3(uvec3(push.state.low[0], push.state.low[1], push.state.low[2]));
    uvec3 high = from_ordered3(uvec3(push.state.high[0], push.state.high[1], push.state.high[2]));
    uvec2 code = morton_code(grid_over(low, high), photon_position(push.photons, i));
    push.keys[i].word = code.x;
    push.low[i].word = code.x;
    push.high[i].word = code.y;
}
