// One level of the median tree, second of three kernels: marks in every list the photons that go right, and
// counts in every tile those that go left.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "device/grid.glsl"
#include "scan/group_scan.glsl"
#include "search/lists.glsl"

layout(local_size_x_id = 1) in;

layout(push_constant, scalar) uniform Push {
    Words lists;
    // One bit per photon.
    Words right;
    // By list, then by tile.
    Words counts;
    uint count;
    uint tiles;
} push;

void main() {
    if (workgroup() >= 3 * push.tiles) return;
    Words list = push.lists + workgroup() / push.tiles * push.count;
    uint base = workgroup() % push.tiles * LIST_TILE;
    uint end = min(base + LIST_TILE, push.count);
    uint left = 0;
    for (uint at = base + gl_LocalInvocationIndex; at < end; at += gl_WorkGroupSize.x) {
        uint photon = list[at].word;
        uint right = push.right[photon / 32].word >> photon % 32 & 1;
        list[at].word = photon | right << 31;
        left += 1 - right;
    }
    left = group_sum(left);
    if (group_rank() == 0) push.counts[workgroup()].word = left;
}
