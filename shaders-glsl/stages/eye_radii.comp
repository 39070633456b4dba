// Multiplies each query's radius by its pixel's factor.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Factors { float at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(push_constant, scalar) uniform Push {
    Queries queries;
    Count count;
    Factors factors;
    uint pixels;
} push;

void main() {
    uint i = thread();
    if (i >= min(push.count.needed, push.count.capacity)) return;
    uint pixel = push.queries[i].at.pixel;
    if (pixel < push.pixels) push.queries[i].at.radius *= push.factors[pixel].at;
}
