// A tile of a stable radix sort: up to eight subgroups, 16 keys per invocation, digits of eight bits.
//
// Every subgroup owns a contiguous part of the tile and processes it in order, in rows of one key per
// invocation. Invocations with equal digits in a row find each other by ballots, one per bit of the digit; so
// ranks are stable for any subgroup size (Merrill and Grimshaw 2011, "High performance and scalable radix
// sorting", rank digits in shared memory instead).
//
// To be included after the workgroup size is declared.
#ifndef SORT_TILE_GLSL
#define SORT_TILE_GLSL

#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "device/constants.glsl"
#include "scan/group_scan.glsl"

#define SORT_TILE (gl_WorkGroupSize.x * SORT_ITEMS)

// Count of each digit in each subgroup; then the position in the tile of its first key.
shared uint sort_counts[SORT_SUBGROUPS * SORT_DIGITS];
// Elements being permuted.
shared uint sort_staged[gl_WorkGroupSize.x * SORT_ITEMS];
// Destination of the keys of a digit, minus their position in the tile.
shared uint sort_offset[SORT_DIGITS];

// Position in the tile of this invocation's first element; the following ones are a subgroup size apart.
uint sort_first() {
    return gl_SubgroupID * gl_SubgroupSize * SORT_ITEMS + gl_SubgroupInvocationID;
}

// Ranks of this invocation's elements among those of its subgroup with the same digit. `digits` are below 256,
// or 256 for none. Leaves the counts in `sort_counts`.
void sort_rank(uint digits[SORT_ITEMS], out uint ranks[SORT_ITEMS]) {
    for (uint at = group_rank(); at < SORT_SUBGROUPS * SORT_DIGITS; at += gl_WorkGroupSize.x) sort_counts[at] = 0;
    barrier();
    uint own = gl_SubgroupID * SORT_DIGITS;
    // Without unroll attribute: see scan_tile.glsl.
    for (uint i = 0; i < SORT_ITEMS; i++) {
        uint digit = digits[i];
        uvec4 peers = subgroupBallot(digit < SORT_DIGITS);
        for (uint bit = 0; bit < 8; bit++) {
            bool set = (digit >> bit & 1) != 0;
            uvec4 ballot = subgroupBallot(set);
            peers &= set ? ballot : ~ballot;
        }
        bool valid = digit < SORT_DIGITS;
        uint leader = valid ? subgroupBallotFindLSB(peers) : gl_SubgroupInvocationID;
        uint before = 0;
        if (valid && leader == gl_SubgroupInvocationID) {
            before = atomicAdd(sort_counts[own + digit], subgroupBallotBitCount(peers));
        }
        ranks[i] = subgroupShuffle(before, leader) + subgroupBallotExclusiveBitCount(peers);
        // Orders the next row's atomics after this row's.
        subgroupMemoryBarrierShared();
    }
    barrier();
}

// Converts the counts into positions in the tile, and sets `sort_offset` to the negative position of the first
// key of every digit.
void sort_places() {
    // Consecutive digits per invocation.
    uint share = max(SORT_DIGITS / gl_WorkGroupSize.x, 1);
    uint first = group_rank() * share;
    uint sum = 0;
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) {
            for (uint part = 0; part < SORT_SUBGROUPS; part++) sum += sort_counts[part * SORT_DIGITS + digit];
        }
    }
    uint total;
    uint place = group_exclusive(sum, total);
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) {
            sort_offset[digit] = 0 - place;
            for (uint part = 0; part < SORT_SUBGROUPS; part++) {
                uint at = part * SORT_DIGITS + digit;
                uint count = sort_counts[at];
                sort_counts[at] = place;
                place += count;
            }
        }
    }
    barrier();
}

#endif
