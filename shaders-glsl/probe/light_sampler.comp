// Evaluates the functions of light_sampler.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL & ~FEATURE_LIGHT_TREE;

#include "probe/probe.glsl"
#include "shading/light_sampler.glsl"

// Position and index of a light; normal, and groups of lights (times 256) with a number of rays; random word, number of lights,
// address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    if (FUNCTION == 0u) return floats(vec4(weigh(scene, words.a.w, a.xyz, b.xyz), 0.0, 0.0, 0.0), vec4(0.0));
    LightSampler light_sampler = FUNCTION == 5u
        ? light_sampler_for_rays(scene, words.c.y, words.b.w >> 8, words.b.w & 255u, a.xyz, b.xyz)
        : light_sampler_at(scene, words.c.y, a.xyz, b.xyz);
    if (FUNCTION == 1u || FUNCTION == 5u) {
        float cdf[8];
        for (uint i = 0u; i < 8u; i++) cdf[i] = i < light_sampler.count ? light_sampler.cdf[i] : 0.0;
        return floats(vec4(cdf[0], cdf[1], cdf[2], cdf[3]), vec4(cdf[4], cdf[5], cdf[6], cdf[7]));
    }
    if (FUNCTION == 3u) {
        float sum = 0.0;
        for (uint i = 0u; i < scene.light_count; i++) sum += light_sampler_probability(scene, light_sampler, i);
        return floats(vec4(light_sampler_probability(scene, light_sampler, words.a.w), sum, 0.0, 0.0), vec4(0.0));
    }
    if (FUNCTION == 4u) return Output(uvec4(light_of_triangle(scene, words.c.x), 0u, 0u, 0u), uvec4(0u));
    float share;
    uint index = light_sampler_pick(scene, light_sampler, words.c.xx, share);
    return floats(vec4(float(index), share, 0.0, 0.0), vec4(0.0));
}
