// Traces final-gather rays from queries to the diffuse surfaces where photon maps are read. Twin of
// backend-cpu's final_gather.rs, with the same random numbers. One invocation per ray, the rays of a query
// consecutive; each hit becomes a query.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x_id = 1) in;

layout(constant_id = 0) const uint FEATURES = 511;
layout(constant_id = 2) const uint MEDIA = 1;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "device/long_counter.glsl"
#include "shading/layout.glsl"
#include "shading/octahedral.glsl"
#include "shading/offset.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/scattering.glsl"
#include "shading/shade.glsl"
#include "shading/stretches.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Parameters {
    SceneRef scene;
    Queries queries;
    Queries landings;
    uvec2 seed;
    uint pass;
    // Rays per query, in total and in this dispatch.
    uint rays;
    uint start_ray;
    uint count_rays;
    uint start_query;
    uint count_queries;
    uint max_bounces;
    uint padding;
    // Number of rays that were truncated.
    LongCounter truncated;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

// A position without photons: the query of a ray that hit nothing, whose estimate is 0.
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
    // Height stratified over the rays, which follow at golden angles.
    uint angle = philox4x32(uvec4(key, 0u, push.pass, DOMAIN_GATHER), push.seed).y + index * GOLDEN_STEP;
    precise float height = (float(index) + unit_f32(words.x)) / float(push.rays);
    // Sampled about the shading normal; the cosine may be smaller than that to it.
    vec3 axis = SHADING_NORMALS ? octahedral_unpack(push.queries[from].at.shading_normal) : normal;
    vec3 direction = cosine_hemisphere(axis, min(height, 1.0 - 1.1920929e-7), unit_f32(angle));
    Ray ray = Ray(off_surface(push.queries[from].at.position, normal), direction, NO_LIMIT);
    // In terms of radiance / n^2, which refraction does not change.
    vec3 throughput = vec3(1.0);
    if (SHADING_NORMALS) {
        throughput = vec3(min(shading_cosine(direction, normal, axis) / max(dot3(direction, axis), 1.17549435e-38), 1.0));
    }
    if (GLOSSY) throughput *= glossy_entering(push.scene, push.queries[from].at.coat, dot3(direction, axis));
    bool counts = throughput.x > 0.0;
    uint start = GLASS ? push.queries[from].at.media : VACUUM;
    uint media = start;
    uint wavelength = NO_WAVELENGTH;
    Query landing =
        Query(vec3(NOWHERE), 1.0, normal, from, vec3(0.0), 0u, 0u, key, 0u, 0u);
    Hit hit;
    uint total = 0u;
    uint bounce = 1;
    for (; counts && bounce <= push.max_bounces; bounce++) {
        uint word = 0u;
        if (RANDOM_SURFACES) word = philox4x32(uvec4(key, block + bounce, push.pass, DOMAIN_GATHER), push.seed).w;
        if (!nearest(push.scene, ray, word, hit)) break;
        Surface at = surface_met(push.scene, ray.direction, hit, word);
        Material material = push.scene.materials[at.material].at;
        vec3 facing = at.normal;
        Layers layers = layers_none();
        if (SHADED) {
            facing = shade(push.scene, at, hit, material, layers);
        }
        if (BENT_NORMALS && material.kind != MATERIAL_LAMBERT) shade_specular(at, ray.direction, facing);
        Interface sides = media_interface(push.scene, material, at.front, media);
        if (may_attenuate(sides.before)) throughput *= transmittance(push.scene, ray, at.t, sides.before);
        if (DISPERSION && media_is_dispersive(push.scene, sides)) {
            uint drawn = wavelength_word(push.seed, push.pass, DOMAIN_GATHER, key, index);
            media_disperse(push.scene, sides, wavelength, throughput, drawn);
        }
        uint rule = scattering_at(material, sides);
        // The bounce's random numbers, if they are needed.
        uvec4 words = uvec4(0u);
        if ((FOLLOWED && rule != SCATTERING_SIMPLE) || kind_transmits(material.kind)) {
            words = philox4x32(uvec4(key, block + bounce, push.pass, DOMAIN_GATHER), push.seed);
        }
        vec3 random = vec3(unit_f32(words.x), unit_f32(words.y), unit_f32(words.z));
        vec3 albedo;
        if (GLOSSY && rule == SCATTERING_GLOSSY) {
            Glossy glossy = glossy_at(push.scene, material, layers, at.cosine, -ray.direction, false);
            float first = glossy.specular_probability;
            if (random.x < first) {
                vec3 onward;
                Reflected reflected =
                    glossy_sample(push.scene, glossy, -ray.direction, facing, random.y, random.z, onward);
                throughput *= glossy_weight(reflected, glossy_limited(onward, at.normal, facing) / first);
                if (throughput == vec3(0.0)) break;
                ray = surface_leave(at, onward);
                continue;
            }
            albedo = glossy.diffuse / (1.0 - first);
            float second = glossy.transmission_probability;
            if (DIFFUSE_TRANSMISSION && second > 0.0) {
                if (glossy_rest(random.x, first) < second) {
                    // The light of the other side.
                    albedo = glossy.transmitted / ((1.0 - first) * second);
                    at.normal = -at.normal;
                    facing = -facing;
                } else {
                    albedo = albedo / (1.0 - second);
                }
            }
        } else if (ROUGH_GLASS && rule == SCATTERING_ROUGH_GLASS) {
            RoughGlass glass = rough_glass_new(push.scene, material, at.cosine, sides);
            RoughSample drawn =
                rough_glass_sample(push.scene, glass, -ray.direction, facing, random.x, random.y, random.z);
            vec3 geometric = drawn.stays ? at.normal : -at.normal;
            float limited = glossy_limited(drawn.direction, geometric, drawn.stays ? facing : -facing);
            throughput *= glossy_weight(drawn.found, limited);
            if (throughput == vec3(0.0)) break;
            media = drawn.stays ? sides.before : sides.transmitted;
            if (drawn.stays) ray = surface_leave(at, drawn.direction);
            else ray = surface_pass(at, drawn.direction);
            continue;
        } else {
            Bsdf bsdf = bsdf_new(material, at.cosine, sides);
            uint lobe = bsdf_choose(bsdf, random.x);
            if (lobe != LOBE_DIFFUSE) {
                if (bsdf_is_total(bsdf) && ++total > most_total_reflections(push.max_bounces)) {
                    bounce = push.max_bounces + 1u;
                    break;
                }
                throughput *= bsdf_weight(bsdf, lobe);
                vec3 onward = bsdf_direction(bsdf, lobe, ray.direction, facing, 0.0, 0.0);
                if (SHADING_NORMALS) onward = shading_on_side(lobe == LOBE_SPECULAR_TRANSMISSION, onward, at.normal);
                if (lobe == LOBE_SPECULAR_TRANSMISSION) {
                    ray = surface_pass(at, onward);
                    media = sides.transmitted;
                } else {
                    ray = surface_leave(at, onward);
                }
                continue;
            }
            albedo = bsdf_weight(bsdf, lobe);
        }
        // Radiance is irradiance times albedo over π; the π cancels.
        landing.position = at.point;
        landing.normal = at.normal;
        if (GLASS) throughput *= radiance_scale(push.scene, start, sides.before, wavelength);
        landing.throughput = throughput * albedo;
        landing.media = sides.before;
        if (SHADING_NORMALS) landing.shading_normal = octahedral_pack(facing);
        break;
    }
    if (bounce > push.max_bounces) count_one(push.truncated);
    push.landings[i].at = landing;
}
