// Evaluates the functions of fresnel.glsl, and the reflectance of smooth metals.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;
layout(constant_id = 7) const uint MEDIA = 1;

#include "probe/probe.glsl"
#include "shading/bsdf.glsl"
#include "shading/fresnel.glsl"

Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: {
            Fresnel f = fresnel(a.x, a.y);
            return floats(vec4(f.reflectance, f.cos_transmitted, 0.0, 0.0), vec4(0.0));
        }
        case 1u: return floats(vec4(sheet_reflectance(a.x), 0.0, 0.0, 0.0), vec4(0.0));
        case 2u: return floats(vec4(bsdf_reflect(a.xyz, b.xyz), 0.0), vec4(0.0));
        case 3u: return floats(vec4(bsdf_refract(a.xyz, b.xyz, c.x, c.y), 0.0), vec4(0.0));
        default:
            return floats(vec4(mirror_reflectance(a.xyz, a.w, b.x), schlick_rise(b.x)), vec4(0.0));
    }
}
