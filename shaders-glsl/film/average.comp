// Divides light of the current pass by the number of its camera samples. One invocation per number.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "film/film.glsl"
#include "device/grid.glsl"

layout(push_constant, scalar) uniform Push {
    Planes pass;
    uint numbers;
    float samples;
} push;

void main() {
    uint i = thread();
    if (i < push.numbers) (push.pass + i).at /= push.samples;
}
