// Light of light sources that is scattered once along segments, by shadow rays. Twin of backend-cpu's medium_direct.rs, with the
// same random numbers.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;
// Number of lights that are weighted at each segment; 0 if they are chosen by power alone.
layout(constant_id = 2) const uint WEIGHED = 0;
layout(constant_id = 3) const uint MEDIA = 4;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/equiangular.glsl"
#include "shading/light_intensity.glsl"
#include "shading/phase.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/segment.glsl"
#include "shading/shade.glsl"
#include "shading/spot_part.glsl"
#include "shading/stretches.glsl"
#include "shading/two_float.glsl"
#include "shading/light_sample.glsl"
#include "shading/light_sampler.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    Queries queries;
    Count count;
    Values values;
    uvec2 seed;
    uint pass;
    // DOMAIN_SEGMENT, and the first camera sample in the upper half.
    uint domain;
    uint rays;
    // First segment of this dispatch, and range of rays of each segment.
    uint start;
    uint start_ray;
    uint end_ray;
    // Of a picture: segments of further samples have places beyond it.
    uint pixels;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// Power of a light over the squared distance of the segment from its middle; of light from infinity, what gives the same
// irradiance.
float weight_along(uint index, Segment segment) {
    Light light = push.scene.lights[index].at;
    if (light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_ENVIRONMENT) {
        return 4.0 * (light.power.x + light.power.y + light.power.z) / (light.radius * light.radius);
    }
    vec3 middle = light.position;
    if (light.kind == LIGHT_TRIANGLE) {
        Emission area_light = push.scene.emissions[index].at;
        middle = (area_light.a + area_light.b + area_light.c) / 3.0;
    }
    vec3 gap = middle - segment.origin;
    vec3 nearest = segment.direction * clamp(dot3(gap, segment.direction), 0.0, segment.far);
    vec3 rest = gap - nearest;
    return (light.power.x + light.power.y + light.power.z) / max(dot3(rest, rest), 1e-6);
}

LightSampler lights_along(Segment segment) {
    LightSampler light_sampler;
    light_sampler.count = 0;
    float total = 0.0;
    for (uint i = 0; i < WEIGHED; i++) {
        light_sampler.cdf[i] = weight_along(i, segment);
        total += light_sampler.cdf[i];
    }
    light_sampler_by_weight(light_sampler, WEIGHED, total);
    return light_sampler;
}

// A point evenly over the area of light `index`; false for light from infinity.
bool sample_evenly(uint index, Light light, uvec2 point, out Target target) {
    target = Target(light.position, vec3(0.0), 0.0, vec2(0.0));
    if (light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_ENVIRONMENT) return false;
    if (light.kind == LIGHT_TRIANGLE) {
        Emission area_light = push.scene.emissions[index].at;
        target.weights = sampling_triangle(unit_f32(point.x), unit_f32(point.y));
        target.to = barycentric(area_light.a, area_light.b, area_light.c, target.weights.x, target.weights.y);
        target.front = area_light.normal;
    }
    return true;
}

const bool SPOT_LIGHTS = (FEATURES & FEATURE_SPOT_LIGHTS) != 0u;

// Whether the medium of the segment has a grid of densities, and then its columns.
bool grid_is_there;
Columns columns;

// A constant where no medium has a grid.
bool sees_grid() { return GRIDS && grid_is_there; }

// Radiance at the start of a segment by way of a place on it, chosen by `choice`, and a point on a light, over the density of
// both.
vec3 from_light(Segment segment, uint index, uvec2 point, float choice, uint alpha) {
    Light light = push.scene.lights[index].at;
    Medium medium = media_medium(push.scene, segment.media);
    precise float mean = flight_total(medium_extinction(medium)) / 3.0;
    // Places in the cone of a spot light alone, from `first` to `last`.
    float first = 0.0, last = segment.far;
    float before = 0.0, behind = sees_grid() ? columns_total() : segment.far;
    if (SPOT_LIGHTS && light.kind == LIGHT_SPOT) {
        vec3 origin = segment.origin, direction = segment.direction;
        if (!spot_part(origin, direction, last, light.position, light.direction, light.versine_outer, first, last)) {
            return vec3(0.0);
        }
        if (first > 0.0) before = sees_grid() ? columns_to(columns, first) : first;
        if (last < segment.far) behind = sees_grid() ? columns_to(columns, last) : last;
    }
    precise float whole = behind - before;
    if (!(whole > 0.0)) return vec3(0.0);
    Target target;
    bool is_near = sample_evenly(index, light, point, target);
    Equiangular angles;
    // One half by the angle seen from the light, one half by the transmittance (balance heuristic); by the latter alone for light
    // from infinity.
    bool by_angle = is_near && choice < 0.5;
    if (is_near) {
        precise vec3 start = segment.origin + segment.direction * first;
        precise float part = last - first;
        angles = equiangular_new(start, segment.direction, part, target.to);
        choice = by_angle ? 2.0 * choice : 2.0 * choice - 1.0;
    }
    float far = 0.0;
    if (by_angle) {
        precise float sampled = first + equiangular_sample(angles, choice);
        far = min(sampled, last);
    } else {
        precise float sampled = before + exponential_sample(mean, whole, choice);
        far = sampled;
        if (sees_grid()) far = columns_place(columns, far);
    }
    float column = sees_grid() ? columns_to(columns, far) : far;
    float local = sees_grid() ? columns_density(columns, far) : 1.0;
    if (!(local > 0.0)) return vec3(0.0);
    precise float passed = column - before;
    float density = exponential_density(mean, whole, max(passed, 0.0));
    precise vec3 from = segment.origin + segment.direction * far;
    Ray ray;
    vec3 arrives;
    if (is_near) {
        precise float along = far - first;
        density = 0.5 * (equiangular_density(angles, along) + local * density);
        if ((light.flags & LIGHT_BOTH_SIDES) != 0 && dot3(target.front, from - target.to) < 0.0) target.front = -target.front;
        if (light.kind == LIGHT_TRIANGLE) target.to = off_surface(target.to, target.front);
        precise vec3 gap = target.to - from;
        float square = dot3(gap, gap);
        if (!(square > 0.0)) return vec3(0.0);
        float away = sqrt(square);
        precise vec3 direction = gap / away;
        ray = Ray(from, direction, away);
        arrives = light_intensity(push.scene, index, light, target, direction) * (local / (square * density));
    } else {
        LightSample found;
        light_sample_far(push.scene, light, from, uvec4(0u, point, 0u), found);
        ray = found.ray;
        // The local density is that of places too.
        arrives = light_sample_times(found, 1.0) / density;
    }
    if (arrives == vec3(0.0) || occluded(push.scene, ray, alpha)) return vec3(0.0);
    float phase = phase_value(phase_of(medium), ray.direction, segment.direction);
    vec3 passes = medium_transmittance(medium, column) * transmittance(push.scene, ray, ray.t_max, segment.media);
    return arrives * medium.scattering * passes * phase;
}

void main() {
    uint i = push.start + thread();
    if (i >= min(push.count.needed, push.count.capacity)) return;
    Segment segment = segment_of(push.queries[i].at);
    uint key = push.queries[i].at.path;
    uint domain = push.domain + (push.queries[i].at.pixel / push.pixels << 16);
    LightSampler light_sampler = lights_along(segment);
    uint medium = media_current(push.scene, segment.media);
    grid_is_there = has_grid(push.scene, medium);
    uint end_ray = push.end_ray;
    if (sees_grid()) {
        GridTables tables = push.scene.grids;
        Grid grid = tables.grids[medium].at;
        columns = columns_new(tables, grid, segment.origin, segment.direction, segment.far);
        // Nothing is scattered there.
        if (!(columns_total() > 0.0)) end_ray = push.start_ray;
    }
    vec3 sum = vec3(0.0);
    vec3 low = vec3(0.0);
    uvec4 first = philox4x32(uvec4(key, 0u, push.pass, domain), push.seed);
    for (uint k = push.start_ray; k < end_ray; k++) {
        uvec4 words = k == 0u ? first : philox4x32(uvec4(key, k, push.pass, domain), push.seed);
        words.yz = evenly_spread(first.yz, k);
        float share;
        uint index = light_sampler_pick(push.scene, light_sampler, uvec2(words.x, 0u), share);
        // Each ray has its own part of the segment.
        precise float place = (float(k) + unit_f32(words.w)) / float(push.rays);
        uint alpha = 0u;
        if (RANDOM_SURFACES) alpha = philox4x32(uvec4(key, BLOCK_SEGMENTS + k, push.pass, domain), push.seed).y;
        two_add(sum, low, from_light(segment, index, words.yz, place, alpha) / share);
    }
    vec3 before = push.start_ray == 0 ? vec3(0.0) : push.values[i].at;
    push.values[i].at = before + sum / float(push.rays);
}
