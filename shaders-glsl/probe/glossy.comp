// Evaluates the functions of ggx.glsl, anisotropy.glsl, albedo_table.glsl, glossy.glsl and reflection_lobe.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;

#include "probe/probe.glsl"
#include "shading/glossy.glsl"
#include "shading/reflection_lobe.glsl"

// A direction and the roughness, another direction and the share of metal, two uniform numbers; address of the scene,
// whose first material has the rest.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    Material material = scene.materials[0].at;
    material.roughness = a.w;
    material.metallic = b.w;
    Layers layers = layers_none();
    layers.clearcoat = c.y < 0.5 ? 0.0 : 0.8;
    layers.clearcoat_roughness = 0.3;
    layers.specular_color = vec3(1.0, 1.0 - b.w, 1.0 + 30.0 * b.w);
    float alpha = max(a.w * a.w, GGX_MIN_ALPHA);
    vec3 normal = vec3(0.48, 0.6, -0.64);
    vec2 widths = anisotropy_widths(a.w, c.y);
    if (FUNCTION >= 10u && FUNCTION <= 12u) {
        layers.anisotropy = 0.7;
        layers.tangent = vec3(c.x, c.y, 0.3);
    }
    switch (FUNCTION) {
        case 0u: return floats(vec4(ggx_sample(alpha, a.xyz, c.x, c.y), 0.0), vec4(0.0));
        case 1u:
            return floats(
                vec4(ggx_distribution(alpha, b.xyz), ggx_visibility(alpha, a.z, b.z), ggx_pdf(alpha, a.xyz, b.xyz),
                    0.0),
                vec4(0.0));
        case 2u:
            return floats(vec4(albedo_directional(scene, c.x, a.w), albedo_mean(scene, a.w)), vec4(0.0));
        case 7u: return floats(vec4(anisotropy_sample(widths, a.xyz, c.x, c.y), 0.0), vec4(0.0));
        case 8u:
            return floats(
                vec4(anisotropy_distribution(widths, b.xyz), anisotropy_visibility(widths, a.xyz, b.xyz),
                    anisotropy_pdf(widths, a.xyz, b.xyz), anisotropy_equivalent_roughness(widths)),
                vec4(0.0));
        case 9u: {
            vec3 tangent;
            layers.anisotropy = b.w;
            layers.tangent = a.xyz;
            uint word = anisotropy_pack(layers, normal);
            float strength = anisotropy_unpack(word, normal, tangent);
            // Opposite directions are the same.
            vec3 sign = vec3(dot3(tangent, a.xyz) < 0.0 ? -1.0 : 1.0);
            return floats(vec4(tangent * sign, strength), vec4(float(anisotropy_path_word(words.c.x, word) >> 16)));
        }
    }
    if (FUNCTION >= 16u) {
        layers.sheen_color = vec3(0.9, 0.5, 0.2);
        layers.sheen_roughness = c.x;
    }
    if (FUNCTION == 19u) {
        Albedos albedos = Albedos(uvec2(scene.shading.albedos));
        ReflectionLobe lobe = lobe_new(albedos, lobe_pack_sheen(c.x), a.xyz, normal);
        Charlie sheen = lobe_sheen(albedos, lobe_pack_sheen(c.x), lobe.wo);
        vec3 weight = lobe_weight_sheen(albedos, lobe, sheen, b.xyz, vec3(0.6, 0.48, -0.64));
        return floats(vec4(lobe_is_sheen(lobe_pack_sheen(c.x)) ? weight : vec3(-1.0), 0.0), vec4(0.0));
    }
    if (FUNCTION == 6u || FUNCTION == 12u) {
        vec3 factor;
        uvec2 words = lobe_pack(material, layers, factor);
        Albedos albedos = Albedos(uvec2(scene.shading.albedos));
        ReflectionLobe lobe = lobe_new(albedos, words, a.xyz, normal);
        vec3 geometric = vec3(0.6, 0.48, -0.64);
        vec3 weight = lobe_weight(albedos, lobe, b.xyz, geometric);
        if (FUNCTION == 12u) {
            vec2 own;
            lobe = lobe_anisotropic(albedos, words, anisotropy_pack(layers, normal), a.xyz, normal, own);
            weight = lobe_weight_anisotropic(albedos, lobe, own, b.xyz, geometric);
        }
        return floats(vec4(factor, 0.0), vec4(weight, 0.0));
    }
    if (FUNCTION == 13u) {
        layers.diffuse_transmission = c.x;
        layers.transmission_color = vec3(0.9, 0.5, 0.1);
    }
    Glossy glossy = glossy_new(scene, material, layers, dot3(a.xyz, normal));
    if (FUNCTION == 3u) {
        float entering = glossy_entering(scene, glossy.coat, c.x) * 0.0625;
        return floats(vec4(glossy.diffuse, glossy.specular_probability),
            vec4(glossy.multiple_probability, entering, glossy_rest(c.y, glossy.specular_probability), 0.0));
    }
    if (FUNCTION == 13u) {
        return floats(vec4(glossy.diffuse, glossy.specular_probability),
            vec4(glossy.transmitted, glossy.transmission_probability));
    }
    if (FUNCTION == 16u) {
        float entering = glossy_entering(scene, glossy.coat, c.y) * 0.0625;
        return floats(vec4(glossy.diffuse, glossy.specular_probability),
            vec4(glossy.sheen_probability, entering, glossy.sheen_through, 0.0));
    }
    if (FUNCTION == 14u || FUNCTION == 15u) {
        layers.coat_normal = vec3(0.36, 0.8, -0.48);
        glossy = glossy_at(scene, material, layers, dot3(a.xyz, normal), a.xyz, c.x < 0.5);
    }
    if (FUNCTION == 4u || FUNCTION == 10u || FUNCTION == 14u || FUNCTION == 17u) {
        Reflected reflected = glossy_evaluate(scene, glossy, a.xyz, b.xyz, normal);
        return floats(vec4(reflected.value, reflected.pdf), vec4(glossy_limited(b.xyz, vec3(0.6, 0.48, -0.64), normal)));
    }
    vec3 wi;
    Reflected reflected = glossy_sample(scene, glossy, a.xyz, normal, c.x, c.y, wi);
    return floats(vec4(wi, 0.0), vec4(glossy_weight(reflected, 1.0), 0.0));
}
