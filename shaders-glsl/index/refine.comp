// Sorts runs of photons that share a Morton code by a finer grid over the bounding box of each run, and lists
// the runs that still share a code. One workgroup per run: short runs are ranked by comparison, long ones are
// radix sorted, tile by tile.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "index/group_box.glsl"
#include "search/map_records.glsl"
#include "index/morton.glsl"
#include "index/runs.glsl"
#include "sort/sort_tile.glsl"

// Coherent, since invocations of a workgroup read what others of it write.
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer Codes { uvec2 code; };
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Ids { uint id; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    // Photon index by slot; what was sorted by the previous codes.
    Ids ids;
    Ids other_ids;
    Codes codes;
    Codes other_codes;
    Round round;
    Runs runs;
    Round next_round;
    Runs next_runs;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Runs up to this length are ranked by comparison.
const uint SHORT = 512;
shared uint short_low[SHORT];
shared uint short_high[SHORT];

void refine_short(Grid grid, uint first, uint length) {
    uint ids[SHORT / 32];
    uint kept = 0;
    barrier();
    for (uint i = group_rank(); i < length; i += gl_WorkGroupSize.x) {
        uint id = push.ids[first + i].id;
        uvec2 code = morton_code(grid, photon_position(push.photons, id));
        short_low[i] = code.x;
        short_high[i] = code.y;
        ids[kept++] = id;
    }
    barrier();
    kept = 0;
    for (uint i = group_rank(); i < length; i += gl_WorkGroupSize.x) {
        uvec2 code = uvec2(short_low[i], short_high[i]);
        uint less = 0;
        uint before = 0;
        uint equal = 0;
        for (uint j = 0; j < length; j++) {
            uint low = short_low[j];
            uint high = short_high[j];
            less += uint(high < code.y || (high == code.y && low < code.x));
            bool same = high == code.y && low == code.x;
            equal += uint(same);
            before += uint(same && j < i);
        }
        push.ids[first + less + before].id = ids[kept++];
        if (before == 0 && equal > KD_TREE_WIDTH) add_run(push.next_round, push.next_runs, first + less, equal);
    }
}

// Counts the digits at `shift` in the first row of counts; returns whether all are equal.
bool count_digits(Codes codes, uint first, uint length, uint shift) {
    for (uint at = group_rank(); at < SORT_SUBGROUPS * SORT_DIGITS; at += gl_WorkGroupSize.x) sort_counts[at] = 0;
    barrier();
    for (uint i = group_rank(); i < length; i += gl_WorkGroupSize.x) {
        uint digit = codes[first + i].code[shift / 32] >> shift % 32 & 255;
        atomicAdd(sort_counts[gl_SubgroupID * SORT_DIGITS + digit], 1);
    }
    barrier();
    uint whole = 0;
    for (uint digit = group_rank(); digit < SORT_DIGITS; digit += gl_WorkGroupSize.x) {
        uint sum = 0;
        for (uint part = 0; part < SORT_SUBGROUPS; part++) sum += sort_counts[part * SORT_DIGITS + digit];
        sort_counts[digit] = sum;
        whole += uint(sum == length);
    }
    // Contains a barrier.
    return group_sum(whole) != 0;
}

// Converts the counts in the first row into start positions, which stay in `short_low`.
void digit_starts() {
    uint share = max(SORT_DIGITS / gl_WorkGroupSize.x, 1);
    uint first = group_rank() * share;
    uint sum = 0;
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) sum += sort_counts[digit];
    }
    uint all;
    uint start = group_exclusive(sum, all);
    if (first < SORT_DIGITS) {
        for (uint digit = first; digit < first + share; digit++) {
            short_low[digit] = start;
            start += sort_counts[digit];
        }
    }
    barrier();
}

// Sorts a long run by one digit, from one pair of buffers to the other.
void sort_digit(Codes codes, Ids ids, Codes to_codes, Ids to_ids, uint first, uint length, uint shift) {
    digit_starts();
    for (uint base = 0; base < length; base += SORT_TILE) {
        uint size = min(length - base, SORT_TILE);
        uint digits[SORT_ITEMS];
        uint places[SORT_ITEMS];
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            uint at = sort_first() + i * gl_SubgroupSize;
            digits[i] = at < size ? codes[first + base + at].code[shift / 32] >> shift % 32 & 255 : SORT_DIGITS;
        }
        sort_rank(digits, places);
        sort_places();
        [[unroll]] for (uint i = 0; i < SORT_ITEMS; i++) {
            uint digit = digits[i];
            if (digit < SORT_DIGITS) {
                uint at = first + base + sort_first() + i * gl_SubgroupSize;
                uint place = places[i] + sort_counts[gl_SubgroupID * SORT_DIGITS + digit];
                uint to = first + short_low[digit] + sort_offset[digit] + place;
                to_codes[to].code = codes[at].code;
                to_ids[to].id = ids[at].id;
            }
        }
        barrier();
        // Advances to the next tile: a digit's count is the next digit's position minus its own.
        for (uint digit = group_rank(); digit < SORT_DIGITS; digit += gl_WorkGroupSize.x) {
            uint next = digit + 1 < SORT_DIGITS ? 0 - sort_offset[digit + 1] : size;
            short_low[digit] += next + sort_offset[digit];
        }
        barrier();
    }
    memoryBarrierBuffer();
    barrier();
}

void refine_long(Grid grid, uint first, uint length) {
    barrier();
    for (uint i = group_rank(); i < length; i += gl_WorkGroupSize.x) {
        push.codes[first + i].code = morton_code(grid, photon_position(push.photons, push.ids[first + i].id));
    }
    memoryBarrierBuffer();
    barrier();
    bool there = false;
    for (uint shift = 0; shift < 64; shift += 8) {
        if (there) {
            if (count_digits(push.other_codes, first, length, shift)) continue;
            sort_digit(push.other_codes, push.other_ids, push.codes, push.ids, first, length, shift);
        } else {
            if (count_digits(push.codes, first, length, shift)) continue;
            sort_digit(push.codes, push.ids, push.other_codes, push.other_ids, first, length, shift);
        }
        there = !there;
    }
    if (there) {
        for (uint i = group_rank(); i < length; i += gl_WorkGroupSize.x) {
            push.codes[first + i].code = push.other_codes[first + i].code;
            push.ids[first + i].id = push.other_ids[first + i].id;
        }
        memoryBarrierBuffer();
        barrier();
    }
    for (uint i = group_rank(); i + KD_TREE_WIDTH < length; i += gl_WorkGroupSize.x) {
        uvec2 code = push.codes[first + i].code;
        if (push.codes[first + i + KD_TREE_WIDTH].code != code || (i > 0 && push.codes[first + i - 1].code == code)) continue;
        uint inside = i + KD_TREE_WIDTH;
        uint outside = length;
        while (outside - inside > 1) {
            uint middle = inside + (outside - inside) / 2;
            if (push.codes[first + middle].code == code) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        add_run(push.next_round, push.next_runs, first + i, outside - i);
    }
    barrier();
}

void main() {
    for (uint number = gl_WorkGroupID.x; number < push.round.count; number += gl_NumWorkGroups.x) {
        uvec2 run = push.runs[number].run;
        uvec3 low = uvec3(0xffffffffu);
        uvec3 high = uvec3(0);
        for (uint i = group_rank(); i < run.y; i += gl_WorkGroupSize.x) {
            uvec3 key = ordered3(photon_position(push.photons, push.ids[run.x + i].id));
            low = min(low, key);
            high = max(high, key);
        }
        group_box(low, high);
        // Coincident photons stay in index order.
        if (low == high) continue;
        Grid grid = grid_over(from_ordered3(low), from_ordered3(high));
        if (run.y <= SHORT) {
            refine_short(grid, run.x, run.y);
        } else {
            refine_long(grid, run.x, run.y);
        }
    }
}
