// Radix sort, third of three kernels per digit: sorts every tile and writes it to its destination.
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

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    Words keys;
    Words values;
    Words sorted_keys;
    Words sorted_values;
    // By digit, then by tile: count in earlier tiles.
    Words counts;
    // By digit.
    Words totals;
    uint count;
    uint tiles;
    // The digit's lowest bit.
    uint shift;
    // Bit 0: values are the indices of the elements and are not read. Bit 1: the sorted keys are not needed.
    uint flags;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Adds the position of the first key of every digit to `sort_offset`.
void add_starts(uint tile) {
    uint share = max(SORT_DIGITS / gl_WorkGroupSize.x, 1);
    uint first = group_rank() * share;
    uint sum = 0;
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) sum += push.totals[digit].word;
    }
    uint all;
    uint start = group_exclusive(sum, all);
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) {
            sort_offset[digit] += start + push.counts[digit * push.tiles + tile].word;
            start += push.totals[digit].word;
        }
    }
    barrier();
}

void main() {
    uint tile = workgroup();
    if (tile >= push.tiles) return;
    uint base = tile * SORT_TILE;
    uint size = min(push.count - base, SORT_TILE);
    uint first = sort_first();
    uint word = push.shift / 32;
    uint bit = push.shift % 32;

    uint keys[SORT_ITEMS];
    uint places[SORT_ITEMS];
    {
        uint digits[SORT_ITEMS];
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            uint at = first + i * gl_SubgroupSize;
            bool valid = at < size;
            keys[i] = valid ? push.keys[(base + at) * KEY_WORDS + word].word : 0;
            digits[i] = valid ? keys[i] >> bit & 255 : SORT_DIGITS;
        }
        sort_rank(digits, places);
        sort_places();
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            if (digits[i] < SORT_DIGITS) {
                places[i] += sort_counts[gl_SubgroupID * SORT_DIGITS + digits[i]];
                sort_staged[places[i]] = keys[i];
            }
        }
    }
    // Contains barriers.
    add_starts(tile);

    // From here on an invocation has every gl_WorkGroupSize.x-th element of the sorted tile.
    uint to[SORT_ITEMS];
    bool with_keys = (push.flags & 2) == 0;
    [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
        uint at = group_rank() + i * gl_WorkGroupSize.x;
        if (at < size) {
            uint key = sort_staged[at];
            to[i] = sort_offset[key >> bit & 255] + at;
            if (with_keys) push.sorted_keys[to[i] * KEY_WORDS + word].word = key;
        }
    }
    if (KEY_WORDS == 2 && with_keys) {
        uint other = 1 - word;
        barrier();
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            uint at = first + i * gl_SubgroupSize;
            if (at < size) sort_staged[places[i]] = push.keys[(base + at) * KEY_WORDS + other].word;
        }
        barrier();
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            uint at = group_rank() + i * gl_WorkGroupSize.x;
            if (at < size) push.sorted_keys[to[i] * KEY_WORDS + other].word = sort_staged[at];
        }
    }
    bool numbers = (push.flags & 1) != 0;
    barrier();
    [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
        uint at = first + i * gl_SubgroupSize;
        if (at < size) sort_staged[places[i]] = numbers ? base + at : push.values[base + at].word;
    }
    barrier();
    [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
        uint at = group_rank() + i * gl_WorkGroupSize.x;
        if (at < size) push.sorted_values[to[i]].word = sort_staged[at];
    }
}
