// One level of the VVH tree, first of four kernels: decides where each segment is split, one workgroup per
// segment, and lists its tiles and the segments of the next level.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#define VVH_ROWS 1
#include "index/vvh.glsl"
#include "index/vvh_records.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    // Sorted by x, y, z, and index.
    Words lists;
    VvhLevel level;
    VvhSegments segments;
    VvhLevel next_level;
    VvhSegments next_segments;
    VvhJobs jobs;
    VvhTiles tiles;
    VvhLevel short_level;
    VvhShorts shorts;
    // Number of blocks in the left part of every split, by the split's index in preorder.
    Words splits;
    uint count;
    // Bit 31: which of the two buffers the parts will be in.
    uint parity;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

shared uint first_job;

void add(uint first, uint length, uint splits, uint depth) {
    if (length > LIST_SHORT) {
        uint at = atomicAdd(push.next_level.count, 1);
        push.next_segments[at].first = first;
        push.next_segments[at].size = length;
        push.next_segments[at].splits = splits;
        push.next_segments[at].depth = depth;
        atomicMax(push.next_level.groups[0], min(at + 1, VVH_GROUPS));
    } else {
        uint at = atomicAdd(push.short_level.count, 1);
        push.shorts[at].first = first;
        push.shorts[at].size = length;
        push.shorts[at].splits = splits;
        push.shorts[at].depth = depth | push.parity;
        atomicMax(push.short_level.groups[0], min(at + 1, VVH_GROUPS));
    }
}

void main() {
    uint local = gl_LocalInvocationIndex;
    for (uint number = gl_WorkGroupID.x; number < push.level.count; number += gl_NumWorkGroups.x) {
        uint first = push.segments[number].first;
        uint length = push.segments[number].size;
        uint depth = push.segments[number].depth;
        uvec3 low, high;
        list_box(push.photons, push.lists, push.count, first, length, low, high);
        uint extent;
        uint axis = longest_axis(low, high, extent);
        float scale = slab_scale(length, depth, extent);
        for (uint slab = local; slab < VVH_SLABS; slab += gl_WorkGroupSize.x) slab_counts[slab] = 0;
        barrier();
        if (scale > 0.0) {
            Words by_number = push.lists + 3 * push.count;
            uint stride = vvh_stride(length);
            for (uint at = local * stride; at < length; at += gl_WorkGroupSize.x * stride) {
                uvec3 position = photon_position(push.photons, by_number[first + at].word);
                atomicAdd(slab_counts[slab_of(position[axis], low[axis], scale)], 1);
            }
        }
        barrier();
        uint tiles = (length - 1) / LIST_TILE + 1;
        if (local == 0) {
            uint left = scale > 0.0 ? best_plane(0, length) : left_size(length);
            uint splits = push.segments[number].splits;
            push.splits[splits].word = left / KD_TREE_WIDTH;
            add(first, left, splits + 1, depth + 1);
            add(first + left, length - left, splits + left / KD_TREE_WIDTH, depth + 1);
            first_job = atomicAdd(push.jobs.count, tiles);
            uint groups = min(first_job + tiles, VVH_GROUPS);
            atomicMax(push.jobs.groups[0], groups);
            atomicMax(push.jobs.groups_of_four[0], groups);
            push.segments[number].left = left;
            push.segments[number].axis = axis;
            push.segments[number].first_job = first_job;
        }
        barrier();
        for (uint tile = local; tile < tiles; tile += gl_WorkGroupSize.x) {
            push.tiles[first_job + tile].segment = number;
            push.tiles[first_job + tile].tile = tile;
        }
        barrier();
    }
}
