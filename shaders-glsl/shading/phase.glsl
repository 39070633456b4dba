// The phase function of Henyey and Greenstein. Twin of photon-core's phase.rs.
#ifndef PHASE_GLSL
#define PHASE_GLSL

#include "shading/math.glsl"
#include "shading/sampling.glsl"

// Density per solid angle of scattering by an angle of this cosine between the directions of travel.
float phase_value(float anisotropy, float cosine) {
    float a = abs(anisotropy);
    float along = anisotropy < 0.0 ? -cosine : cosine;
    // 1 + a^2 - 2a cos, without cancellation.
    precise float base = (1.0 - a) * (1.0 - a) + 2.0 * a * max(1.0 - along, 0.0);
    precise float density = 0.0795774715 * (1.0 - a) * (1.0 + a) / (base * sqrt(base));
    return density;
}

// A direction of travel with this density after travel along `direction`.
vec3 phase_sample(float anisotropy, vec3 direction, float u, float v) {
    float a = abs(anisotropy);
    vec3 axis = anisotropy < 0.0 ? -direction : direction;
    precise float narrow = 1.0 - a;
    precise float below = (1.0 - a) + 2.0 * a * u;
    precise float versine = 2.0 * (1.0 - u) * (1.0 + a * u) * (narrow * narrow / (below * below));
    return sampling_about(axis, min(versine, 2.0), v);
}

#endif
