// One level of the VVH tree, fourth of four kernels: partitions every segment of every list.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "search/list_part.glsl"
#include "index/vvh_records.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Words lists;
    Words parted;
    VvhSegments segments;
    VvhJobs jobs;
    VvhTiles tiles;
    // Number of photons that go left, by list, then by tile.
    Words counts;
    uint count;
    uint room;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    uint offset = gl_WorkGroupID.y * push.count;
    Words counts = push.counts + gl_WorkGroupID.y * push.room;
    for (uint job = gl_WorkGroupID.x; job < push.jobs.count; job += gl_NumWorkGroups.x) {
        uint segment = push.tiles[job].segment;
        uint first = push.segments[segment].first;
        uint done = push.tiles[job].tile * LIST_TILE;
        uint end = min(first + done + LIST_TILE, first + push.segments[segment].size);
        uint before = list_before(counts, push.segments[segment].first_job, job);
        uint next_right = first + push.segments[segment].left + done - before;
        list_part(push.lists + offset, push.parted + offset, first + done, end, first + before, next_right);
    }
}
