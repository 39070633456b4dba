// Prefix sums, third of three kernels: within every tile, starting at the sum of the tiles before it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "scan/scan_tile.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    Words from;
    Words to;
    Words sums;
    uint count;
} push;

void main() {
    uint tile = gl_WorkGroupSize.x * SCAN_ITEMS;
    if (workgroup() >= (push.count - 1) / tile + 1) return;
    scan_tile(push.from, push.to, workgroup() * tile, push.count, push.sums[workgroup()].word);
}
