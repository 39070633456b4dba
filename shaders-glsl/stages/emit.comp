// Photon emission, one invocation per path: twin of backend-cpu's emit.rs.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = 511;
layout(constant_id = 2) const uint RANDOM = 0;
// Whether photons are aimed at mirrors and glass by a projection map.
layout(constant_id = 3) const bool AIMED = false;

#include "shading/projection.glsl"
#include "device/grid.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/light_cone.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/coated_light.glsl"
#include "shading/environment.glsl"
#include "shading/sun.glsl"
#include "shading/portals.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    PhotonRays rays;
    uvec2 seed;
    uint pass;
    uint first;
    uint count;
    uint portal_count;
    ProjectionRef projection;
    PortalTable portals;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// In a function of its own, since the compiler does not support `precise` on values just loaded.
vec3 behind_disc(vec3 along, vec3 tangent, vec3 bitangent, vec2 at, float radius) {
    precise vec3 behind = (tangent * at.x + bitangent * at.y - along) * radius;
    return behind;
}

// The same for the disc of the sun, from twice its radius away.
vec3 before_disc(vec3 along, vec3 tangent, vec3 bitangent, vec2 at, float radius) {
    precise vec3 before = (tangent * at.x + bitangent * at.y - along * 2.0) * radius;
    return before;
}

// The start of a photon behind a disc of aimed photons, from as far away as those that are not aimed.
vec3 behind_part(vec3 along, vec3 tangent, vec3 bitangent, vec2 at, vec4 disc, float radius) {
    precise float away = radius + (disc.x * along.x + disc.y * along.y + disc.z * along.z);
    precise vec3 behind = disc.xyz + (tangent * at.x + bitangent * at.y) * disc.w - along * away;
    return behind;
}

// The power of a photon of an environment; `carried` over `power` is the reciprocal of the light's probability.
vec3 environment_power(vec3 weight, vec3 power, vec3 carried, float radius) {
    float reciprocal = max(max(carried.x, carried.y), carried.z) / max(max(power.x, power.y), power.z);
    precise vec3 found = weight * (3.14159265 * radius * radius * reciprocal);
    return found;
}

void main() {
    uint index = thread();
    if (index >= push.count) return;
    uint path = push.first + index;
    Sampler numbers = sampler_new(RANDOM, push.seed, push.pass, AIMED ? DOMAIN_AIMED : DOMAIN_PHOTON, path);
    uvec4 choice = sampler_words(numbers, BLOCK_LIGHT);
    uvec4 start = sampler_words(numbers, BLOCK_START);
    uint picked;
    vec3 carried;
    ProjectionSample projected;
    if (AIMED) {
        projected = projection_sample(push.projection, choice, start);
        picked = projected.light;
        carried = projected.carried;
        choice.yzw = uvec3(projected.point, projected.side);
        start.xy = projected.direction;
    } else {
        picked = pick_light(push.scene, choice.x);
        carried = push.scene.emissions[picked].at.carried;
    }
    float a = unit_f32(choice.y);
    float b = unit_f32(choice.z);
    float c = unit_f32(start.x);
    float d = unit_f32(start.y);
    Light light = push.scene.lights[picked].at;
    Emission emission = push.scene.emissions[picked].at;
    vec3 origin = light.position;
    vec3 direction = light.direction;
    uint media = emission.media.x;
    bool has_place = light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT;
    if ((FEATURES & (FEATURE_POINT_LIGHTS | FEATURE_SPOT_LIGHTS)) != 0u && has_place && emission.margin > 0.0) {
        float intensity;
        direction = light_cone_sample(light, emission.normal, emission.margin, c, d, intensity);
        carried = shade_multiply(carried, vec3(intensity));
    } else if ((FEATURES & FEATURE_POINT_LIGHTS) != 0u && light.kind == LIGHT_POINT) {
        direction = uniform_sphere(centred_f32(start.x), d);
    } else if ((FEATURES & FEATURE_SPOT_LIGHTS) != 0u && light.kind == LIGHT_SPOT) {
        direction = sampling_about(light.direction, spot_versine(light.versine_inner, light.versine_outer, c), d);
    } else if ((FEATURES & FEATURE_DIRECTIONAL_LIGHTS) != 0u && light.kind == LIGHT_DIRECTIONAL) {
        if (PORTALS && !AIMED) {
            bool sun = SUN && is_sun(light);
            if (sun) direction = sampling_about(light.direction, sun_versine(light.versine_outer, c), d);
            PortalLine line =
                portals_sample(push.portals, push.portal_count, direction, choice.w, vec2(a, b), light.radius);
            origin = portal_origin(line.across, direction, sun ? 2.0 * light.radius : light.radius);
            carried = sun ? portal_sun_power(carried, line.factor, direction, light.direction)
                : portal_power(carried, line.factor);
        } else {
            vec2 at = sampling_disc(a, b);
            vec3 tangent, bitangent;
            sampling_basis(light.direction, tangent, bitangent);
            if (SUN && is_sun(light)) {
                // Through the disc in the plane of the scene's centre.
                vec3 along = sampling_about(light.direction, sun_versine(light.versine_outer, c), d);
                if (AIMED) {
                    vec4 disc = projection_disc(push.projection, projected);
                    origin = behind_part(along, tangent, bitangent, at, disc, 2.0 * light.radius);
                } else {
                    origin = before_disc(along, tangent, bitangent, at, light.radius);
                }
                direction = along;
            } else if (AIMED) {
                vec4 disc = projection_disc(push.projection, projected);
                origin = behind_part(light.direction, tangent, bitangent, at, disc, light.radius);
            } else {
                origin = behind_disc(light.direction, tangent, bitangent, at, light.radius);
            }
        }
    } else if (ENVIRONMENT && light.kind == LIGHT_ENVIRONMENT) {
        EnvironmentSample found = environment_sample(push.scene, start.xy);
        direction = -found.direction;
        carried = environment_power(found.weight, light.power, carried, light.radius);
        if (PORTALS && !AIMED) {
            PortalLine line =
                portals_sample(push.portals, push.portal_count, direction, choice.w, vec2(a, b), light.radius);
            origin = portal_origin(line.across, direction, light.radius);
            carried = portal_power(carried, line.factor);
        } else {
            vec2 at = sampling_disc(a, b);
            vec3 tangent, bitangent;
            sampling_basis(direction, tangent, bitangent);
            if (AIMED) {
                vec4 disc = projection_disc(push.projection, projected);
                origin = behind_part(direction, tangent, bitangent, at, disc, light.radius);
            } else {
                origin = behind_disc(direction, tangent, bitangent, at, light.radius);
            }
        }
    } else if ((FEATURES & FEATURE_AREA_LIGHTS) != 0u) {
        vec2 weights = sampling_triangle(a, b);
        if (TEXTURED_LIGHTS) {
            carried = shade_multiply(
                carried, shade_emission_ratio(push.scene, light, emission.slot, weights.x, weights.y));
        }
        vec3 point = within(emission.a, emission.b, emission.c, emission.margin, weights.x, weights.y);
        bool back = (light.flags & LIGHT_BOTH_SIDES) != 0u && choice.w >> 31 == 1u;
        vec3 normal = back ? -emission.normal : emission.normal;
        if (back) media = emission.media.y;
        origin = off_surface(point, normal);
        direction = cosine_hemisphere(normal, c, d);
        if (COATED_LIGHTS) {
            float share = emission_through(push.scene, emission.slot, weights.x, weights.y, direction);
            carried = shade_multiply(carried, vec3(share));
        }
    }
    PhotonRay ray;
    ray.origin = origin;
    ray.path = path;
    ray.direction = direction;
    ray.light = picked;
    ray.power = carried;
    ray.media = media;
    push.rays[index].at = ray;
}
