// Evaluates the functions of gloss_caustics.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/gloss_caustics.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    uvec4 found = uvec4(0u);
    if (FUNCTION == 0u) {
        Material material;
        material.roughness = a.x;
        Layers layers = layers_none();
        layers.clearcoat = a.y;
        layers.clearcoat_roughness = a.z;
        layers.sheen_color = vec3(0.0, a.w, 0.0);
        layers.sheen_roughness = b.x;
        found.x = floatBitsToUint(gloss_caustics_narrowest(material, layers));
    } else if (FUNCTION == 1u) {
        found.x = gloss_caustics_with_mark(words.a.x, (words.a.y & 1u) != 0u);
        found.y = gloss_caustics_counts(words.a.x, words.a.y) ? 1u : 0u;
    } else {
        found.x = gloss_caustics_is_sampled_only(words.a.x) ? 1u : 0u;
    }
    return Output(found, uvec4(0u));
}
