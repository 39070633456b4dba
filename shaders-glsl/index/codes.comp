// The Morton code of every photon.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "grid.glsl"
#include "map_records.glsl"
#include "morton.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer Codes { uvec2 code; };

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    MapState state;
    Codes codes;
    uint count;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    uvec3 low = from_ordered3(uvec3(push.state.low[0], push.state.low[1], push.state.low[2]));
    uvec3 high = from_ordered3(uvec3(push.state.high[0], push.state.high[1], push.state.high[2]));
    push.codes[i].code = morton_code(grid_over(low, high), photon_position(push.photons, i));
}
