// Evaluates the functions of math.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/math.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: return floats(vec4(copysign(a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
        case 1u:
            return Output(
                uvec4(uint(is_finite(a.x)), uint(is_nan(a.x)), uint(is_positive_finite(a.x)), 0u), uvec4(0u));
        case 2u: return floats(vec4(cross3(a.xyz, b.xyz), dot3(a.xyz, b.xyz)), vec4(0.0));
        case 3u: return floats(vec4(normalize_or(a.xyz, b.xyz), 0.0), vec4(0.0));
        case 4u: return floats(vec4(sin_cos_turns(a.x), 0.0, 0.0), vec4(0.0));
        case 5u: return floats(vec4(exp_neg(a.x), 0.0, 0.0, 0.0), vec4(0.0));
        case 6u: return floats(vec4(math_ln(a.x), 0.0, 0.0, 0.0), vec4(0.0));
        case 7u: return floats(vec4(turns_of(a.x, a.y), 0.0, 0.0, 0.0), vec4(0.0));
        case 9u: return floats(vec4(one_minus_exp(a.x), 0.0, 0.0, 0.0), vec4(0.0));
        case 10u: return floats(vec4(minus_ln_one_minus(a.x), 0.0, 0.0, 0.0), vec4(0.0));
        default: return floats(vec4(cube_root(a.x), 0.0, 0.0, 0.0), vec4(0.0));
    }
}
