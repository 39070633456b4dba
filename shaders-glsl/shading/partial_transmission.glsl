// Surfaces that are glass for a share of all paths, and opaque for the rest. Twin of photon-core's
// partial_transmission.rs; scenes without them compile none of this. Included by scene.glsl; the including kernel declares
// FEATURES.
#ifndef PARTIAL_TRANSMISSION_GLSL
#define PARTIAL_TRANSMISSION_GLSL

#include "shading/alpha.glsl"

const bool PARTIAL_TRANSMISSION = (FEATURES & FEATURE_PARTIAL_TRANSMISSION) != 0u;
// Whether a random word of a ray decides what it meets.
const bool RANDOM_SURFACES = ALPHA || PARTIAL_TRANSMISSION;

// The share of paths that meet the glass.
float partial_share(float factor, float texel, float metallic) {
    precise float transmitted = factor * texel;
    precise float share = transmitted * (1.0 - metallic);
    return alpha_coverage(max(share, 0.0), 0.0);
}

// Whether a ray with the random word `word` meets the glass.
bool partial_is_glass(float share, uint word) {
    return unit_f32(word) < share;
}

// The share of metal in the opaque material, where `metallic` is that of the whole surface.
float partial_opaque_metallic(float metallic, float share) {
    if (!(share > 0.0 && share < 1.0)) return metallic;
    precise float rest = 1.0 - share;
    precise float metal = metallic / rest;
    return min(metal, 1.0);
}

bool partial_has_glass(Material material) {
    return (material.flags & MATERIAL_PARTIAL_TRANSMISSION) != 0u;
}

// The share of paths that meet the glass of `material`, before textures are evaluated, at barycentric coordinates (u, v)
// of the triangle in `slot`.
float partial_share_at(SceneRef scene, Material material, uint slot, float u, float v) {
    if (!partial_has_glass(material)) return 0.0;
    vec3 weights = texel_weights(u, v);
    PartialTransmission entry = scene.shading.partial_transmissions[material.textures - 1u].at;
    float texel = 1.0;
    if (entry.factor_texture != NO_TEXTURE) texel = texel_at(scene, entry.factor_texture, slot, weights).x;
    float metallic = material.metallic;
    if (material.kind == MATERIAL_GLOSSY) {
        uint used = scene.shading.material_textures[material.textures - 1u].at.metallic_roughness;
        if (used != NO_TEXTURE) metallic = alpha_multiply(metallic, texel_at(scene, used, slot, weights).z);
    }
    return partial_share(entry.factor, texel, metallic);
}

// The material that a ray with the random word `word` meets: `index`, or that of its glass. Kernels that define
// ALPHA_EXTENT meet the glass only where rays never meet the other.
uint partial_material(SceneRef scene, uint index, uint slot, float u, float v, uint word) {
    Material material = scene.materials[index].at;
    if (!partial_has_glass(material)) return index;
#ifdef ALPHA_EXTENT
    word = 0xFFFFFFFFu;
#endif
    bool is_glass = partial_is_glass(partial_share_at(scene, material, slot, u, v), word);
    return is_glass ? scene.shading.partial_transmissions[material.textures - 1u].at.glass : index;
}

#endif
