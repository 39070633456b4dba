// Evaluates the functions of light_tree.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;

#include "probe/probe.glsl"
#include "shading/light_sampler.glsl"

// Position and index of a light; normal and index of a node; two random words, address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) return Output(uvec4(extend_word(words.a.x, words.a.y, words.a.z), 0u, 0u, 0u), uvec4(0u));
    SceneRef scene = SceneRef(words.c.zw);
    if (FUNCTION == 1u) {
        float importance = light_node_importance(scene.light_tree.nodes[words.b.w].at, a.xyz, b.xyz);
        return floats(vec4(importance, 0.0, 0.0, 0.0), vec4(0.0));
    }
    LightSampler light_sampler = light_sampler_at(scene, 0u, a.xyz, b.xyz);
    if (FUNCTION == 2u) {
        float share;
        uint index = light_sampler_pick(scene, light_sampler, words.c.xy, share);
        return floats(vec4(float(index), share, 0.0, 0.0), vec4(0.0));
    }
    float probability = 0.0;
    if (FUNCTION == 3u) {
        probability = light_sampler_probability(scene, light_sampler, words.a.w);
    } else {
        for (uint i = 0u; i < scene.light_count; i++) probability += light_sampler_probability(scene, light_sampler, i);
    }
    return floats(vec4(probability, 0.0, 0.0, 0.0), vec4(0.0));
}
