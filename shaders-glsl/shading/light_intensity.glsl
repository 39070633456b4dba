// Points on lights, and the light that shines from them: twin of backend-cpu's light_sample.rs.
#ifndef LIGHT_INTENSITY_GLSL
#define LIGHT_INTENSITY_GLSL

#include "shading/coated_light.glsl"
#include "shading/constants.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"

// A sampled point on a light.
struct Target {
    vec3 to;
    // The normal of an area light on the side that the ray arrives at.
    vec3 front;
    // The reciprocal of the density per solid angle; 0 if the point is uniform in area.
    float per_pdf;
    // Its barycentric coordinates on the triangle of an area light.
    vec2 weights;
};

// Power of area light `index` as it shines from one point of it against `direction`: half of it if it has two sides, of which
// only one counts.
vec3 light_power_from_area(SceneRef scene, uint index, Light light, vec2 weights, vec3 direction) {
    vec3 power = light.power;
    uint slot = TEXTURED_LIGHTS || COATED_LIGHTS ? scene.emissions[index].at.slot : 0u;
    // A ratio to the power of the light.
    if (TEXTURED_LIGHTS) power *= shade_emission_ratio(scene, light, slot, weights.x, weights.y);
    if (COATED_LIGHTS) power *= emission_through(scene, slot, weights.x, weights.y, -direction);
    return power * ((light.flags & LIGHT_BOTH_SIDES) != 0 ? 0.5 : 1.0);
}

// Radiant intensity of a point or spot light against `direction`.
vec3 light_intensity_of_point(Light light, vec3 direction) {
    if ((FEATURES & FEATURE_SPOT_LIGHTS) == 0 || light.kind != LIGHT_SPOT) return light.power * 0.0795774715;
    float off = sampling_versine(-direction, light.direction);
    float falloff = spot_falloff(off, light.versine_inner, light.versine_outer);
    return light.power * (falloff / spot_solid_angle(light.versine_inner, light.versine_outer));
}

// Factor from the power of an area light to its radiant intensity, as if emitted from one point, at a cosine to its normal.
float light_lambert(float cosine) { return max(cosine * 0.318309886, 0.0); }

// Radiant intensity of light `index`, not infinitely far away, against `direction`; of an area light that of its whole power, as
// if emitted with a Lambertian cosine from the point.
vec3 light_intensity(SceneRef scene, uint index, Light light, Target target, vec3 direction) {
    if ((FEATURES & FEATURE_AREA_LIGHTS) == 0 || light.kind != LIGHT_TRIANGLE) {
        return light_intensity_of_point(light, direction);
    }
    float cosine = -dot3(direction, target.front);
    return light_power_from_area(scene, index, light, target.weights, direction) * light_lambert(cosine);
}

#endif
