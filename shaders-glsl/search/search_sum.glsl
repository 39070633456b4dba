// Accurate sums over up to a million photons: groups of eight photons are added plainly, the group sums with
// compensated summation (Kahan 1965).
#ifndef SEARCH_SUM_GLSL
#define SEARCH_SUM_GLSL

#include "search/search_pause.glsl"

struct Sum {
    vec3 total;
    // Excess of `total` by rounding.
    vec3 excess;
};

const Sum NOTHING = Sum(vec3(0.0), vec3(0.0));

void sum_add(inout Sum sum, vec3 part) {
    precise vec3 exact = part - sum.excess;
    precise vec3 total = sum.total + exact;
    precise vec3 excess = (total - sum.total) - exact;
    sum.total = total;
    sum.excess = excess;
}

// Saves a sum, or restores it.
void sum_keep(inout Sum sum) {
    keep(sum.total);
    keep(sum.excess);
}

#endif
