// A squared radius that should hold the k nearest points. A wrong one costs time, never exactness.
#ifndef SEARCH_GUESS_GLSL
#define SEARCH_GUESS_GLSL

// A squared radius around a node's nearest point that k points should lie in, if they lie everywhere as
// in the node: photons lie on surfaces, so that n of them cover their box's largest face. 0 if they
// have no extent.
float reach_in(vec3 size, float share) {
    float face = max(size.x * size.y, max(size.y * size.z, size.z * size.x));
    float edge = max(size.x, max(size.y, size.z));
    // Or a line.
    if (face < 0.01 * edge * edge) return 0.25 * edge * edge * share * share;
    return 0.62 * face * share;
}

// How far k points reach around a point, if they lie as in a node.
float reach_of(vec3 at, uint number, uint k) {
    vec3 low = uintBitsToFloat(push.nodes[number].low.xyz), high = uintBitsToFloat(push.nodes[number].high.xyz);
    float within = reach_in(high - low, float(k) / float(max(push.totals[number].at, 1u)));
    return sqrt(box_distance(at, low, high)) + sqrt(within);
}

// The lesser of what a leaf and the node above it suggest, as boxes are often larger than what is in
// them, and too small a radius costs less than too large a one.
float guess_of(float leaf, float above) {
    float reach = min(leaf, above);
    if (!(reach > 0.0)) reach = max(leaf, above);
    return reach * reach;
}

// For one query. Not the nearest nodes are followed, as many overlap, but those where k points reach
// least far.
float guess_alone(vec3 at, uint k) {
    float reach = INFINITE, before = INFINITE;
    uint number = 0;
    for (uint level = 0; level < LEVELS; level++) {
        uint first = push.nodes[number].low.w, count = push.nodes[number].high.w;
        if ((count & LEAF) != 0) break;
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

// The same by the whole subgroup, for the query of one invocation: the two best nodes of a level are
// followed. `at` is the same for all.
float guess_together(vec3 at, uint k) {
    const uint NONE = 0xFFFFFFFFu;
    float reach = INFINITE, before = INFINITE;
    uvec2 best = uvec2(0, NONE);
    for (uint level = 0; level < LEVELS; level++) {
        if (best.x == NONE || (push.nodes[best.x].high.w & LEAF) != 0) break;
        // The two best of those that this invocation looks at.
        vec2 own = vec2(INFINITE);
        uvec2 number = uvec2(NONE);
        for (uint from = 0; from < 2 * WIDTH; from += gl_SubgroupSize) {
            uint i = from + gl_SubgroupInvocationID;
            uint parent = i < WIDTH ? best.x : best.y;
            if (i >= 2 * WIDTH || parent == NONE) continue;
            uint first = push.nodes[parent].low.w, count = push.nodes[parent].high.w;
            uint child = first + (i & (WIDTH - 1));
            // A leaf's count is large, but it has no children.
            if ((count & LEAF) != 0 || (i & (WIDTH - 1)) >= count) continue;
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
