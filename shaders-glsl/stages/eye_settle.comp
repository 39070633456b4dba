// Copies compacted queries from scratch memory to their final positions.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Words { uint at; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Queries from;
    Queries queries;
    // Number of queries before each pixel, and in total.
    Words offsets;
    Words total;
    // Range of pixels whose queries these are, and number of all pixels.
    uint start;
    uint end;
    uint pixels;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint i = thread();
    uint first = push.offsets[push.start].at;
    uint last = push.end < push.pixels ? push.offsets[push.end].at : push.total.at;
    if (i < last - first) push.queries[first + i].at = push.from[i].at;
}
