// One coordinate of every photon as an ordered integer; or its index.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "search/map_records.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    PhotonRows photons;
    Words keys;
    uint count;
    // 3 for the index.
    uint axis;
} push;

void main() {
    uint i = thread();
    if (i >= push.count) return;
    push.keys[i].word = push.axis < 3 ? ordered(photon_position(push.photons, i)[push.axis]) : i;
}
