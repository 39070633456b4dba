// Alpha coverage: whether a surface is there where a ray meets it. Twin of photon-core's alpha.rs; scenes without alpha
// compile none of this. Included by scene.glsl; the including kernel declares FEATURES.
#ifndef ALPHA_GLSL
#define ALPHA_GLSL

#include "shading/constants.glsl"
#include "shading/random.glsl"
#include "shading/texel.glsl"

const bool ALPHA = (FEATURES & FEATURE_ALPHA) != 0u;

// The finalizer of MurmurHash3.
uint alpha_mix(uint word) {
    word = (word ^ word >> 16) * 0x85EBCA6Bu;
    word = (word ^ word >> 13) * 0xC2B2AE35u;
    return word ^ word >> 16;
}

// Whether triangle `primitive` is there for a ray with the random word `word`.
bool alpha_keep(float coverage, uint primitive, uint word) {
    return coverage > unit_f32(alpha_mix(word ^ primitive * 0x9E3779B9u));
}

// The probability with which a surface of this alpha is there: 0 or 1 with a cutoff above 0.
float alpha_coverage(float alpha, float cutoff) {
    if (cutoff > 0.0) return alpha >= cutoff ? 1.0 : 0.0;
    return min(ceil(alpha * 16777216.0), 16777216.0) * (1.0 / 16777216.0);
}

float alpha_interpolate(float a, float b, float c, vec3 weights) {
    precise float sum = a * weights.x + b * weights.y + c * weights.z;
    return sum;
}

float alpha_multiply(float a, float b) {
    precise float product = a * b;
    return product;
}

// Alpha of a vertex colour.
float alpha_unpack(uvec2 packed) {
    precise float alpha = float(packed.y >> 16) * (1.0 / 65535.0);
    return alpha;
}

// The coverage of a surface of `material` at barycentric coordinates (u, v) of the triangle in `slot`.
float alpha_coverage_at(SceneRef scene, Material material, uint slot, float u, float v) {
    if ((material.flags & MATERIAL_ALPHA) == 0u) return 1.0;
    vec3 weights = texel_weights(u, v);
    float alpha = material.alpha;
    if ((FEATURES & FEATURE_VERTEX_COLORS) != 0u) {
        CornerColors colors = scene.shading.colors + int(slot);
        float vertex = alpha_interpolate(alpha_unpack(colors.a), alpha_unpack(colors.b), alpha_unpack(colors.c), weights);
        alpha = alpha_multiply(alpha, vertex);
    }
    if (material.textures != 0u) {
        uint used = scene.shading.material_textures[material.textures - 1u].at.alpha;
        if (used != NO_TEXTURE) alpha = alpha_multiply(alpha, texel_at(scene, used, slot, weights).w);
    }
    return alpha_coverage(alpha, material.alpha_cutoff);
}

// The coverage of the triangle in `slot`.
float alpha_coverage_of(SceneRef scene, uint slot, float u, float v) {
    Material material = scene.materials[scene.primitives[slot].at.material].at;
    return alpha_coverage_at(scene, material, slot, u, v);
}

// Whether a triangle with alpha is there for a ray with the random word `word`. Kernels that define ALPHA_EXTENT look for
// all surfaces that may be there instead.
bool alpha_is_there(SceneRef scene, uint slot, uint primitive, vec2 weights, uint word) {
    float coverage = alpha_coverage_of(scene, slot, weights.x, weights.y);
#ifdef ALPHA_EXTENT
    return coverage > 0.0;
#else
    return alpha_keep(coverage, primitive, word);
#endif
}

#endif
