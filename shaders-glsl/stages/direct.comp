// Direct light by next-event estimation: mean irradiance over the shadow rays of each query. Twin of
// backend-cpu's direct.rs, with the same random numbers.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;
// Number of lights that are weighted at each query; 0 for one light and for a light tree.
layout(constant_id = 2) const uint WEIGHED = 0;
layout(constant_id = 3) const uint MEDIA = 1;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/media.glsl"
#include "shading/offset.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/solid_angle.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/environment.glsl"
#include "shading/two_float.glsl"
#include "shading/light_sampler.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Count { uint needed; uint capacity; };

layout(push_constant, scalar) uniform Push {
    SceneRef scene;
    Queries queries;
    Count count;
    Values values;
    uvec2 seed;
    uint pass;
    uint rays;
    // First query of this dispatch, and range of rays of each query.
    uint start;
    uint start_ray;
    uint end_ray;
} push;

// ⌊(ray · 2³² + random) / rays⌋, for ray < rays: stratified selection of lights.
uint stratum(uint ray, uint rays, uint random) {
    if (rays == 1) return random;
    if (rays < 65536) {
        // 2³² = whole · rays + rest.
        uint whole = 0xFFFFFFFFu / rays;
        uint rest = 0xFFFFFFFFu % rays + 1;
        return ray * whole + random / rays + (ray * rest + random % rays) / rays;
    }
    // Bit by bit; the remainder stays below `rays`.
    uint quotient = 0;
    uint carried = ray;
    for (int bit = 31; bit >= 0; bit--) {
        bool over = carried >> 31 != 0;
        carried = carried << 1 | (random >> bit & 1);
        if (over || carried >= rays) {
            carried -= rays;
            quotient |= 1u << bit;
        }
    }
    return quotient;
}

// A sampled point on a light.
struct Target {
    vec3 to;
    // The normal of an area light on the side that the ray arrives at.
    vec3 front;
    // Solid angle of the whole area light, if the point is uniform in solid angle; 0 if it is uniform in area.
    float solid_angle;
    // Its barycentric coordinates on the triangle of an area light.
    vec2 weights;
};

// Samples a point of a triangle, on the side that faces the query; returns false if none does.
bool at_area_light(Emission area_light, Light light, vec3 from, float u, float v, out Target target) {
    target.front = area_light.normal;
    target.solid_angle = 0.0;
    target.to = area_light.a;
    target.weights = vec2(0.0);
    if ((light.flags & LIGHT_BOTH_SIDES) != 0 && dot3(area_light.normal, from - area_light.a) < 0.0) target.front = -area_light.normal;
    // As seen from as far behind the query as shadow rays end above the light.
    vec3 eye = off_surface(from, -target.front);
    vec3 a = area_light.a - eye, b = area_light.b - eye, c = area_light.c - eye;
    float height = -dot3(target.front, a);
    bool near = solid_angle_is_near(a, b, c);
    if (!(height > (near ? SOLID_ANGLE_MIN_HEIGHT : 0.0))) return false;
    vec2 weights;
    if (!near
        || !solid_angle_sample(a, b, c, height, light.area, u, v, weights, target.solid_angle)) {
        weights = sampling_triangle(u, v);
    }
    target.weights = weights;
    target.to = off_surface(barycentric(area_light.a, area_light.b, area_light.c, weights.x, weights.y), target.front);
    return true;
}

// Unoccluded irradiance from one point of a light divided by its pdf, and the shadow ray. Returns false if the
// light faces the other way. Without shading normals, `shading` is not read.
bool sample_light(
    uint index, vec3 position, vec3 normal, vec3 shading, uvec4 words, out vec3 value, out Ray ray) {
    Light light = push.scene.lights[index].at;
    vec3 from = off_surface(position, normal);
    value = vec3(0.0);
    ray = Ray(from, normal, 0.0);
    if ((FEATURES & FEATURE_DIRECTIONAL_LIGHTS) != 0 && light.kind == LIGHT_DIRECTIONAL) {
        float cosine = SHADING_NORMALS ? shading_cosine(-light.direction, normal, shading) : -dot3(normal, light.direction);
        value = light.power * (cosine / (3.14159265 * light.radius * light.radius));
        ray = Ray(from, -light.direction, NO_LIMIT);
        return cosine > 0.0;
    }
    if (ENVIRONMENT && light.kind == LIGHT_ENVIRONMENT) {
        EnvironmentSample found = environment_sample(push.scene, words.yz);
        float cosine =
            SHADING_NORMALS ? shading_cosine(found.direction, normal, shading) : dot3(normal, found.direction);
        value = found.weight * cosine;
        ray = Ray(from, found.direction, NO_LIMIT);
        return cosine > 0.0;
    }
    Target target = Target(light.position, vec3(0.0), 0.0, vec2(0.0));
    if ((FEATURES & FEATURE_AREA_LIGHTS) != 0 && light.kind == LIGHT_TRIANGLE
        && !at_area_light(push.scene.emissions[index].at, light, from, unit_f32(words.y), unit_f32(words.z), target)) {
        return false;
    }
    vec3 gap = target.to - from;
    float square = dot3(gap, gap);
    float far = sqrt(square);
    vec3 direction = gap / far;
    float cosine = SHADING_NORMALS ? shading_cosine(direction, normal, shading) : dot3(normal, direction);
    ray = Ray(from, direction, far);
    if (!(cosine > 0.0)) return false;
    vec3 power = light.power;
    if (TEXTURED_LIGHTS && light.kind == LIGHT_TRIANGLE) {
        uint slot = push.scene.emissions[index].at.slot;
        power *= shade_emission_ratio(push.scene, light, slot, target.weights.x, target.weights.y);
    }
    // A two-sided light splits its power between its sides; only the one facing the query contributes.
    float sides = (light.flags & LIGHT_BOTH_SIDES) != 0 ? 0.5 : 1.0;
    if ((FEATURES & FEATURE_AREA_LIGHTS) != 0 && target.solid_angle > 0.0) {
        // The radiance is the power divided by π and the area.
        value = power * sides * (target.solid_angle * 0.318309886 / light.area * cosine);
        return true;
    }
    // Radiant intensity towards the query.
    vec3 intensity;
    if ((FEATURES & FEATURE_POINT_LIGHTS) != 0 && light.kind == LIGHT_POINT) {
        intensity = light.power * 0.0795774715;
    } else if ((FEATURES & FEATURE_SPOT_LIGHTS) != 0 && light.kind == LIGHT_SPOT) {
        float off = sampling_versine(-direction, light.direction);
        float falloff = spot_falloff(off, light.versine_inner, light.versine_outer);
        intensity = light.power * (falloff / spot_solid_angle(light.versine_inner, light.versine_outer));
    } else {
        // All its power, as if it left from this point with a Lambertian cosine.
        intensity = power * sides * max(-dot3(direction, target.front) * 0.318309886, 0.0);
    }
    value = intensity * (cosine / square);
    return intensity != vec3(0.0);
}

void main() {
    uint i = push.start + thread();
    if (i >= min(push.count.needed, push.count.capacity)) return;
    vec3 position = push.queries[i].at.position;
    vec3 normal = push.queries[i].at.normal;
    uint key = push.queries[i].at.path;
    vec3 shading = normal;
    if (SHADING_NORMALS) shading = octahedral_unpack(push.queries[i].at.shading_normal);
    LightSampler light_sampler = light_sampler_at(push.scene, WEIGHED, position, normal);
    vec3 sum = vec3(0.0);
    vec3 low = vec3(0.0);
    for (uint k = push.start_ray; k < push.end_ray; k++) {
        uvec4 words = philox4x32(uvec4(key, k, push.pass, DOMAIN_SHADOW), push.seed);
        float share;
        uint index = light_sampler_pick(push.scene, light_sampler, uvec2(stratum(k, push.rays, words.x), words.w), share);
        vec3 value;
        Ray ray;
        if (sample_light(index, position, normal, shading, words, value, ray)
            && !occluded(push.scene, ray)) {
            // The shadow ray is unoccluded, so that it lies entirely in the query's medium.
            if ((FEATURES & FEATURE_ABSORPTION) != 0 && push.queries[i].at.media != VACUUM) {
                value *= transmittance(push.scene, push.queries[i].at.media, ray.t_max);
            }
            two_add(sum, low, value / share);
        }
    }
    vec3 before = push.start_ray == 0 ? vec3(0.0) : push.values[i].at;
    push.values[i].at = before + sum / float(push.rays);
}
