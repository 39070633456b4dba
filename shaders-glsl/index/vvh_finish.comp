// Splits the segments of up to LIST_SHORT photons of the VVH tree, one per workgroup, down to leaves.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#extension GL_EXT_control_flow_attributes : require

layout(local_size_x_id = 1) in;

// Maximum number of segments of two or more blocks in 64 blocks.
#define VVH_ROWS 32
#include "index/vvh.glsl"
#include "index/vvh_records.glsl"

// Coherent, since invocations of a workgroup read what others of it write.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Places { uint place; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    // A segment may be in either buffer.
    Words lists;
    Words other_lists;
    VvhLevel level;
    VvhShorts shorts;
    // By photon index: its position in its segment's first list.
    Places places;
    Words splits;
    Words order;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

const uint MASKS = LIST_SHORT / 32;
const uint BLOCKS = LIST_SHORT / KD_TREE_WIDTH;
// The workgroup has 256 invocations.
const uint ITEMS = LIST_SHORT / 256;
const uint LISTS = 4;

// Photon index, by position in the initial first list.
shared uint photons[LIST_SHORT];
// The lists, of such positions.
shared uint lists[LISTS][LIST_SHORT];
// By position: which photons go right.
shared uint right[MASKS];
// By list: which photons go left, and how many before each word.
shared uint left_masks[LISTS][MASKS];
shared uint left_before[LISTS][MASKS];
// By block: the first block of its segment.
shared uint owner[BLOCKS];
// By first block: number of photons, index of the split, depth; number of photons left of the split, or 0 for a
// leaf; axis, lower corner, and slabs per unit of length, or 0.
shared uint lengths[BLOCKS];
shared uint split_at[BLOCKS];
shared uint depths[BLOCKS];
shared uint left_of[BLOCKS];
shared uint axes[BLOCKS];
shared uint lows[BLOCKS];
shared float scales[BLOCKS];
shared bool busy;

uvec3 position_at(uint list, uint at) {
    return photon_position(push.photons, photons[lists[list][at]]);
}

// Decides how every segment is split; returns whether any is.
bool plan(uint length) {
    uint local = gl_LocalInvocationIndex;
    if (local == 0) busy = false;
    for (uint i = local; i < VVH_ROWS * VVH_SLABS; i += gl_WorkGroupSize.x) slab_counts[i] = 0;
    for (uint i = local; i < MASKS; i += gl_WorkGroupSize.x) {
        right[i] = 0;
        for (uint list = 0; list < LISTS; list++) left_masks[list][i] = 0;
    }
    barrier();
    bool splits = local < BLOCKS && local * KD_TREE_WIDTH < length && owner[local] == local && lengths[local] > KD_TREE_WIDTH;
    if (splits) {
        uint first = local * KD_TREE_WIDTH;
        uint last = first + lengths[local] - 1;
        uvec3 low = uvec3(position_at(0, first).x, position_at(1, first).y, position_at(2, first).z);
        uvec3 high = uvec3(position_at(0, last).x, position_at(1, last).y, position_at(2, last).z);
        uint extent;
        uint axis = longest_axis(low, high, extent);
        axes[local] = axis;
        lows[local] = low[axis];
        scales[local] = slab_scale(lengths[local], depths[local], extent);
        busy = true;
    } else if (local < BLOCKS) {
        scales[local] = 0.0;
        left_of[local] = 0;
    }
    barrier();
    if (!busy) return false;
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        uint segment = owner[at / KD_TREE_WIDTH];
        if (scales[segment] > 0.0 && (at - segment * KD_TREE_WIDTH) % vvh_stride(lengths[segment]) == 0) {
            uint slab = slab_of(position_at(3, at)[axes[segment]], lows[segment], scales[segment]);
            atomicAdd(slab_counts[segment / 2 * VVH_SLABS + slab], 1);
        }
    }
    barrier();
    if (splits) {
        uint left = scales[local] > 0.0 ? best_plane(local / 2, lengths[local]) : left_size(lengths[local]);
        left_of[local] = left;
        push.splits[split_at[local]].word = left / KD_TREE_WIDTH;
    }
    barrier();
    return true;
}

// Number of photons of a list that go left, before a position.
uint before(uint list, uint at) {
    return left_before[list][at / 32] + bitCount(left_masks[list][at / 32] & ((1u << at % 32) - 1));
}

// Partitions the lists.
void part(uint length) {
    uint local = gl_LocalInvocationIndex;
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        uint segment = owner[at / KD_TREE_WIDTH];
        if (left_of[segment] != 0 && at - segment * KD_TREE_WIDTH >= left_of[segment]) {
            uint place = lists[axes[segment]][at];
            atomicOr(right[place / 32], 1u << place % 32);
        }
    }
    barrier();
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        for (uint list = 0; list < LISTS; list++) {
            uint place = lists[list][at];
            uint goes_left = (~right[place / 32] >> place % 32) & 1;
            atomicOr(left_masks[list][at / 32], goes_left << at % 32);
        }
    }
    barrier();
    for (uint i = local; i < LISTS * MASKS; i += gl_WorkGroupSize.x) {
        uint sum = 0;
        for (uint word = 0; word < i % MASKS; word++) sum += bitCount(left_masks[i / MASKS][word]);
        left_before[i / MASKS][i % MASKS] = sum;
    }
    barrier();
    uint to[LISTS][ITEMS];
    uint moved[LISTS][ITEMS];
    [[unroll]] for (uint i = 0; i < ITEMS; i++) {
        uint at = local + i * 256;
        if (at >= length) continue;
        uint segment = owner[at / KD_TREE_WIDTH];
        uint first = segment * KD_TREE_WIDTH;
        [[unroll]] for (uint list = 0; list < LISTS; list++) {
            uint lower = before(list, at) - before(list, first);
            bool goes_left = (left_masks[list][at / 32] >> at % 32 & 1) != 0;
            to[list][i] = goes_left ? first + lower : at + left_of[segment] - lower;
            moved[list][i] = lists[list][at];
        }
    }
    barrier();
    [[unroll]] for (uint i = 0; i < ITEMS; i++) {
        if (local + i * 256 >= length) continue;
        [[unroll]] for (uint list = 0; list < LISTS; list++) lists[list][to[list][i]] = moved[list][i];
    }
    barrier();
}

// Makes the partitions the new segments.
void descend() {
    uint local = gl_LocalInvocationIndex;
    uint segment = local < BLOCKS ? owner[local] : 0;
    uint blocks_left = left_of[segment] / KD_TREE_WIDTH;
    uint begin = segment + blocks_left;
    uint length = lengths[segment];
    uint split = split_at[segment];
    uint depth = depths[segment];
    barrier();
    if (local < BLOCKS && blocks_left != 0) {
        if (local >= begin) owner[local] = begin;
        if (local == begin) {
            lengths[local] = length - blocks_left * KD_TREE_WIDTH;
            split_at[local] = split + blocks_left;
            depths[local] = depth + 1;
        } else if (local == segment) {
            lengths[local] = blocks_left * KD_TREE_WIDTH;
            split_at[local] = split + 1;
            depths[local] = depth + 1;
        }
    }
    barrier();
}

void finish(uint number) {
    uint local = gl_LocalInvocationIndex;
    uint first = push.shorts[number].first;
    uint length = push.shorts[number].size;
    uint depth = push.shorts[number].depth;
    Words from = (depth & 0x80000000u) != 0 ? push.other_lists : push.lists;
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        uint photon = from[first + at].word;
        photons[at] = photon;
        lists[0][at] = at;
        push.places[photon].place = at;
    }
    if (local < BLOCKS) {
        owner[local] = 0;
        lengths[local] = length;
        split_at[local] = push.shorts[number].splits;
        depths[local] = depth & 0x7fffffffu;
    }
    memoryBarrierBuffer();
    barrier();
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        for (uint list = 1; list < LISTS; list++) {
            lists[list][at] = push.places[(from + list * push.count)[first + at].word].place;
        }
    }
    barrier();
    while (plan(length)) {
        part(length);
        descend();
    }
    // The last list is in order of photon indices, as leaves are.
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) push.order[first + at].word = photons[lists[3][at]];
    barrier();
}

void main() {
    for (uint number = gl_WorkGroupID.x; number < push.level.count; number += gl_NumWorkGroups.x) finish(number);
}
