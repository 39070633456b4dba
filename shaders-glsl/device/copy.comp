// Copies words; used by tests of the device layer.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint word; };

layout(push_constant, scalar) uniform Push {
    Words from;
    Words to;
    uint count;
    uint plus;
} push;

void main() {
    uint i = thread();
    if (i < push.count) push.to[i].word = push.from[i].word + push.plus;
}
