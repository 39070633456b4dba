// Evaluates the functions of kernel.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/kernel.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    return floats(vec4(kernel_weight(words.a.x, a.z), 0.0, 0.0, 0.0), vec4(0.0));
}
