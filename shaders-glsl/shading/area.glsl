// Twin of photon-core's area.rs: positions of the area probes of an estimate's disc.
#ifndef AREA_GLSL
#define AREA_GLSL

#include "shading/constants.glsl"
#include "shading/kernel.glsl"

float area_spoke_turns(uint spoke, float random) {
    return (float(spoke) + random) * (1.0 / float(AREA_SPOKES));
}

// Distance from the query in radii, and weight.
vec2 area_probe(uint kernel, float slope, uint spoke, uint ring, float random) {
    float shift = fract(random + float(spoke) * 0.618034);
    float share = min((float(ring) + shift) * (1.0 / float(AREA_RINGS)), 1.0 - 1.1920929e-7);
    float rest = sqrt(1.0 - share);
    if (kernel == KERNEL_EPANECHNIKOV) return vec2(sqrt(max(1.0 - rest, 0.0)), 1.0);
    if (kernel == KERNEL_BIWEIGHT) return vec2(sqrt(max(1.0 - rest, 0.0)), rest);
    return vec2(sqrt(share), kernel_weight(kernel, slope, share));
}

// Distance of the probe of a spoke that is only for the second radius, in radii.
float area_outer_distance(uint spoke, float random) {
    float shift = fract(random + float(spoke) * 0.618034);
    return sqrt(AREA_OUTER + (2.0 - AREA_OUTER) * shift);
}

// Weights of a probe for √2 of the radius, and for 1/√2 of it.
vec2 area_second_weights(uint kernel, float slope, float away) {
    float square = away * away;
    bool falls = kernel == KERNEL_EPANECHNIKOV || kernel == KERNEL_BIWEIGHT;
    float inner = square < 1.0 ? float(AREA_RINGS) * (falls ? 2.0 * (1.0 - square) : 1.0) : 0.0;
    float outer = square >= AREA_OUTER ? 1.0 / (2.0 - AREA_OUTER) : 0.0;
    float wide = kernel_weight(kernel, slope, min(0.5 * square, 1.0)) / (inner + outer);
    return vec2(wide, square < 0.5 ? kernel_weight(kernel, slope, 2.0 * square) / inner : 0.0);
}

float area_share(float found, float all) {
    return found > 0.0 && found < all ? max(found / all, AREA_MIN_SHARE) : 1.0;
}

#endif
