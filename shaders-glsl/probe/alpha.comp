// Evaluates the functions of alpha.glsl and partial_transmission.glsl.
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
#include "shading/scene.glsl"

// A number, a cutoff or a triangle, and a word; or three numbers. Of a scene: barycentric coordinates, a word and the
// position of a triangle in BVH order; address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) return Output(uvec4(alpha_mix(words.a.x), 0u, 0u, 0u), uvec4(0u));
    if (FUNCTION == 1u) return Output(uvec4(alpha_keep(a.x, words.a.y, words.a.z) ? 1u : 0u, 0u, 0u, 0u), uvec4(0u));
    if (FUNCTION == 2u) return floats(vec4(alpha_coverage(a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
    if (FUNCTION == 4u) return floats(vec4(partial_share(a.x, a.y, a.z), 0.0, 0.0, 0.0), vec4(0.0));
    if (FUNCTION == 5u) return floats(vec4(partial_opaque_metallic(a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
    SceneRef scene = SceneRef(words.c.zw);
    uint index = scene.primitives[words.a.w].at.material;
    Material material = scene.materials[index].at;
    if (FUNCTION == 6u) {
        return floats(vec4(partial_share_at(scene, material, words.a.w, a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
    }
    if (FUNCTION == 7u) {
        uint met = partial_material(scene, index, words.a.w, a.x, a.y, words.a.z);
        return Output(uvec4(met, 0u, 0u, 0u), uvec4(0u));
    }
    return floats(vec4(alpha_coverage_of(scene, words.a.w, a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
}
