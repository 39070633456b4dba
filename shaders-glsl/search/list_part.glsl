// Partitions a tile of a list in two. To be included after the workgroup size is declared.
#ifndef LIST_PART_GLSL
#define LIST_PART_GLSL

#extension GL_KHR_shader_subgroup_ballot : require

#include "scan/group_scan.glsl"
#include "search/lists.glsl"

// Sum of `counts[first .. end]`. Must be called by the whole workgroup.
uint list_before(Words counts, uint first, uint end) {
    uint sum = 0;
    for (uint at = first + group_rank(); at < end; at += gl_WorkGroupSize.x) sum += counts[at].word;
    return group_sum(sum);
}

// Copies the photons in [base, end) of `from`, at most LIST_TILE of them, to `to`: those that go left to
// `next_left` onwards, the others to `next_right` onwards.
void list_part(Words from, Words to, uint base, uint end, uint next_left, uint next_right) {
    uint share = LIST_TILE / gl_NumSubgroups;
    uint first = base + gl_SubgroupID * share;
    uint left = 0;
    for (uint i = gl_SubgroupInvocationID; i < share; i += gl_SubgroupSize) {
        // A branch before a ballot could make the subgroup diverge.
        uint photon = from[min(first + i, end - 1)].word;
        bool inside = first + i < end;
        bool low = photon < GOES_RIGHT;
        bool goes_left = inside && low;
        left += subgroupBallotBitCount(subgroupBallot(goes_left));
    }
    uint total;
    uint before = group_before(left, total);
    next_left += before;
    next_right += gl_SubgroupID * share - before;
    for (uint i = gl_SubgroupInvocationID; i < share; i += gl_SubgroupSize) {
        uint photon = from[min(first + i, end - 1)].word;
        bool inside = first + i < end;
        bool low = photon < GOES_RIGHT;
        bool goes_left = inside && low;
        uvec4 ballot = subgroupBallot(goes_left);
        uint lower = subgroupBallotExclusiveBitCount(ballot);
        if (goes_left) {
            to[next_left + lower].word = photon;
        } else if (inside) {
            to[next_right + gl_SubgroupInvocationID - lower].word = photon & ~GOES_RIGHT;
        }
        uint all = subgroupBallotBitCount(ballot);
        next_left += all;
        next_right += gl_SubgroupSize - all;
    }
}

#endif
