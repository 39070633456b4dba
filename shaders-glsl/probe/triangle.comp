// Evaluates the ray-triangle test of intersect.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;
const uint FEATURES = 0u;

#include "probe/probe.glsl"
#include "shading/scene.glsl"

// Origin and `t_max`; direction; index of the triangle, and address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    Ray ray = Ray(a.xyz, b.xyz, a.w);
    Hit best = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0, 0u);
    Sheared s;
    Corners corners = scene.corners;
    if (sheared(ray, s)) test_triangle(scene, corners, words.c.x, s, 0u, best);
    if (best.primitive == NO_PRIMITIVE) return floats(vec4(0.0), vec4(0.0));
    return floats(vec4(best.t, best.u, best.v, 1.0), vec4(0.0));
}
