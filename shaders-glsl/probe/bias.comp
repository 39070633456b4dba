// Evaluates the function of bias.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/bias.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    Biases found = biases(a.xyz, b.xyz, c.xyz);
    return floats(vec4(found.wide, 0.0), vec4(found.narrow, 0.0));
}
