// Gathers words of photons by photon index.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "device/words.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    Words words;
    Words order;
    Words gathered;
    uint count;
} push;

void main() {
    uint i = thread();
    if (i < push.count) push.gathered[i].word = push.words[push.order[i].word].word;
}
