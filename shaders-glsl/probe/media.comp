// Evaluates the functions of media.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

layout(local_size_x_id = 1) in;
const uint FEATURES = 0u;
layout(constant_id = 3) const uint MEDIA = 1u;

#include "probe/probe.glsl"
#include "shading/stretches.glsl"

// Two stacks, a medium and a distance; a material and whether its front is hit; a random word, a wavelength and the
// address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    uint stack = words.a.x, other = words.a.y, medium = words.a.z;
    Material material;
    material.kind = words.b.x;
    material.medium = words.b.y;
    material.ior = b.z;
    Interface sides = media_interface(scene, material, words.b.w != 0u, stack);
    switch (FUNCTION) {
        case 0u:
            return Output(
                uvec4(
                    media_enter(stack, medium), media_leave(stack, medium), uint(media_contains(stack, medium)),
                    uint(media_is_full(stack))),
                uvec4(0u));
        case 1u: return Output(uvec4(media_current(scene, stack), 0u, 0u, 0u), uvec4(0u));
        case 2u:
            return Output(
                uvec4(sides.before, sides.transmitted, uint(sides.is_active), uint(sides.is_too_deep)), uvec4(0u));
        case 3u: return floats(vec4(sides.eta, 0.0, 0.0, 0.0), vec4(0.0));
        case 4u: return floats(vec4(radiance_scale(scene, stack, other, words.c.y), 0.0, 0.0, 0.0), vec4(0.0));
        case 6u: {
            bool disperses = media_is_dispersive(scene, sides);
            return floats(vec4(media_index(scene, stack, words.c.y), float(disperses), 0.0, 0.0), vec4(0.0));
        }
        case 7u: {
            vec3 power = vec3(a.w, b.z, 0.25);
            uint wavelength = NO_WAVELENGTH;
            media_disperse(scene, sides, wavelength, power, words.c.x);
            return floats(vec4(float(wavelength), power), vec4(sides.eta, 0.0, 0.0, 0.0));
        }
        default: return floats(vec4(transmittance(scene, Ray(vec3(0.0), vec3(0.0, 0.0, 1.0), NO_LIMIT), a.w, stack), 0.0), vec4(0.0));
    }
}
