// One level of the VVH tree, third of four kernels: marks in every list the photons that go right, and counts
// in every tile those that go left.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "scan/group_scan.glsl"
#include "search/lists.glsl"
#include "index/vvh_records.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Words lists;
    VvhSegments segments;
    VvhJobs jobs;
    VvhTiles tiles;
    // One bit per photon.
    Words right;
    // By list, then by tile.
    Words counts;
    uint count;
    // Maximum number of tiles.
    uint room;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    Words list = push.lists + gl_WorkGroupID.y * push.count;
    for (uint job = gl_WorkGroupID.x; job < push.jobs.count; job += gl_NumWorkGroups.x) {
        uint segment = push.tiles[job].segment;
        uint first = push.segments[segment].first;
        uint base = first + push.tiles[job].tile * LIST_TILE;
        uint end = min(base + LIST_TILE, first + push.segments[segment].size);
        uint left = 0;
        for (uint at = base + gl_LocalInvocationIndex; at < end; at += gl_WorkGroupSize.x) {
            uint photon = list[at].word;
            uint right = push.right[photon / 32].word >> photon % 32 & 1;
            list[at].word = photon | right << 31;
            left += 1 - right;
        }
        left = group_sum(left);
        if (group_rank() == 0) push.counts[gl_WorkGroupID.y * push.room + job].word = left;
    }
}
