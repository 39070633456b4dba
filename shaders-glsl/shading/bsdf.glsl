// BSDFs, shared by photons, camera paths and gather rays. Twin of photon-core's bsdf.rs.
#ifndef BSDF_GLSL
#define BSDF_GLSL

#include "shading/constants.glsl"
#include "shading/fresnel.glsl"
#include "shading/layout.glsl"
#include "shading/media.glsl"
#include "shading/sampling.glsl"

// The including kernel declares FEATURES, a specialization constant: the bits of Features.
const bool MIRRORS = (FEATURES & FEATURE_MIRROR) != 0u;
const bool GLASS = (FEATURES & (FEATURE_DIELECTRIC | FEATURE_THIN)) != 0u;

// Most total reflections of a path that may meet `max_bounces` surfaces; one more truncates it.
uint most_total_reflections(uint max_bounces) { return max(64u, max_bounces / 16u); }

// Russian roulette for a camera path of this throughput, by a random word: the factor on the throughput, 0 if the path ends.
float russian_roulette(vec3 throughput, uint word) {
    const float all = 4294967296.0;
    precise float chance = max(max(throughput.x, throughput.y), throughput.z) / NEGLIGIBLE_THROUGHPUT;
    if (chance >= 1.0) return 1.0;
    // The number of words with which it goes on, of which the factor is the exact inverse.
    uint words = uint(chance * all);
    return word < words ? all / float(words) : 0.0;
}

// A surface as hit by one path.
struct Bsdf {
    uint kind;
    vec3 albedo;
    float eta;
    float reflectance;
    float cos_transmitted;
    bool is_active;
};

// Whether a material of this kind transmits light.
bool kind_transmits(uint kind) { return GLASS && (kind == MATERIAL_DIELECTRIC || kind == MATERIAL_THIN); }

// The reflectance at normal incidence rises to 1 at grazing angles, for metals.
vec3 mirror_reflectance(vec3 normal_incidence, float metallic, float cosine) {
    precise vec3 reflectance = normal_incidence + (1.0 - normal_incidence) * (metallic * schlick_rise(cosine));
    return reflectance;
}

Bsdf bsdf_new(Material material, float cosine, Interface sides) {
    Bsdf bsdf = Bsdf(MATERIAL_LAMBERT, material.albedo, sides.eta, 0.0, 0.0, sides.is_active);
    if (MIRRORS && material.kind == MATERIAL_MIRROR) {
        bsdf.kind = MATERIAL_MIRROR;
        bsdf.reflectance = 1.0;
        bsdf.albedo = mirror_reflectance(material.albedo, material.metallic, cosine);
    } else if (kind_transmits(material.kind)) {
        Fresnel split = fresnel(cosine, sides.eta);
        bsdf.kind = material.kind;
        bool thin = material.kind == MATERIAL_THIN;
        bsdf.reflectance = thin ? sheet_reflectance(split.reflectance) : split.reflectance;
        bsdf.cos_transmitted = split.cos_transmitted;
    }
    return bsdf;
}

// Whether light is both reflected, with probability `reflectance`, and transmitted.
bool bsdf_splits(Bsdf bsdf) { return kind_transmits(bsdf.kind); }

// Whether a smooth boundary reflects all light: total internal reflection.
bool bsdf_is_total(Bsdf bsdf) { return GLASS && bsdf.kind == MATERIAL_DIELECTRIC && bsdf.reflectance >= 1.0; }

uint bsdf_choose(Bsdf bsdf, float u) {
    if (bsdf_splits(bsdf)) return u < bsdf.reflectance ? LOBE_SPECULAR_REFLECTION : LOBE_SPECULAR_TRANSMISSION;
    return MIRRORS && bsdf.kind == MATERIAL_MIRROR ? LOBE_SPECULAR_REFLECTION : LOBE_DIFFUSE;
}

vec3 bsdf_weight(Bsdf bsdf, uint lobe) {
    if (bsdf_splits(bsdf) && (lobe == LOBE_SPECULAR_REFLECTION || !bsdf.is_active)) return vec3(1.0);
    return bsdf.albedo;
}

// `u` and `v` are used only for LOBE_DIFFUSE.
vec3 bsdf_direction(Bsdf bsdf, uint lobe, vec3 incoming, vec3 normal, float u, float v) {
    if (lobe == LOBE_DIFFUSE) return cosine_hemisphere(normal, u, v);
    if (lobe == LOBE_SPECULAR_REFLECTION) return bsdf_reflect(incoming, normal);
    if (bsdf.kind == MATERIAL_THIN) return incoming;
    return bsdf_refract(incoming, normal, bsdf.eta, bsdf.cos_transmitted);
}

#endif
