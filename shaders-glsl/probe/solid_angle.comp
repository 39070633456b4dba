// Evaluates the functions of solid_angle.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/random.glsl"
#include "shading/solid_angle.glsl"

// Rows are corners; their last components are the height, the area, and two 16-bit numbers in one word.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) {
        return Output(uvec4(uint(solid_angle_is_near(a.xyz, b.xyz, c.xyz)), 0u, 0u, 0u), uvec4(0u));
    }
    if (FUNCTION == 1u) return floats(vec4(solid_angle_of(a.xyz, b.xyz, c.xyz, a.w, b.w), 0.0, 0.0, 0.0), vec4(0.0));
    if (FUNCTION == 3u) return floats(vec4(cosine_warp(a.x, a.y, a.z, unit_f32(words.b.x), unit_f32(words.b.y)), 0.0), vec4(0.0));
    uint packed = floatBitsToUint(c.w);
    // Not by ?:, which drivers fold to a vector with one component.
    vec3 normal = vec3(0.0);
    if (FUNCTION == 4u) normal = vec3(0.36, 0.48, 0.8);
    vec2 weights;
    float angle;
    bool wide = solid_angle_sample(
        a.xyz, b.xyz, c.xyz, a.w, b.w, normal, unit_f32(packed & 0xFFFF0000u), unit_f32(packed << 16), weights, angle);
    return floats(vec4(wide ? 1.0 : 0.0, weights, angle), vec4(0.0));
}
