// Evaluates the functions of photon_format.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/photon_format.glsl"

// Power and direction; format and index of the photon; address of the table.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    Fluxes fluxes = Fluxes(words.c.zw);
    if (FUNCTION == 0u) return Output(flux_at(words.b.x, fluxes, words.b.y), uvec4(0u));
    flux_put(words.b.x, fluxes, words.b.y, words.a);
    return Output(uvec4(0u), uvec4(0u));
}
