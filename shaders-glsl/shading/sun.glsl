// The disc of a directional light: twin of Light::is_sun and sun_radiance. The including kernel declares FEATURES.
#ifndef SUN_GLSL
#define SUN_GLSL

#include "shading/constants.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"

const bool SUN = (FEATURES & FEATURE_SUN) != 0u;

bool is_sun(Light light) {
    return light.kind == LIGHT_DIRECTIONAL && light.versine_outer > 0.0;
}

// In a function of its own, since the compiler does not support `precise` on values just loaded.
vec3 sun_disc_radiance(vec3 power, float radius, float versine) {
    precise float through = 3.14159265 * radius * radius;
    precise float squared_sine = versine * (2.0 - versine);
    precise vec3 radiance = power / (through * (3.14159265 * squared_sine));
    return radiance;
}

// Radiance from a direction, a unit vector, in which nothing is hit.
vec3 sun_radiance(SceneRef scene, vec3 direction) {
    // It is among the last lights.
    for (uint index = scene.light_count; index > 0u; index--) {
        Light light = scene.lights[index - 1u].at;
        if (is_sun(light)) {
            if (sampling_versine(direction, -light.direction) > light.versine_outer) return vec3(0.0);
            return sun_disc_radiance(light.power, light.radius, light.versine_outer);
        }
    }
    return vec3(0.0);
}

#endif
