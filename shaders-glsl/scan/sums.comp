// Prefix sums, first of three kernels: the sum of every tile.
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
    Words sums;
    uint count;
} push;

void main() {
    uint base = workgroup() * gl_WorkGroupSize.x * SCAN_ITEMS;
    // Rows of workgroups fill a rectangle, which may have more workgroups than there are tiles.
    if (workgroup() >= (push.count - 1) / (gl_WorkGroupSize.x * SCAN_ITEMS) + 1) return;
    uint first = scan_first(base);
    uint sum = 0;
    [[unroll]] for (uint i = 0; i < SCAN_ITEMS; i++) {
        uint at = first + i * gl_SubgroupSize;
        if (at < push.count) sum += push.from[at].word;
    }
    sum = group_sum(sum);
    if (group_rank() == 0) push.sums[workgroup()].word = sum;
}
