// What the photons of an estimate say about its error: twin of backend-cpu's spread.rs. Sums over the
// photons within √2 of the radius, in `Spread`'s terms.
#ifndef SEARCH_SPREAD_GLSL
#define SEARCH_SPREAD_GLSL

#include "kernel.glsl"
#include "math.glsl"
#include "sampling.glsl"
#include "search_sum.glsl"

// A photon farther from the query's plane than this share of the wide radius is on another surface.
const float OFF_PLANE = 0.25;

// Of a query: one more than the bits of its squared radius; one over √2 of it; directions in its plane.
uint spread_inner;
float spread_reach;
vec3 spread_tangent, spread_bitangent;
// Sums: wide, narrow, (power, its square, stray), (slope, first of stretch), second of stretch.
Sum spread_wide, spread_narrow, spread_power, spread_slope, spread_rest;
uint spread_photons;
// The same of eight photons.
vec3 eight_wide, eight_narrow, eight_power, eight_slope, eight_rest;

void spread_begin(vec3 normal, float squared_radius, float divisor) {
    spread_inner = floatBitsToUint(squared_radius) + 1;
    spread_reach = 1.0 / sqrt(2.0 * divisor);
    sampling_basis(normal, spread_tangent, spread_bitangent);
    spread_wide = NOTHING;
    spread_narrow = NOTHING;
    spread_power = NOTHING;
    spread_slope = NOTHING;
    spread_rest = NOTHING;
    spread_photons = 0;
}

void spread_eight_begin() {
    eight_wide = vec3(0.0);
    eight_narrow = vec3(0.0);
    eight_power = vec3(0.0);
    eight_slope = vec3(0.0);
    eight_rest = vec3(0.0);
}

void spread_eight_end() {
    sum_add(spread_wide, eight_wide);
    sum_add(spread_narrow, eight_narrow);
    sum_add(spread_power, eight_power);
    sum_add(spread_slope, eight_slope);
    sum_add(spread_rest, eight_rest);
}

// A photon of `u` squared distances over squared radii, at `offset` from the query; whether it counts as
// on the query's surface, and near enough to its plane for the estimate and for the narrow one. Adds to `sum` and
// `photons` what the estimate itself has of it. No early end: on some devices a subgroup would not come together again.
void spread_add(
    uint kernel, float slope, vec3 offset, vec3 normal, vec3 power, float d2, float u, bool same, bvec2 flat_enough,
    inout vec3 sum, inout uint photons) {
    float mean = (power.x + power.y + power.z) * (1.0 / 3.0);
    if (same) {
        if (floatBitsToUint(d2) < spread_inner && flat_enough.x) {
            sum += power * kernel_weight(kernel, slope, min(u, 1.0));
            photons++;
            if (2.0 * u <= 1.0 && flat_enough.y) eight_narrow += power * kernel_weight(kernel, slope, 2.0 * u);
        }
        eight_wide += power * kernel_weight(kernel, slope, min(0.5 * u, 1.0));
        vec3 scaled = offset * spread_reach;
        float x = dot3(scaled, spread_tangent), y = dot3(scaled, spread_bitangent);
        eight_power += vec3(mean, mean * mean, abs(dot3(scaled, normal)) > OFF_PLANE ? mean : 0.0);
        eight_slope += mean * vec3(x, y, x * x - y * y);
        eight_rest.x += mean * 2.0 * x * y;
        spread_photons++;
    } else {
        eight_power.z += mean;
    }
}

Spread spread_found() {
    vec3 power = spread_power.total - spread_power.excess;
    vec3 slope = spread_slope.total - spread_slope.excess;
    return Spread(
        spread_wide.total - spread_wide.excess, power.x, spread_narrow.total - spread_narrow.excess, power.y, slope.xy,
        vec2(slope.z, spread_rest.total.x - spread_rest.excess.x), power.z, spread_photons, uint[2](0u, 0u));
}

// Writes the sums down, or reads them again.
void spread_keep() {
    sum_keep(spread_wide);
    sum_keep(spread_narrow);
    sum_keep(spread_power);
    sum_keep(spread_slope);
    sum_keep(spread_rest);
    keep(spread_photons);
}

#endif
