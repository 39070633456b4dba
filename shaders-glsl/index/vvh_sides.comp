// One level of the VVH tree, second of four kernels: marks the photons that go right.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#include "search/lists.glsl"
#include "index/vvh_records.glsl"

layout(local_size_x_id = 1) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Words lists;
    VvhSegments segments;
    VvhJobs jobs;
    VvhTiles tiles;
    // One bit per photon, initially zero.
    Words right;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

void main() {
    for (uint job = gl_WorkGroupID.x; job < push.jobs.count; job += gl_NumWorkGroups.x) {
        uint segment = push.tiles[job].segment;
        uint first = push.segments[segment].first;
        uint base = first + push.tiles[job].tile * LIST_TILE;
        uint end = min(base + LIST_TILE, first + push.segments[segment].size);
        uint begin = max(base, first + push.segments[segment].left);
        Words list = push.lists + push.segments[segment].axis * push.count;
        for (uint at = begin + gl_LocalInvocationIndex; at < end; at += gl_WorkGroupSize.x) {
            uint photon = list[at].word;
            atomicOr(push.right[photon / 32].word, 1u << photon % 32);
        }
    }
}
