// Splits the segments of up to LIST_SHORT photons of the median tree, one per workgroup, down to leaves in
// order of their photon indices.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

#extension GL_EXT_control_flow_attributes : require

#include "device/grid.glsl"
#include "search/lists.glsl"

layout(local_size_x_id = 1) in;

// Coherent, since invocations of a workgroup read what others of it write.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Places { uint place; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    PhotonRows photons;
    Words lists;
    // By photon index: its position in its segment's first list.
    Places places;
    Words order;
    uint count;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

const uint MASKS = LIST_SHORT / 32;
// The workgroup has 256 invocations.
const uint ITEMS = LIST_SHORT / 256;

// Photon index, by position in the initial first list.
shared uint photons[LIST_SHORT];
// The three lists, of such positions.
shared uint lists[3][LIST_SHORT];
shared uint axes[LIST_SHORT / 32];
// By position: which photons go right.
shared uint right[MASKS];
// By list: which photons go left, and how many before each word.
shared uint left_masks[3][MASKS];
shared uint left_before[3][MASKS];

uvec3 position_at(uint list, uint at) {
    return photon_position(push.photons, photons[lists[list][at]]);
}

// Splits the segments that begin at multiples of `size`.
void split(uint length, uint size) {
    uint local = gl_LocalInvocationIndex;
    uint half_size = size / 2;
    for (uint i = local; i < MASKS; i += gl_WorkGroupSize.x) {
        right[i] = 0;
        for (uint list = 0; list < 3; list++) left_masks[list][i] = 0;
    }
    if (local * size + half_size < length) {
        uint first = local * size;
        uint last = min(first + size, length) - 1;
        uvec3 low = uvec3(position_at(0, first).x, position_at(1, first).y, position_at(2, first).z);
        uvec3 high = uvec3(position_at(0, last).x, position_at(1, last).y, position_at(2, last).z);
        uint extent;
        axes[local] = longest_axis(low, high, extent);
    }
    barrier();
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        if (at % size >= half_size) {
            uint place = lists[axes[at / size]][at];
            atomicOr(right[place / 32], 1u << place % 32);
        }
    }
    barrier();
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        for (uint list = 0; list < 3; list++) {
            uint place = lists[list][at];
            uint goes_left = (~right[place / 32] >> place % 32) & 1;
            atomicOr(left_masks[list][at / 32], goes_left << at % 32);
        }
    }
    barrier();
    for (uint i = local; i < 3 * MASKS; i += gl_WorkGroupSize.x) {
        uint list = i / MASKS;
        // Segments are whole words.
        uint word = i % MASKS;
        uint before = 0;
        for (uint at = word * 32 / size * size / 32; at < word; at++) before += bitCount(left_masks[list][at]);
        left_before[list][word] = before;
    }
    barrier();
    uint to[3][ITEMS];
    uint moved[3][ITEMS];
    [[unroll]] for (uint i = 0; i < ITEMS; i++) {
        uint at = local + i * 256;
        if (at >= length) continue;
        uint first = at / size * size;
        [[unroll]] for (uint list = 0; list < 3; list++) {
            uint mask = left_masks[list][at / 32];
            uint before = left_before[list][at / 32] + bitCount(mask & ((1u << at % 32) - 1));
            bool goes_left = (mask >> at % 32 & 1) != 0;
            to[list][i] = goes_left ? first + before : at + half_size - before;
            moved[list][i] = lists[list][at];
        }
    }
    barrier();
    [[unroll]] for (uint i = 0; i < ITEMS; i++) {
        if (local + i * 256 >= length) continue;
        [[unroll]] for (uint list = 0; list < 3; list++) lists[list][to[list][i]] = moved[list][i];
    }
    barrier();
}

void main() {
    uint first = workgroup() * LIST_SHORT;
    if (first >= push.count) return;
    uint local = gl_LocalInvocationIndex;
    uint length = min(LIST_SHORT, push.count - first);
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        uint photon = push.lists[first + at].word;
        photons[at] = photon;
        lists[0][at] = at;
        push.places[photon].place = at;
    }
    memoryBarrierBuffer();
    barrier();
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        for (uint list = 1; list < 3; list++) {
            lists[list][at] = push.places[(push.lists + list * push.count)[first + at].word].place;
        }
    }
    barrier();
    for (uint size = LIST_SHORT; size >= 2 * KD_TREE_WIDTH; size /= 2) {
        if (length > size / 2) split(length, size);
    }
    for (uint at = local; at < length; at += gl_WorkGroupSize.x) {
        uint photon = photons[lists[0][at]];
        uint leaf = at / KD_TREE_WIDTH * KD_TREE_WIDTH;
        uint end = min(leaf + KD_TREE_WIDTH, length);
        uint lower = 0;
        for (uint other = leaf; other < end; other++) lower += uint(photons[lists[0][other]] < photon);
        push.order[first + leaf + lower].word = photon;
    }
}
