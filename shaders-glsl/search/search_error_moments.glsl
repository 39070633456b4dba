// Error moments of an estimate: twin of backend-cpu's error_moments.rs. Sums over the photons within √2 of the
// radius, with the members of `ErrorMoments`.
#ifndef SEARCH_ERROR_MOMENTS_GLSL
#define SEARCH_ERROR_MOMENTS_GLSL

#include "shading/constants.glsl"
#include "shading/kernel.glsl"
#include "shading/math.glsl"
#include "shading/sampling.glsl"
#include "search/search_sum.glsl"

// Of a query: one more than the bits of its squared radius; 1 / (√2 · radius); tangent vectors of its plane.
uint error_moments_inner;
float error_moments_reach;
vec3 error_moments_tangent, error_moments_bitangent;
// Sums: wide, narrow, (power, its square, stray), (slope, first of stretch), second of stretch.
Sum error_moments_wide, error_moments_narrow, error_moments_power, error_moments_slope, error_moments_rest;
uint error_moments_photons;
// The same sums over eight photons.
vec3 eight_wide, eight_narrow, eight_power, eight_slope, eight_rest;

void error_moments_begin(vec3 normal, float squared_radius, float divisor) {
    error_moments_inner = floatBitsToUint(squared_radius) + 1;
    error_moments_reach = 1.0 / sqrt(2.0 * divisor);
    sampling_basis(normal, error_moments_tangent, error_moments_bitangent);
    error_moments_wide = NOTHING;
    error_moments_narrow = NOTHING;
    error_moments_power = NOTHING;
    error_moments_slope = NOTHING;
    error_moments_rest = NOTHING;
    error_moments_photons = 0;
}

void error_moments_eight_begin() {
    eight_wide = vec3(0.0);
    eight_narrow = vec3(0.0);
    eight_power = vec3(0.0);
    eight_slope = vec3(0.0);
    eight_rest = vec3(0.0);
}

void error_moments_eight_end() {
    sum_add(error_moments_wide, eight_wide);
    sum_add(error_moments_narrow, eight_narrow);
    sum_add(error_moments_power, eight_power);
    sum_add(error_moments_slope, eight_slope);
    sum_add(error_moments_rest, eight_rest);
}

// Adds a photon at `offset` from the query, with `u` the squared distance over the squared radius; flags say
// whether it counts as on the query's surface, and whether it is near enough to its plane for the estimate and
// for the narrow one. Adds the photon's contribution to the estimate itself to `sum` and `photons`. No early
// return: on some devices the subgroup would not reconverge.
void error_moments_add(
    uint kernel, vec3 offset, vec3 normal, vec3 power, float d2, float u, bool same, bvec2 flat_enough,
    inout vec3 sum, inout uint photons) {
    float mean = (power.x + power.y + power.z) * (1.0 / 3.0);
    if (same) {
        if (floatBitsToUint(d2) < error_moments_inner && flat_enough.x) {
            sum += power * kernel_weight(kernel, min(u, 1.0));
            photons++;
            if (2.0 * u <= 1.0 && flat_enough.y) eight_narrow += power * kernel_weight(kernel, 2.0 * u);
        }
        eight_wide += power * kernel_weight(kernel, min(0.5 * u, 1.0));
        vec3 scaled = offset * error_moments_reach;
        float x = dot3(scaled, error_moments_tangent), y = dot3(scaled, error_moments_bitangent);
        eight_power += vec3(mean, mean * mean, abs(dot3(scaled, normal)) > ERROR_MOMENTS_OFF_PLANE ? mean : 0.0);
        eight_slope += mean * vec3(x, y, x * x - y * y);
        eight_rest.x += mean * 2.0 * x * y;
        error_moments_photons++;
    } else {
        eight_power.z += mean;
    }
}

ErrorMoments error_moments_found() {
    vec3 power = error_moments_power.total - error_moments_power.excess;
    vec3 slope = error_moments_slope.total - error_moments_slope.excess;
    return ErrorMoments(
        error_moments_wide.total - error_moments_wide.excess, power.x, error_moments_narrow.total - error_moments_narrow.excess, power.y, slope.xy,
        vec2(slope.z, error_moments_rest.total.x - error_moments_rest.excess.x), power.z, error_moments_photons, uint[2](0u, 0u));
}

// Saves the sums, or restores them.
void error_moments_keep() {
    sum_keep(error_moments_wide);
    sum_keep(error_moments_narrow);
    sum_keep(error_moments_power);
    sum_keep(error_moments_slope);
    sum_keep(error_moments_rest);
    keep(error_moments_photons);
}

#endif
