// Twin of photon-core's area.rs: where probes of an estimate's disc stand.
#ifndef AREA_GLSL
#define AREA_GLSL

#include "kernel.glsl"

const uint AREA_SPOKES = 8;
const uint AREA_RINGS = 3;
const float AREA_HEIGHT = 0.5;
const float AREA_LEAST_SHARE = 1.0 / 16.0;
const float AREA_LEAST_RADIUS = 1.0 / 262144.0;
const uint AREA_SHEETS = 4;

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

float area_share(float found, float all) {
    return found > 0.0 && found < all ? max(found / all, AREA_LEAST_SHARE) : 1.0;
}

#endif
