// Evaluates the functions of offset.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/math.glsl"
#include "shading/offset.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) return floats(vec4(barycentric(a.xyz, b.xyz, c.xyz, a.w, b.w), 0.0), vec4(0.0));
    if (FUNCTION == 2u) return floats(vec4(within(a.xyz, b.xyz, c.xyz, c.w, a.w, b.w), 0.0), vec4(0.0));
    return floats(vec4(off_surface(a.xyz, b.xyz), 0.0), vec4(0.0));
}
