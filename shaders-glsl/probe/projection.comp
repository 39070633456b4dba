// Evaluates the functions of projection.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/projection.glsl"

// Random words of the light and of the start; address of the projection map.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    ProjectionRef projection = ProjectionRef(words.c.zw);
    ProjectionSample projected = projection_sample(projection, words.a, words.b);
    if (FUNCTION == 0u) {
        return Output(uvec4(projected.light, projected.side, projected.point), uvec4(projected.direction, 0u, 0u));
    }
    return floats(vec4(projected.carried, 0.0), vec4(0.0));
}
