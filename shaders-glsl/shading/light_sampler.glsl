// Selects the light that a shadow ray samples. Twin of photon-core's light_sampler.rs, in f32.
#ifndef LIGHT_SAMPLER_GLSL
#define LIGHT_SAMPLER_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/light_tree.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/solid_angle.glsl"
#include "shading/sun.glsl"

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
        float cosine = -dot3(normal, light.direction);
        float risen = max(cosine, 0.0);
        if (SUN) {
            // A part of the disc of a sun may be above the horizon though its centre is below.
            float sine = sqrt(max(light.versine_outer * (2.0 - light.versine_outer), 0.0));
            if (abs(cosine) < sine) risen = (cosine + sine) * (cosine + sine) / (4.0 * sine);
        }
        return power * risen / (3.14159265 * light.radius * light.radius);
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
        // Radiance times solid angle and the mean cosine of the corners: 0 only if all of them are below the horizon.
        vec3 above = max(vec3(dot3(normal, a), dot3(normal, b), dot3(normal, c)), 0.0);
        if (solid_angle_is_near(a, b, c)) {
            vec3 lengths = max(sqrt(vec3(dot3(a, a), dot3(b, b), dot3(c, c))), 1.17549435e-38);
            float cosine = (above.x / lengths.x + above.y / lengths.y + above.z / lengths.z) / 3.0;
            return power * (solid_angle_of(a, b, c, height, light.area) * cosine) / (3.14159265 * light.area);
        }
        vec3 gap = (a + b + c) / 3.0;
        float square = dot3(gap, gap);
        return power * (height * ((above.x + above.y + above.z) / 3.0)) / (3.14159265 * (square * square));
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

// The weights of the lights instead of cumulative probabilities, and their sum. `lights` is 0 if there is nothing to weight:
// one light, or more than a few.
LightSampler light_sampler_weighed(SceneRef scene, uint lights, vec3 position, vec3 normal, out float total) {
    LightSampler light_sampler;
    light_sampler.count = 0;
    light_sampler.position = position;
    light_sampler.normal = normal;
    total = 0.0;
    for (uint i = 0; i < lights; i++) {
        light_sampler.cdf[i] = weigh(scene, i, position, normal);
        total += light_sampler.cdf[i];
    }
    return light_sampler;
}

// From weights to probabilities that are proportional to them.
void light_sampler_by_weight(inout LightSampler light_sampler, uint lights, float total) {
    if (lights == 0 || !is_positive_finite(total)) return;
    float sum = 0.0;
    for (uint i = 0; i < lights; i++) {
        sum += LIGHT_SAMPLER_DEFENSIVE_SHARE / float(lights) + (1.0 - LIGHT_SAMPLER_DEFENSIVE_SHARE) * (light_sampler.cdf[i] / total);
        light_sampler.cdf[i] = sum;
    }
    light_sampler.count = lights;
}

LightSampler light_sampler_at(SceneRef scene, uint lights, vec3 position, vec3 normal) {
    float total;
    LightSampler light_sampler = light_sampler_weighed(scene, lights, position, normal, total);
    light_sampler_by_weight(light_sampler, lights, total);
    return light_sampler;
}

// The end of the group of lights that starts with `first`; `starts` has a bit for the first light of each group. `sum`: of
// the weights of the group.
uint light_group_end(LightSampler weighed, uint lights, uint starts, uint first, out float sum) {
    sum = weighed.cdf[first];
    uint end = first + 1u;
    for (; end < lights && (starts >> end & 1u) == 0u; end++) sum += weighed.cdf[end];
    return end;
}

// Groups, as bits of their first lights, that would get more than one of the rays by their weights.
uint light_groups_strongest(LightSampler weighed, uint lights, uint starts, uint rays) {
    uint found = 0u;
    for (uint count = 0u; count + 1u < rays; count++) {
        float all = 0.0, largest = 0.0, sum;
        uint at = 0u;
        for (uint first = 0u, end; first < lights; first = end) {
            end = light_group_end(weighed, lights, starts, first, sum);
            if ((found >> first & 1u) != 0u) continue;
            all += sum;
            if (sum > largest) {
                largest = sum;
                at = first;
            }
        }
        if (!(largest * float(rays - count) > all)) break;
        found |= 1u << at;
    }
    return found;
}

// The probability of a light within a group of this sum of weights.
float light_within(float weight, float sum, uint lights) {
    float even = 1.0 / float(lights);
    return LIGHT_SAMPLER_DEFENSIVE_SHARE * even
        + (1.0 - LIGHT_SAMPLER_DEFENSIVE_SHARE) * (sum > 0.0 ? weight / sum : even);
}

// For `rays` shadow rays, whose random words are the same but for a multiple of a part of their range. Twin of photon-core's
// light_sampler/groups.rs.
LightSampler light_sampler_for_rays(
    SceneRef scene, uint lights, uint starts, uint rays, vec3 position, vec3 normal) {
    float total, sum;
    LightSampler light_sampler = light_sampler_weighed(scene, lights, position, normal, total);
    uint seen = 0u;
    for (uint first = 0u, end; first < lights; first = end) {
        end = light_group_end(light_sampler, lights, starts, first, sum);
        if (sum > 0.0) seen |= 1u << first;
    }
    uint count = uint(bitCount(seen));
    bool enough = count <= rays;
    uint with_ray = enough ? seen : light_groups_strongest(light_sampler, lights, starts, rays);
    if (with_ray == 0u || !is_positive_finite(total)) {
        light_sampler_by_weight(light_sampler, lights, total);
        return light_sampler;
    }
    uint other_lights = 0u;
    float other_weights = 0.0;
    for (uint first = 0u, end; first < lights; first = end) {
        end = light_group_end(light_sampler, lights, starts, first, sum);
        if ((with_ray >> first & 1u) != 0u) continue;
        other_lights += end - first;
        other_weights += sum;
    }
    float unseen = LIGHT_SAMPLER_UNSEEN_SHARE / float(lights);
    float in_view = enough ? 1.0 - unseen * float(other_lights) : 1.0;
    float of_group = 1.0 / float(rays);
    float rest = float(rays - uint(bitCount(with_ray))) * of_group;
    float cumulative = 0.0;
    for (uint first = 0u, end; first < lights; first = end) {
        end = light_group_end(light_sampler, lights, starts, first, sum);
        for (uint i = first; i < end; i++) {
            float weight = light_sampler.cdf[i];
            if ((with_ray >> first & 1u) != 0u) {
                float within = of_group * light_within(weight, sum, end - first);
                cumulative += enough ? in_view * (within + rest * (weight / total)) : within;
            } else {
                cumulative += enough ? unseen : rest * light_within(weight, other_weights, other_lights);
            }
            light_sampler.cdf[i] = cumulative;
        }
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
