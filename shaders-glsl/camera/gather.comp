// Follows final-gather rays from queries to the diffuse surfaces where photon maps are read. Twin of
// backend-cpu's gather.rs: the same random numbers. One invocation per ray, all rays of a query one
// after another; what lands is a query in its turn.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;

#include "boundary.glsl"
#include "bsdf.glsl"
#include "constants.glsl"
#include "grid.glsl"
#include "layout.glsl"
#include "octahedral.glsl"
#include "offset.glsl"
#include "random.glsl"
#include "sampling.glsl"
#include "scene.glsl"

layout(push_constant, scalar) uniform Push {
    SceneRef scene;
    Queries queries;
    Queries landings;
    uvec2 seed;
    uint pass;
    // Rays of a query, altogether and in this dispatch.
    uint rays;
    uint start_ray;
    uint count_rays;
    uint start_query;
    uint count_queries;
    uint max_bounces;
} push;

// Where no photon is: what has not landed asks there, and is told nothing.
const float NOWHERE = 1.0e6;

void main() {
    uint i = thread();
    uint local = i / push.count_rays;
    if (local >= push.count_queries) return;
    uint index = push.start_ray + i % push.count_rays;
    uint from = push.start_query + local;
    vec3 normal = push.queries[from].at.normal;
    uint key = push.queries[from].at.path;
    uint block = index * (push.max_bounces + 1);
    uvec4 words = philox4x32(uvec4(key, block, push.pass, DOMAIN_GATHER), push.seed);
    // One stratum of the height for each ray.
    precise float height = (float(index) + unit_f32(words.x)) / float(push.rays);
    vec3 direction = cosine_hemisphere(normal, min(height, 1.0 - 1.1920929e-7), unit_f32(words.y));
    Ray ray = Ray(off_surface(push.queries[from].at.position, normal), direction, NO_LIMIT);
    vec3 weight = vec3(1.0);
    uint medium = VACUUM;
    Query landing =
        Query(vec3(NOWHERE), 1.0, normal, from, vec3(0.0), 0u, 0u, key, uint[2](0u, 0u));
    Surface at;
    for (uint bounce = 1; bounce <= push.max_bounces && surface(push.scene, ray, at); bounce++) {
        Material material = push.scene.materials[at.material].at;
        if ((FEATURES & FEATURE_ABSORPTION) != 0) weight *= transmittance(push.scene, at, medium);
        if ((FEATURES & FEATURE_MIRROR) != 0 && material.kind == MATERIAL_MIRROR) {
            weight *= material.albedo;
            ray = surface_leave(at, bsdf_reflect(ray.direction, at.normal));
        } else if ((FEATURES & (FEATURE_DIELECTRIC | FEATURE_THIN)) != 0
            && (material.kind == MATERIAL_DIELECTRIC || material.kind == MATERIAL_THIN)) {
            vec3 beyond;
            float reflectance = boundary(material, at, ray.direction, beyond);
            uvec4 choice = philox4x32(uvec4(key, block + bounce, push.pass, DOMAIN_GATHER), push.seed);
            if (unit_f32(choice.x) < reflectance) {
                ray = surface_leave(at, bsdf_reflect(ray.direction, at.normal));
            } else {
                weight *= material.albedo;
                ray = surface_pass(at, beyond);
                medium = entered(material, at, medium);
            }
        } else {
            // Radiance is irradiance times albedo over π; the π cancels.
            landing.position = at.point;
            landing.normal = at.normal;
            landing.weight = weight * material.albedo;
            landing.material = at.material;
            landing.outgoing = octahedral_pack(-ray.direction);
            break;
        }
    }
    push.landings[i].at = landing;
}
