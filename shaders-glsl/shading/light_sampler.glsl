// Selects the light that a shadow ray samples. Twin of photon-core's light_sampler.rs, in f32.
#ifndef LIGHT_SAMPLER_GLSL
#define LIGHT_SAMPLER_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/light_tree.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/solid_angle.glsl"

const uint NO_LIGHT = 0xFFFFFFFFu;

// Cumulative probabilities of the lights at one query; if the count is 0, lights are chosen by the light tree if there
// is one, otherwise by power alone.
struct LightSampler {
    float cdf[LIGHT_SAMPLER_MAX_LIGHTS];
    uint count;
    // Only read if there is a light tree.
    vec3 position;
    vec3 normal;
};

// Approximate unoccluded irradiance from a light, mean of RGB; 0 only where it is 0, or where the query lies in
// the plane of the light up to rounding.
float weigh(SceneRef scene, uint index, vec3 position, vec3 normal) {
    Light light = scene.lights[index].at;
    float power = (light.power.x + light.power.y + light.power.z) / 3.0;
    if ((FEATURES & FEATURE_DIRECTIONAL_LIGHTS) != 0 && light.kind == LIGHT_DIRECTIONAL) {
        return power * max(-dot3(normal, light.direction), 0.0) / (3.14159265 * light.radius * light.radius);
    }
    if ((FEATURES & FEATURE_AREA_LIGHTS) != 0 && light.kind == LIGHT_TRIANGLE) {
        Emission area_light = scene.emissions[index].at;
        vec3 a = area_light.a - position, b = area_light.b - position, c = area_light.c - position;
        float height = -dot3(a, area_light.normal);
        if ((light.flags & LIGHT_BOTH_SIDES) != 0) {
            height = abs(height);
            power = 0.5 * power;
        }
        if (!(height > SOLID_ANGLE_MIN_HEIGHT)) return 0.0;
        // Radiance times solid angle: the cosine here varies over a nearby area light, and is omitted.
        if (solid_angle_is_near(a, b, c)) {
            return power * solid_angle_of(a, b, c, height, light.area) / (3.14159265 * light.area);
        }
        vec3 gap = (a + b + c) / 3.0;
        float square = dot3(gap, gap);
        return power * height / (3.14159265 * (square * sqrt(square)));
    }
    if ((FEATURES & FEATURE_ENVIRONMENT) != 0 && light.kind == LIGHT_ENVIRONMENT) {
        return power / (4.0 * 3.14159265 * light.radius * light.radius);
    }
    vec3 gap = light.position - position;
    float square = dot3(gap, gap);
    vec3 direction = gap / sqrt(square);
    float cosine = max(dot3(normal, direction), 0.0);
    float intensity = power / 12.5663706;
    if ((FEATURES & FEATURE_SPOT_LIGHTS) != 0 && light.kind == LIGHT_SPOT) {
        float off = sampling_versine(-direction, light.direction);
        intensity = power * spot_falloff(off, light.versine_inner, light.versine_outer)
            / spot_solid_angle(light.versine_inner, light.versine_outer);
    }
    return intensity * cosine / square;
}

// `lights` is 0 if there is nothing to weight: one light, or more than a few.
LightSampler light_sampler_at(SceneRef scene, uint lights, vec3 position, vec3 normal) {
    LightSampler light_sampler;
    light_sampler.count = 0;
    light_sampler.position = position;
    light_sampler.normal = normal;
    float total = 0.0;
    for (uint i = 0; i < lights; i++) {
        light_sampler.cdf[i] = weigh(scene, i, position, normal);
        total += light_sampler.cdf[i];
    }
    if (lights == 0 || !is_positive_finite(total)) return light_sampler;
    float sum = 0.0;
    for (uint i = 0; i < lights; i++) {
        sum += LIGHT_SAMPLER_DEFENSIVE_SHARE / float(lights) + (1.0 - LIGHT_SAMPLER_DEFENSIVE_SHARE) * (light_sampler.cdf[i] / total);
        light_sampler.cdf[i] = sum;
    }
    light_sampler.count = lights;
    return light_sampler;
}

// Picks a light by a random word, which a light tree extends by a second one. Returns it, and its probability in `share`.
uint light_sampler_pick(SceneRef scene, LightSampler light_sampler, uvec2 words, out float share) {
    if (LIGHT_TREE) return light_tree_pick(scene, light_sampler.position, light_sampler.normal, words, share);
    uint random = words.x;
    if (light_sampler.count == 0) {
        uint index = pick_light(scene, random);
        share = scene.emissions[index].at.probability;
        return index;
    }
    // The sums end at 1 only up to rounding, so the random number is scaled by the last one.
    float whole = light_sampler.cdf[light_sampler.count - 1];
    float at = float(random) * (1.0 / 4294967296.0) * whole;
    float before = 0.0;
    uint index = 0;
    while (index + 1 < light_sampler.count && light_sampler.cdf[index] <= at) {
        before = light_sampler.cdf[index];
        index++;
    }
    share = (light_sampler.cdf[index] - before) / whole;
    return index;
}

// The probability with which light_sampler_pick returns light `index`.
float light_sampler_probability(SceneRef scene, LightSampler light_sampler, uint index) {
    if (LIGHT_TREE) return light_tree_probability(scene, light_sampler.position, light_sampler.normal, index);
    if (light_sampler.count == 0) return scene.emissions[index].at.probability;
    float before = index == 0 ? 0.0 : light_sampler.cdf[index - 1];
    return (light_sampler.cdf[index] - before) / light_sampler.cdf[light_sampler.count - 1];
}

// The light that belongs to a triangle (Hit::primitive); NO_LIGHT if it is none.
uint light_of_triangle(SceneRef scene, uint primitive) {
    uint low = 0;
    uint high = scene.light_count;
    while (low < high) {
        uint middle = low + (high - low) / 2;
        Light light = scene.lights[middle].at;
        if (light.kind == LIGHT_TRIANGLE && light.primitive < primitive) low = middle + 1;
        else high = middle;
    }
    if (low == scene.light_count) return NO_LIGHT;
    Light light = scene.lights[low].at;
    return light.kind == LIGHT_TRIANGLE && light.primitive == primitive ? low : NO_LIGHT;
}

#endif
