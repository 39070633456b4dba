// Which light a shadow ray goes to. Twin of backend-cpu's choice.rs, in f32.
#ifndef CHOICE_GLSL
#define CHOICE_GLSL

#include "layout.glsl"
#include "sampling.glsl"
#include "scene.glsl"
#include "solid_angle.glsl"

// Up to so many lights are weighed for each query; more are chosen by power alone.
const uint FEW = 16;

// What is shared out evenly whatever the weights say.
const float BLIND = 0.1;

// Running sums of the probabilities at one query; power alone decides where the count is 0.
struct Choices {
    float ends[FEW];
    uint count;
};

// Roughly the unoccluded irradiance from a light, mean of RGB; 0 only where it is 0 or the light is in the plane but
// for roundings.
float weigh(SceneRef scene, uint index, vec3 position, vec3 normal) {
    Light light = scene.lights[index].at;
    float power = (light.power.x + light.power.y + light.power.z) / 3.0;
    if ((FEATURES & FEATURE_DIRECTIONAL_LIGHTS) != 0 && light.kind == LIGHT_DIRECTIONAL) {
        return power * max(-dot3(normal, light.direction), 0.0) / (3.14159265 * light.radius * light.radius);
    }
    if ((FEATURES & FEATURE_AREA_LIGHTS) != 0 && light.kind == LIGHT_TRIANGLE) {
        Emission lamp = scene.emissions[index].at;
        vec3 a = lamp.a - position, b = lamp.b - position, c = lamp.c - position;
        float height = -dot3(a, lamp.normal);
        if ((light.flags & LIGHT_BOTH_SIDES) != 0) {
            height = abs(height);
            power = 0.5 * power;
        }
        if (!(height > SOLID_ANGLE_LEAST_HEIGHT)) return 0.0;
        // The radiance times the solid angle: its cosine here varies within a lamp near by, and is left out.
        if (solid_angle_is_near(a, b, c)) {
            return power * solid_angle_of(a, b, c, height, light.area) / (3.14159265 * light.area);
        }
        vec3 gap = (a + b + c) / 3.0;
        float square = dot3(gap, gap);
        return power * height / (3.14159265 * (square * sqrt(square)));
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

// `lights` is 0 where there is nothing to weigh: one light, or more than a few.
Choices choices_at(SceneRef scene, uint lights, vec3 position, vec3 normal) {
    Choices choices;
    choices.count = 0;
    float total = 0.0;
    for (uint i = 0; i < lights; i++) {
        choices.ends[i] = weigh(scene, i, position, normal);
        total += choices.ends[i];
    }
    if (lights == 0 || !is_positive_finite(total)) return choices;
    float sum = 0.0;
    for (uint i = 0; i < lights; i++) {
        sum += BLIND / float(lights) + (1.0 - BLIND) * (choices.ends[i] / total);
        choices.ends[i] = sum;
    }
    choices.count = lights;
    return choices;
}

// A light, and its probability in `share`.
uint choices_pick(SceneRef scene, Choices choices, uint random, out float share) {
    if (choices.count == 0) {
        uint index = pick_light(scene, random);
        share = scene.emissions[index].at.probability;
        return index;
    }
    // The sums end at 1 but for rounding, hence in proportion to the last.
    float whole = choices.ends[choices.count - 1];
    float at = float(random) * (1.0 / 4294967296.0) * whole;
    float before = 0.0;
    uint index = 0;
    while (index + 1 < choices.count && choices.ends[index] <= at) {
        before = choices.ends[index];
        index++;
    }
    share = (choices.ends[index] - before) / whole;
    return index;
}

#endif
