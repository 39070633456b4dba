// Twin of photon-core's area.rs: positions of the area probes of an estimate's disc.
#ifndef AREA_GLSL
#define AREA_GLSL

#include "shading/constants.glsl"
#include "shading/kernel.glsl"

float area_spoke_turns(uint spoke, float random) {
    return (float(spoke) + random) * (1.0 / float(AREA_SPOKES));
}

// Distance of a probe of a spoke from the query, in radii, for another random number; their density is the kernel's.
float area_probe(uint kernel, uint spoke, uint ring, float random) {
    float shift = fract(random + float(spoke) * 0.618034);
    float share = min((float(ring) + shift) * (1.0 / float(AREA_RINGS)), 1.0 - 1.1920929e-7);
    // The radius within which the kernel has this share of its weight.
    return sqrt(kernel == KERNEL_CONSTANT ? share : max(1.0 - sqrt(1.0 - share), 0.0));
}

// Distance of the probe of a spoke that is only for the second radius, in radii.
float area_outer_distance(uint spoke, float random) {
    float shift = fract(random + float(spoke) * 0.618034);
    return sqrt(AREA_OUTER + (2.0 - AREA_OUTER) * shift);
}

// Weights of a probe for √2 of the radius, and for 1/√2 of it.
vec2 area_second_weights(uint kernel, float away) {
    float square = away * away;
    float inner = square < 1.0 ? float(AREA_RINGS) * kernel_weight(kernel, square) : 0.0;
    float outer = square >= AREA_OUTER ? 1.0 / (2.0 - AREA_OUTER) : 0.0;
    float wide = kernel_weight(kernel, min(0.5 * square, 1.0)) / (inner + outer);
    return vec2(wide, square < 0.5 ? kernel_weight(kernel, 2.0 * square) / inner : 0.0);
}

float area_share(float found, float all) {
    return found > 0.0 && found < all ? max(found / all, AREA_MIN_SHARE) : 1.0;
}

#endif
