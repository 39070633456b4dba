// Evaluates the functions of area.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/area.glsl"

// Kernel, nothing, and two numbers; spoke and ring.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    uint kernel = words.a.x, spoke = words.b.x;
    switch (FUNCTION) {
        case 0u: return floats(vec4(area_spoke_turns(spoke, a.z), 0.0, 0.0, 0.0), vec4(0.0));
        case 1u: return floats(vec4(area_probe(kernel, spoke, words.b.y, a.z), 0.0, 0.0, 0.0), vec4(0.0));
        case 2u: return floats(vec4(area_outer_distance(spoke, a.z), 0.0, 0.0, 0.0), vec4(0.0));
        case 3u: return floats(vec4(area_second_weights(kernel, a.w), 0.0, 0.0), vec4(0.0));
        default: return floats(vec4(area_share(a.z, a.w), 0.0, 0.0, 0.0), vec4(0.0));
    }
}
