// Rough glass: twin of photon-core's rough_glass.rs. Kernels call it if ROUGH_GLASS of shade.glsl is true; scenes
// without rough glass compile none of this.
#ifndef ROUGH_GLASS_GLSL
#define ROUGH_GLASS_GLSL

#include "shading/bsdf.glsl"
#include "shading/constants.glsl"
#include "shading/fresnel.glsl"
#include "shading/ggx.glsl"
#include "shading/glossy.glsl"
#include "shading/rough_glass_table.glsl"
#include "shading/sampling.glsl"

struct RoughGlass {
    float alpha;
    float roughness;
    float eta;
    bool is_thin;
    vec3 tint;
    Losses losses;
    float lost;
    vec2 spread;
    float staying;
    float light_side;
};

// A sampled direction: whether it is on the side of the path, BSDF times cosine and density, and the uniform number
// that is left.
struct RoughSample {
    vec3 direction;
    bool stays;
    Reflected found;
    float rest;
};

float rough_reflectance(float cosine, float eta, bool is_thin) {
    float single = fresnel(cosine, eta).reflectance;
    return is_thin ? sheet_reflectance(single) : single;
}

// Whether the boundary is neither smooth, nor between equal media, nor none at all.
bool rough_glass_is_rough(Material material, Interface sides) {
    precise float alpha = material.roughness * material.roughness;
    precise float contrast = abs(sides.eta - 1.0);
    return kind_transmits(material.kind) && alpha >= GGX_MIN_ALPHA && sides.is_active
        && !(contrast < ROUGH_GLASS_MIN_CONTRAST);
}

// The boundary of a material, evaluated at the point, which is rough.
RoughGlass rough_glass_new(SceneRef scene, Material material, float cosine, Interface sides) {
    RoughGlass glass;
    float roughness = material.roughness, eta = sides.eta;
    bool is_thin = material.kind == MATERIAL_THIN;
    precise float alpha = roughness * roughness;
    cosine = min(cosine, 1.0);
    precise float squared = is_thin ? 1.0 : eta * eta;
    glass.losses = is_thin ? losses_of_sheet() : losses_of(scene, eta);
    glass.alpha = alpha;
    glass.roughness = roughness;
    glass.eta = eta;
    glass.is_thin = is_thin;
    glass.tint = material.albedo;
    float lost = losses_lost(scene, glass.losses, 0u, cosine, roughness);
    float mean = losses_mean(scene, glass.losses, 0u, roughness);
    float mean_beyond = losses_mean(scene, glass.losses, 1u, roughness);
    precise float sum = mean + squared * mean_beyond;
    bool has_loss = sum > GLOSSY_MIN_SHARE;
    precise vec2 spread = vec2(1.0, squared) / sum;
    glass.spread = has_loss ? spread : vec2(0.0);
    glass.lost = has_loss ? lost : 0.0;
    precise float staying = glass.spread.x * mean;
    glass.staying = staying;
    glass.light_side = clamp(rough_reflectance(cosine, eta, is_thin), 0.125, 0.875);
    return glass;
}

// BSDF times cosine and density, with the microfacet normal `h` between `o` and `i`, all in the frame of the normal.
Reflected rough_glass_at(SceneRef scene, RoughGlass glass, vec3 o, vec3 i, vec3 h) {
    float across = dot3(o, h), beyond = dot3(i, h), height = abs(i.z);
    if (!(o.z > 0.0 && height > 0.0)) return Reflected(vec3(0.0), 0.0);
    bool stays = i.z > 0.0;
    float reflectance = rough_reflectance(across, glass.eta, glass.is_thin);
    precise float share = stays ? reflectance : 1.0 - reflectance;
    float per_normal = 0.25;
    if (!stays && !glass.is_thin) {
        precise float both = across / glass.eta + beyond;
        precise float jacobian = across * -beyond / (both * both);
        per_normal = across > 0.0 && beyond < 0.0 ? jacobian : 0.0;
    }
    precise float density = ggx_distribution(glass.alpha, h) * share * per_normal;
    if (!(across > 0.0)) density = 0.0;
    precise float cosine = height * 0.318309886;
    precise float spread = glass.lost * (stays ? glass.spread.x : glass.spread.y) * cosine;
    precise float again =
        spread * losses_lost(scene, glass.losses, stays ? 0u : 1u, min(height, 1.0), glass.roughness);
    precise float value = density * 4.0 * height * ggx_visibility(glass.alpha, o.z, height) + again;
    precise float share_of_side = stays ? glass.staying : 1.0 - glass.staying;
    precise float pdf = density * (1.0 - glass.lost) * (2.0 / (o.z + ggx_spread(glass.alpha, o.z)))
        + glass.lost * share_of_side * cosine;
    precise vec3 tinted = glass.tint * value;
    return Reflected(stays ? vec3(value) : tinted, pdf);
}

// What reaches `wo` of light from `wi`.
Reflected rough_glass_evaluate(SceneRef scene, RoughGlass glass, vec3 wo, vec3 wi, vec3 normal) {
    vec3 tangent, bitangent;
    sampling_basis(normal, tangent, bitangent);
    vec3 o = glossy_local(wo, tangent, bitangent, normal);
    vec3 i = glossy_local(wi, tangent, bitangent, normal);
    precise vec3 across = o + i;
    if (i.z < 0.0) {
        precise vec3 refracted = o + i * glass.eta;
        precise vec3 mirrored = vec3(o.x + i.x, o.y + i.y, o.z - i.z);
        across = glass.is_thin ? mirrored : refracted;
    }
    float size = sqrt(dot3(across, across));
    precise float scale = (across.z < 0.0 ? -1.0 : 1.0) / size;
    precise vec3 h = across * scale;
    return rough_glass_at(scene, glass, o, i, size > 0.0 ? h : vec3(0.0, 0.0, 1.0));
}

// Samples a direction.
RoughSample rough_glass_sample(SceneRef scene, RoughGlass glass, vec3 wo, vec3 normal, float choice, float u, float v) {
    RoughSample drawn;
    float rest = glossy_rest(choice, glass.lost);
    if (choice < glass.lost) {
        drawn.stays = rest < glass.staying;
        drawn.direction = cosine_hemisphere(drawn.stays ? normal : -normal, u, v);
        drawn.found = rough_glass_evaluate(scene, glass, wo, drawn.direction, normal);
        drawn.rest = glossy_rest(rest, glass.staying);
        return drawn;
    }
    vec3 tangent, bitangent;
    sampling_basis(normal, tangent, bitangent);
    vec3 o = glossy_local(wo, tangent, bitangent, normal);
    vec3 h = ggx_visible_normal(glass.alpha, o, u, v);
    float across = dot3(o, h);
    Fresnel split = fresnel(across, glass.eta);
    float share = glass.is_thin ? sheet_reflectance(split.reflectance) : split.reflectance;
    drawn.stays = rest < share;
    precise vec3 i = h * (2.0 * across) - o;
    if (!drawn.stays) {
        precise vec3 refracted = h * (across / glass.eta - split.cos_transmitted) - o / glass.eta;
        i = glass.is_thin ? vec3(i.x, i.y, -i.z) : refracted;
    }
    precise vec3 direction = tangent * i.x + bitangent * i.y + normal * i.z;
    drawn.direction = normalize_or(direction, vec3(0.0));
    drawn.found = Reflected(vec3(0.0), 0.0);
    if (drawn.stays ? i.z > 0.0 : i.z < 0.0) drawn.found = rough_glass_at(scene, glass, o, i, h);
    drawn.rest = glossy_rest(rest, share);
    return drawn;
}

#endif
