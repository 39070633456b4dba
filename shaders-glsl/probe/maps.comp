// Adds up the power of the photons of each of eight maps: one invocation for each map.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"

const uint MAPS = 8u;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Sums { vec3 at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Photons photons[MAPS];
    Words counts[MAPS];
    Sums sums[MAPS];
    // Index of the sum to write.
    uint index;
    float factor;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint map = thread();
    if (map >= MAPS) return;
    vec3 sum = vec3(0.0);
    uint count = push.counts[map].at;
    for (uint i = 0u; i < count; ++i) sum += push.photons[map][i].at.power;
    push.sums[map][push.index].at = push.factor * sum;
}
