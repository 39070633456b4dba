// Radix sort, first of three kernels per digit: counts every digit in every tile.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;
// Words per key.
layout(constant_id = 2) const uint KEY_WORDS = 1;

#include "device/grid.glsl"
#include "device/words.glsl"
#include "sort/sort_tile.glsl"

layout(push_constant, scalar) uniform Push {
    Words keys;
    // By digit, then by tile.
    Words counts;
    uint count;
    uint tiles;
    // The digit's lowest bit.
    uint shift;
} push;

void main() {
    uint tile = workgroup();
    if (tile >= push.tiles) return;
    for (uint at = group_rank(); at < SORT_SUBGROUPS * SORT_DIGITS; at += gl_WorkGroupSize.x) sort_counts[at] = 0;
    barrier();
    // One row of counters per subgroup: less contention than with a single row.
    uint own = gl_SubgroupID * SORT_DIGITS;
    [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
        uint at = tile * SORT_TILE + i * gl_WorkGroupSize.x + group_rank();
        if (at < push.count) {
            uint word = push.keys[at * KEY_WORDS + push.shift / 32].word;
            atomicAdd(sort_counts[own + (word >> push.shift % 32 & 255)], 1);
        }
    }
    barrier();
    for (uint digit = group_rank(); digit < SORT_DIGITS; digit += gl_WorkGroupSize.x) {
        uint sum = 0;
        for (uint part = 0; part < SORT_SUBGROUPS; part++) sum += sort_counts[part * SORT_DIGITS + digit];
        push.counts[digit * push.tiles + tile].word = sum;
    }
}
