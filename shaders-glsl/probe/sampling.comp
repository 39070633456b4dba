// Evaluates the functions of sampling.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 1) in;

#include "probe/probe.glsl"
#include "shading/sampling.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: {
            vec3 tangent, bitangent;
            sampling_basis(a.xyz, tangent, bitangent);
            return floats(vec4(tangent, 0.0), vec4(bitangent, 0.0));
        }
        case 1u: return floats(vec4(sampling_about(a.xyz, b.x, b.y), 0.0), vec4(0.0));
        case 2u: return floats(vec4(cosine_hemisphere(a.xyz, b.x, b.y), 0.0), vec4(0.0));
        case 3u: return floats(vec4(uniform_sphere(a.x, a.y), 0.0), vec4(0.0));
        case 4u: return floats(vec4(sampling_triangle(a.x, a.y), 0.0, 0.0), vec4(0.0));
        case 5u: return floats(vec4(sampling_disc(a.x, a.y), 0.0, 0.0), vec4(0.0));
        case 6u: return floats(vec4(spot_falloff(a.x, a.y, a.z), 0.0, 0.0, 0.0), vec4(0.0));
        case 7u: return floats(vec4(spot_solid_angle(a.y, a.z), 0.0, 0.0, 0.0), vec4(0.0));
        case 8u: return floats(vec4(spot_versine(a.y, a.z, a.x), 0.0, 0.0, 0.0), vec4(0.0));
        default: return floats(vec4(sun_versine(a.z, a.x), 0.0, 0.0, 0.0), vec4(0.0));
    }
}
