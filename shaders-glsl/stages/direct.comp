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
// A bit for the first light of each group; 0 without groups.
layout(constant_id = 4) const uint GROUPS = 0;

#include "shading/constants.glsl"
#include "device/grid.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/stretches.glsl"
#include "shading/random.glsl"
#include "shading/sampling.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/shadow_terminator.glsl"
#include "shading/two_float.glsl"
#include "shading/glossy.glsl"
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
    // DOMAIN_SHADOW, and the first camera sample in the upper half.
    uint domain;
    uint rays;
    // First query of this dispatch, and range of rays of each query.
    uint start;
    uint start_ray;
    uint end_ray;
    // Of a picture: queries of further samples have places beyond it.
    uint pixels;
};

layout(push_constant, scalar) uniform Push { Parameters push; };

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

void main() {
    uint i = push.start + thread();
    if (i >= min(push.count.needed, push.count.capacity)) return;
    vec3 position = push.queries[i].at.position;
    vec3 normal = push.queries[i].at.normal;
    uint key = push.queries[i].at.path;
    uint domain = push.domain + (push.queries[i].at.pixel / push.pixels << 16);
    vec3 shading = normal;
    if (SHADING_NORMALS) {
        shading = octahedral_unpack(push.queries[i].at.shading_normal);
        uint offset = push.queries[i].at.offset_or_wo;
        if (offset != 0u) {
            // The smooth surface instead of the triangle.
            position += shadow_terminator_unpack(offset);
            normal = shading;
        }
    }
    uint coat = GLOSSY ? push.queries[i].at.coat : 0u;
    vec3 from = off_surface(position, normal);
    LightSampler light_sampler = GROUPS == 0u
        ? light_sampler_at(push.scene, WEIGHED, position, normal)
        : light_sampler_for_rays(push.scene, WEIGHED, GROUPS, push.rays, position, normal);
    uvec4 first = philox4x32(uvec4(key, 0u, push.pass, domain), push.seed);
    vec3 sum = vec3(0.0);
    vec3 low = vec3(0.0);
    for (uint k = push.start_ray; k < push.end_ray; k++) {
        uvec4 words = k == 0u ? first : philox4x32(uvec4(key, k, push.pass, domain), push.seed);
        words.yz = evenly_spread(first.yz, k);
        float share;
        uint index = light_sampler_pick(
            push.scene, light_sampler, uvec2(stratum(k, push.rays, GROUPS == 0u ? words.x : first.x), words.w), share);
        LightSample found;
        if (!light_sample(push.scene, index, from, normal, words, found)) continue;
        Ray ray = found.ray;
        float cosine =
            SHADING_NORMALS ? shading_cosine(ray.direction, normal, shading) : dot3(normal, ray.direction);
        if (!(cosine > 0.0)) continue;
        vec3 value = light_sample_times(found, cosine);
        if (GLOSSY) value *= glossy_entering(push.scene, coat, dot3(ray.direction, shading));
        if (!occluded(push.scene, ray, words.w)) {
            if (may_attenuate(push.queries[i].at.media)) {
                value *= transmittance(push.scene, ray, ray.t_max, push.queries[i].at.media);
            }
            two_add(sum, low, value / share);
        }
    }
    vec3 before = push.start_ray == 0 ? vec3(0.0) : push.values[i].at;
    push.values[i].at = before + sum / float(push.rays);
}
