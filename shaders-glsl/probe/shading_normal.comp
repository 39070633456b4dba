// Evaluates the functions of shading_normal.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/shading_normal.glsl"

// A direction, the geometric normal and the shading normal; the other direction is the last number of each.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    vec3 incoming = vec3(a.w, b.w, c.w);
    switch (FUNCTION) {
        case 0u: return floats(vec4(shading_cosine(a.xyz, b.xyz, c.xyz), 0.0, 0.0, 0.0), vec4(0.0));
        case 1u: return floats(vec4(shading_cosine_ratio(a.xyz, b.xyz, c.xyz), 0.0, 0.0, 0.0), vec4(0.0));
        case 2u: return floats(vec4(shading_bend(c.xyz, b.xyz), 0.0), vec4(0.0));
        case 3u:
            return floats(
                vec4(shading_on_side(false, a.xyz, b.xyz), 0.0), vec4(shading_on_side(true, a.xyz, b.xyz), 0.0));
        default:
            return floats(vec4(shading_specular_factor(incoming, a.xyz, b.xyz, c.xyz), 0.0, 0.0, 0.0), vec4(0.0));
    }
}
