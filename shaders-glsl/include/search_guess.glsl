// A squared radius that should hold the k nearest points. A wrong one costs time, never exactness.
#ifndef SEARCH_GUESS_GLSL
#define SEARCH_GUESS_GLSL

// By how many standard deviations a squared radius taken from a neighbour exceeds what that one
// found: a count of k has the relative deviation 1/√k, and one query's failure repeats a tile's walk.
const float MARGIN = 2.5;

// What the same invocation found in the tile before.
struct Hint {
    vec3 at;
    // Squared distance of the k-th; negative if nothing is known.
    float squared_radius;
    // Whether the one before was much the same.
    bool steady;
};

// From that: negative if it says nothing here.
float guess_from(Hint hint, vec3 at, uint k) {
    if (!(hint.squared_radius >= 0.0)) return -1.0;
    float moved = point_distance(at, hint.at);
    if (!(moved <= 4.0 * hint.squared_radius || hint.steady)) return -1.0;
    // By the triangle inequality this one holds k points.
    float sure = sqrt(hint.squared_radius) + sqrt(moved);
    float likely = hint.squared_radius * (1.0 + MARGIN * inversesqrt(float(k)));
    return min(sure * sure * 1.00001, likely);
}

// From the smallest node with k points that lies nearest: photons lie on surfaces, so that k of its n
// points cover k/n of its box's largest face. What lies outside the box is farther by the gap.
float guess_from_nodes(vec3 at, uint k) {
    uint number = 0;
    for (uint level = 0; level < LEVELS; level++) {
        uint first = push.nodes[number].low.w, count = push.nodes[number].high.w;
        if ((count & LEAF) != 0) break;
        uint best = first;
        float gap = INFINITE;
        for (uint i = 0; i < count; i++) {
            vec3 low = uintBitsToFloat(push.nodes[first + i].low.xyz);
            vec3 high = uintBitsToFloat(push.nodes[first + i].high.xyz);
            float d2 = box_distance(at, low, high);
            if (d2 < gap) {
                gap = d2;
                best = first + i;
            }
        }
        if (push.totals[best].at < k) break;
        number = best;
    }
    vec3 low = uintBitsToFloat(push.nodes[number].low.xyz);
    vec3 high = uintBitsToFloat(push.nodes[number].high.xyz);
    vec3 size = high - low;
    float share = float(k) / float(max(push.totals[number].at, 1u));
    float face = max(size.x * size.y, max(size.y * size.z, size.z * size.x));
    float edge = 0.5 * max(size.x, max(size.y, size.z)) * min(share, 1.0);
    float disc = max(share * face * 0.318309886, edge * edge);
    float whole = sqrt(box_distance(at, low, high)) + sqrt(disc * 1.3);
    // All of the node is a bound if everything is accepted.
    return min(whole * whole, corner_distance(at, low, high) * 1.000001);
}

#endif
