// A tile of a prefix sum: 16 words per invocation.
#ifndef SCAN_TILE_GLSL
#define SCAN_TILE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "device/constants.glsl"
#include "scan/group_scan.glsl"
#include "device/words.glsl"

// First word of this subgroup's share of the tile at `base`, and of this invocation.
uint scan_first(uint base) {
    return base + gl_SubgroupID * gl_SubgroupSize * SCAN_ITEMS + gl_SubgroupInvocationID;
}

// Writes the exclusive sums of `input[base ..]`, plus `carry`, and returns the sum of the tile.
uint scan_tile(Words from, Words to, uint base, uint count, uint carry) {
    uint sums[SCAN_ITEMS];
    uint first = scan_first(base);
    uint sum = 0;
    // No branch before the subgroup sums, and no unroll attribute: with either, one driver's subgroups
    // diverged, and each part computed its own sum.
    for (uint i = 0; i < SCAN_ITEMS; i++) {
        uint at = first + i * gl_SubgroupSize;
        uint value = from[min(at, count - 1)].word;
        value = at < count ? value : 0;
        sums[i] = sum + subgroupExclusiveAdd(value);
        sum += subgroupAdd(value);
    }
    uint total;
    uint before = carry + group_before(sum, total);
    [[unroll]] for (uint i = 0; i < SCAN_ITEMS; i++) {
        uint at = first + i * gl_SubgroupSize;
        if (at < count) to[at].word = before + sums[i];
    }
    return total;
}

#endif
