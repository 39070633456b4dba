// Evaluates the functions of octahedral.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/octahedral.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) return Output(uvec4(octahedral_pack(a.xyz), 0u, 0u, 0u), uvec4(0u));
    return floats(vec4(octahedral_unpack(words.a.x), 0.0), vec4(0.0));
}
