// Evaluates the functions of shadow_terminator.glsl.
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
#include "shading/shadow_terminator.glsl"

// A vector; a packed vector; or barycentric coordinates, the position of a triangle in BVH order, whether its front is
// seen, and the address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: return Output(uvec4(shadow_terminator_pack(a.xyz), 0u, 0u, 0u), uvec4(0u));
        case 1u: return floats(vec4(shadow_terminator_unpack(words.a.x), 0.0), vec4(0.0));
    }
    SceneRef scene = SceneRef(words.c.zw);
    Hit hit;
    hit.t = 1.0;
    hit.u = a.x;
    hit.v = a.y;
    hit.slot = words.a.w;
    vec3 front = scene.primitives[hit.slot].at.normal;
    Surface at = surface_of(scene, words.b.x != 0u ? -front : front, hit);
    return floats(vec4(shadow_terminator_of(scene, hit, at), 0.0), vec4(0.0));
}
