// Photons of point and spot lights outside of the scene: twin of photon-core's light_cone.rs.
#ifndef LIGHT_CONE_GLSL
#define LIGHT_CONE_GLSL

#include "shading/layout.glsl"
#include "shading/sampling.glsl"

float light_cone_versine(float versine, float u) {
    precise float within = versine * u;
    return within;
}

// A direction within the cone, and the intensity of the light there over the greatest.
vec3 light_cone_sample(Light light, vec3 axis, float versine, float u, float turns, out float intensity) {
    vec3 direction = sampling_about(axis, light_cone_versine(versine, u), turns);
    intensity = 1.0;
    if (light.kind != LIGHT_SPOT) return direction;
    intensity = spot_falloff(sampling_versine(direction, light.direction), light.versine_inner, light.versine_outer);
    return intensity > 0.0 ? direction : -direction;
}

#endif
