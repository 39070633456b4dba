// Guesses a squared radius that contains the k nearest points. A wrong guess costs time, but does not affect
// the result.
#ifndef SEARCH_GUESS_GLSL
#define SEARCH_GUESS_GLSL

// Squared radius around the nearest point of a node that contains k points, if the density is the same
// everywhere as in the node: photons lie on surfaces, so n of them cover the largest face of their bounding
// box. 0 if the box has no extent.
float reach_in(vec3 size, float share) {
    float face = max(size.x * size.y, max(size.y * size.z, size.z * size.x));
    float edge = max(size.x, max(size.y, size.z));
    // Or on a line.
    if (face < 0.01 * edge * edge) return 0.25 * edge * edge * share * share;
    return 0.62 * face * share;
}

// Squared radius around `at` that contains k points, by the density of a node.
float reach_of(vec3 at, uint number, uint k) {
    vec3 low = uintBitsToFloat(push.nodes[number].low.xyz), high = uintBitsToFloat(push.nodes[number].high.xyz);
    float within = reach_in(high - low, float(k) / float(max(push.totals[number].at, 1u)));
    return sqrt(box_distance(at, low, high)) + sqrt(within);
}

// The smaller of the guesses from a leaf and from the node above it, since boxes are often larger than their
// content, and too small a radius costs less than too large a one.
float guess_of(float leaf, float above) {
    float reach = min(leaf, above);
    if (!(reach > 0.0)) reach = max(leaf, above);
    return reach * reach;
}

// Guess for one query. Descends not to the nearest nodes, as many overlap, but to those with the smallest
// guess.
float guess_alone(vec3 at, uint k) {
    float reach = INFINITE, before = INFINITE;
    uint number = 0;
    for (uint level = 0; level < KD_TREE_MAX_DEPTH; level++) {
        uint first = push.nodes[number].low.w, count = push.nodes[number].high.w;
        if ((count & KD_TREE_LEAF) != 0) break;
        before = reach;
        reach = INFINITE;
        number = first;
        for (uint i = 0; i < count; i++) {
            float other = reach_of(at, first + i, k);
            if (other < reach) {
                reach = other;
                number = first + i;
            }
        }
    }
    return guess_of(reach, before);
}

// The same by the whole subgroup, for the query of one invocation: descends to the two best nodes of each
// level. `at` is uniform in the subgroup.
float guess_together(vec3 at, uint k) {
    const uint NONE = 0xFFFFFFFFu;
    float reach = INFINITE, before = INFINITE;
    uvec2 best = uvec2(0, NONE);
    for (uint level = 0; level < KD_TREE_MAX_DEPTH; level++) {
        if (best.x == NONE || (push.nodes[best.x].high.w & KD_TREE_LEAF) != 0) break;
        // The two best of the nodes that this invocation examines.
        vec2 own = vec2(INFINITE);
        uvec2 number = uvec2(NONE);
        for (uint from = 0; from < 2 * KD_TREE_WIDTH; from += gl_SubgroupSize) {
            uint i = from + gl_SubgroupInvocationID;
            uint parent = i < KD_TREE_WIDTH ? best.x : best.y;
            if (i >= 2 * KD_TREE_WIDTH || parent == NONE) continue;
            uint first = push.nodes[parent].low.w, count = push.nodes[parent].high.w;
            uint child = first + (i & (KD_TREE_WIDTH - 1));
            // A leaf's count has the leaf flag, but a leaf has no children.
            if ((count & KD_TREE_LEAF) != 0 || (i & (KD_TREE_WIDTH - 1)) >= count) continue;
            float other = reach_of(at, child, k);
            if (other < own.x) {
                own = vec2(other, own.x);
                number = uvec2(child, number.x);
            } else if (other < own.y) {
                own.y = other;
                number.y = child;
            }
        }
        before = reach;
        reach = subgroupMin(own.x);
        best.x = subgroupMin(own.x == reach ? number.x : NONE);
        if (number.x == best.x) {
            own.x = own.y;
            number.x = number.y;
        }
        float second = subgroupMin(own.x);
        best.y = subgroupMin(own.x == second ? number.x : NONE);
    }
    return guess_of(reach, before);
}

#endif
