// Queries that have closed ranks elsewhere come back to where they belong.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

#include "device/grid.glsl"
#include "shading/layout.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Words { uint at; };

layout(push_constant, scalar) uniform Push {
    Queries from;
    Queries queries;
    // How many stand before each pixel, and altogether.
    Words offsets;
    Words total;
    // The pixels whose queries these are, and all.
    uint start;
    uint end;
    uint pixels;
} push;

void main() {
    uint i = thread();
    uint first = push.offsets[push.start].at;
    uint last = push.end < push.pixels ? push.offsets[push.end].at : push.total.at;
    if (i < last - first) push.queries[first + i].at = push.from[i].at;
}
