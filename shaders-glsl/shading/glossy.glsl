// Glossy surfaces: twin of photon-core's glossy.rs. Kernels call it if GLOSSY of shade.glsl is true;
// scenes without glossy surfaces compile none of this.
#ifndef GLOSSY_GLSL
#define GLOSSY_GLSL

#include "shading/albedo_table.glsl"
#include "shading/anisotropy.glsl"
#include "shading/clearcoat.glsl"
#include "shading/constants.glsl"
#include "shading/ggx.glsl"
#include "shading/layers.glsl"
#include "shading/layout.glsl"
#include "shading/sampling.glsl"
#include "shading/shade.glsl"
#include "shading/shading_normal.glsl"
#include "shading/sheen.glsl"

struct Glossy {
    float alpha;
    float roughness;
    vec3 f0;
    float f90;
    vec3 multiple;
    float multiple_probability;
    vec3 diffuse;
    // Of light from the other side, and its probability among both.
    vec3 transmitted;
    float transmission_probability;
    float specular_probability;
    uint coat;
    // Colour of the sheen, what it lets through, its lobe, and the probability of sampling it.
    vec3 sheen_color;
    float sheen_through;
    Charlie sheen;
    float sheen_probability;
    // Weight and roughness of the clearcoat, what it lets through, and the probability of sampling its reflection.
    float clearcoat;
    float clearcoat_roughness;
    float through;
    float clearcoat_probability;
    // The clearcoat's shading normal, 0 for that of the surface below; whether the path carries light.
    vec3 coat_normal;
    bool carries_light;
    // Whether the reflection is anisotropic; its widths and tangent.
    bool is_anisotropic;
    vec2 widths;
    vec3 tangent;
};

// The reflection in one direction: BSDF times cosine, and density.
struct Reflected {
    vec3 value;
    float pdf;
};

float glossy_greatest(vec3 v) { return max(max(v.x, v.y), v.z); }

float glossy_reflected(vec2 albedo, float f0, float f90) {
    precise float reflected = f0 * albedo.x + f90 * albedo.y;
    return reflected;
}

uint glossy_coat(float roughness, float f0, float f90) {
    precise vec3 scaled =
        vec3(roughness, f0, f90) * vec3(GLOSSY_COAT_ROUGHNESS, GLOSSY_COAT_F0, GLOSSY_COAT_F90) + vec3(0.5);
    return uint(scaled.x) | uint(scaled.y) << 10 | uint(scaled.z) << 22;
}

// The factor on light that arrives at the base under a coat, compared with a base without one.
float glossy_entering(SceneRef scene, uint coat, float cosine) {
    if (coat == 0u) return 1.0;
    if (SHEEN && sheen_is_packed(coat)) return sheen_entering(scene, coat, cosine);
    if (CLEARCOAT && clearcoat_is_packed(coat)) return clearcoat_entering(scene, coat, cosine);
    precise float roughness = float(coat & 1023u) / GLOSSY_COAT_ROUGHNESS;
    precise float f0 = float(coat >> 10 & 4095u) / GLOSSY_COAT_F0;
    precise float f90 = float(coat >> 22) / GLOSSY_COAT_F90;
    precise float mean = 1.0 - glossy_reflected(albedo_mean(scene, roughness), f0, f90);
    precise float through =
        1.0 - glossy_reflected(albedo_directional(scene, clamp(cosine, 0.0, 1.0), roughness), f0, f90);
    precise float share = through / mean;
    return mean > GLOSSY_MIN_SHARE ? share : 0.0;
}

Glossy glossy_with_coat_normal(
    SceneRef scene, Material material, Layers layers, float cosine, vec3 coat_normal, float coat_cosine
) {
    float roughness = material.roughness, metallic = material.metallic, weight = material.specular;
    bool is_anisotropic = ANISOTROPY && layers.anisotropy > 0.0;
    vec2 widths = vec2(0.0);
    if (is_anisotropic) {
        widths = anisotropy_widths(roughness, layers.anisotropy);
        roughness = anisotropy_equivalent_roughness(widths);
    }
    vec3 color = material.albedo;
    vec2 directional = albedo_directional(scene, min(cosine, 1.0), roughness);
    vec2 mean = albedo_mean(scene, roughness);
    vec3 colored_f0 = layers_coat_f0(layers, material);
    float coat_f0 = glossy_greatest(colored_f0);
    precise float dielectric = 1.0 - metallic;
    precise vec3 f0 = color * metallic + colored_f0 * dielectric;
    precise float f90 = metallic + weight * dielectric;
    precise float lost = 1.0 - (directional.x + directional.y);
    precise float mean_total = mean.x + mean.y;
    precise float mean_lost = 1.0 - mean_total;
    precise vec3 average = color + (vec3(1.0) - color) * (1.0 / 21.0);
    precise vec3 repeated = average * average * mean_total / (vec3(1.0) - average * mean_lost);
    precise vec3 multiple = repeated * (metallic * max(lost, 0.0) / mean_lost);
    if (!(mean_lost > GLOSSY_MIN_SHARE)) multiple = vec3(0.0);
    precise vec3 multiple_albedo = multiple * mean_lost;
    precise vec3 specular = f0 * directional.x + vec3(f90 * directional.y) + multiple_albedo;
    precise float through = 1.0 - glossy_reflected(directional, coat_f0, weight);
    precise vec3 diffuse = color * (dielectric * max(through, 0.0));
    float most_specular = glossy_greatest(specular), most_diffuse = glossy_greatest(diffuse);
    vec3 transmitted = vec3(0.0);
    float transmission_share = 0.0;
    if (DIFFUSE_TRANSMISSION && layers.diffuse_transmission > 0.0) {
        precise vec3 beyond =
            layers.transmission_color * (layers.diffuse_transmission * (dielectric * max(through, 0.0)));
        precise vec3 left = diffuse * (1.0 - layers.diffuse_transmission);
        float most_transmitted = glossy_greatest(beyond);
        precise float both = glossy_greatest(left) + most_transmitted;
        precise float share = most_transmitted / both;
        transmitted = beyond;
        diffuse = left;
        most_diffuse = both;
        transmission_share = left == vec3(0.0) ? (most_transmitted > 0.0 ? 1.0 : 0.0) : share;
    }
    precise float multiple_share = glossy_greatest(multiple_albedo) / most_specular;
    if (!(most_specular > 0.0)) multiple_share = 0.0;
    float sheen_strength = 0.0, through_sheen = 1.0, sheen_share = 0.0;
    Charlie sheen;
    if (SHEEN) {
        sheen_strength = glossy_greatest(layers.sheen_color);
        if (sheen_strength > 0.0) {
            sheen = charlie_new(sheen_table(scene), layers.sheen_roughness, min(cosine, 1.0));
            through_sheen = sheen_rest(sheen_strength, sheen.albedo);
            diffuse = diffuse * through_sheen;
            transmitted = transmitted * through_sheen;
            precise float dimmed = most_diffuse * through_sheen;
            precise float reflected = 1.0 - through_sheen;
            precise float all_specular = reflected + through_sheen * most_specular;
            precise float share = reflected / all_specular;
            most_diffuse = dimmed;
            most_specular = all_specular;
            sheen_share = all_specular > 0.0 ? share : 0.0;
        }
    }
    float through_above = 1.0, clearcoat_share = 0.0;
    bool has_clearcoat = CLEARCOAT && layers.clearcoat > 0.0;
    if (has_clearcoat) {
        through_above = clearcoat_through(scene, layers.clearcoat, layers.clearcoat_roughness, min(cosine, 1.0));
        diffuse = diffuse * through_above;
        transmitted = transmitted * through_above;
        precise float dimmed = most_diffuse * through_above;
        if (CLEARCOAT_NORMALS && coat_normal != vec3(0.0)) {
            through_above =
                clearcoat_through(scene, layers.clearcoat, layers.clearcoat_roughness, min(coat_cosine, 1.0));
        }
        precise float reflected = 1.0 - through_above;
        precise float all_specular = reflected + through_above * most_specular;
        precise float share = reflected / all_specular;
        most_diffuse = dimmed;
        most_specular = all_specular;
        clearcoat_share = all_specular > 0.0 ? share : 0.0;
    }
    precise float total = most_specular + most_diffuse;
    precise float specular_share = most_specular / total;
    // Devices may round x/x below 1, and a metal must not count as a mixture.
    if (!(most_diffuse > 0.0)) specular_share = most_specular > 0.0 ? 1.0 : 0.0;
    precise float alpha = roughness * roughness;
    Glossy glossy;
    glossy.alpha = max(alpha, GGX_MIN_ALPHA);
    glossy.roughness = roughness;
    glossy.f0 = f0;
    glossy.f90 = f90;
    glossy.multiple = multiple;
    glossy.multiple_probability = multiple_share;
    glossy.diffuse = diffuse;
    glossy.transmitted = transmitted;
    glossy.transmission_probability = transmission_share;
    glossy.specular_probability = specular_share;
    glossy.coat = has_clearcoat ? clearcoat_pack(roughness, coat_f0, weight, layers)
                                : glossy_coat(roughness, coat_f0, weight);
    if (SHEEN && sheen_strength > 0.0) {
        glossy.coat = sheen_pack(roughness, coat_f0, weight, sheen_strength, layers);
        glossy.sheen = sheen;
    }
    glossy.sheen_color = SHEEN ? layers.sheen_color : vec3(0.0);
    glossy.sheen_through = through_sheen;
    glossy.sheen_probability = sheen_share;
    glossy.clearcoat = CLEARCOAT ? layers.clearcoat : 0.0;
    glossy.clearcoat_roughness = layers.clearcoat_roughness;
    glossy.through = through_above;
    glossy.clearcoat_probability = clearcoat_share;
    glossy.is_anisotropic = is_anisotropic;
    glossy.widths = widths;
    glossy.tangent = layers.tangent;
    glossy.coat_normal = coat_normal;
    glossy.carries_light = false;
    return glossy;
}

Glossy glossy_new(SceneRef scene, Material material, Layers layers, float cosine) {
    return glossy_with_coat_normal(scene, material, layers, cosine, vec3(0.0), cosine);
}

// The same for a path that arrives from the direction `wo`, with a clearcoat that may have a normal of its own.
Glossy glossy_at(SceneRef scene, Material material, Layers layers, float cosine, vec3 wo, bool carries_light) {
    vec3 normal = vec3(0.0);
    float coat_cosine = cosine;
    if (CLEARCOAT_NORMALS && layers.coat_normal != vec3(0.0) && layers.clearcoat > 0.0) {
        normal = shading_bend(layers.coat_normal, wo);
        coat_cosine = dot3(wo, normal);
    }
    Glossy glossy = glossy_with_coat_normal(scene, material, layers, cosine, normal, coat_cosine);
    glossy.carries_light = carries_light;
    return glossy;
}

// The normal of the clearcoat, or that of the surface below.
vec3 glossy_coat_normal(Glossy glossy, vec3 normal) {
    return CLEARCOAT_NORMALS && glossy.coat_normal != vec3(0.0) ? glossy.coat_normal : normal;
}

// A direction in the frame of a normal.
vec3 glossy_local(vec3 w, vec3 tangent, vec3 bitangent, vec3 normal) {
    return vec3(dot3(w, tangent), dot3(w, bitangent), dot3(w, normal));
}

// Two vectors perpendicular to the shading normal, along and across the anisotropy.
void glossy_frame(Glossy glossy, vec3 normal, out vec3 tangent, out vec3 bitangent) {
    if (ANISOTROPY && glossy.is_anisotropic) {
        anisotropy_frame(glossy.tangent, normal, tangent, bitangent);
    } else {
        sampling_basis(normal, tangent, bitangent);
    }
}

// The reflection of a clearcoat with a normal of its own, value and density, and the cosine of `wi` to it. `cosines` are those
// to the shading normal.
vec3 glossy_above(Glossy glossy, vec3 wo, vec3 wi, vec2 cosines) {
    vec3 tangent, bitangent;
    sampling_basis(glossy.coat_normal, tangent, bitangent);
    vec3 o = glossy_local(wo, tangent, bitangent, glossy.coat_normal);
    vec3 i = glossy_local(wi, tangent, bitangent, glossy.coat_normal);
    if (!(o.z > 0.0 && i.z > 0.0)) return vec3(0.0, 0.0, i.z);
    precise vec3 both = o + i;
    vec2 above = clearcoat_evaluate(
        glossy.clearcoat, glossy.clearcoat_roughness, o, i, normalize_or(both, vec3(0.0, 0.0, 1.0)));
    precise float counted = min(i.z, SHADING_MAX_RATIO * cosines.y);
    if (glossy.carries_light) {
        precise float light = min(o.z, SHADING_MAX_RATIO * cosines.x) * cosines.y / cosines.x;
        counted = light;
    }
    precise float value = above.x * (counted / i.z);
    return vec3(value, above.y, i.z);
}

Reflected glossy_evaluate(SceneRef scene, Glossy glossy, vec3 wo, vec3 wi, vec3 normal) {
    vec3 tangent, bitangent;
    glossy_frame(glossy, normal, tangent, bitangent);
    vec3 o = glossy_local(wo, tangent, bitangent, normal);
    vec3 i = glossy_local(wi, tangent, bitangent, normal);
    precise vec3 both = o + i;
    float size = sqrt(dot3(both, both));
    if (!(o.z > 0.0 && i.z > 0.0 && size > 0.0)) return Reflected(vec3(0.0), 0.0);
    precise vec3 h = both / size;
    precise float across = clamp(1.0 - dot3(o, h), 0.0, 1.0);
    precise float square = across * across;
    precise float grazing = square * square * across;
    precise vec3 fresnel = glossy.f0 * (1.0 - grazing) + vec3(glossy.f90 * grazing);
    precise float single;
    precise float pdf;
    if (ANISOTROPY && glossy.is_anisotropic) {
        single = anisotropy_distribution(glossy.widths, h) * anisotropy_visibility(glossy.widths, o, i) * i.z;
        pdf = anisotropy_pdf(glossy.widths, o, h);
    } else {
        single = ggx_distribution(glossy.alpha, h) * ggx_visibility(glossy.alpha, o.z, i.z) * i.z;
        pdf = ggx_pdf(glossy.alpha, o, h);
    }
    precise vec3 value = fresnel * single;
    float p = glossy.multiple_probability;
    if (p > 0.0) {
        vec2 albedo = albedo_directional(scene, min(i.z, 1.0), glossy.roughness);
        precise float cosine = i.z * 0.318309886;
        precise float lost = 1.0 - (albedo.x + albedo.y);
        value = value + glossy.multiple * (max(lost, 0.0) * cosine);
        pdf = pdf * (1.0 - p) + cosine * p;
    }
    if (SHEEN && glossy.sheen_color != vec3(0.0)) {
        float strength = glossy_greatest(glossy.sheen_color);
        float through =
            min(glossy.sheen_through, sheen_through(scene, strength, glossy.sheen.roughness, i.z));
        float lobe = charlie_evaluate(sheen_table(scene), glossy.sheen, o, i, h);
        float share = glossy.sheen_probability;
        value = value * through + glossy.sheen_color * (lobe * i.z);
        pdf = pdf * (1.0 - share) + share * 0.159154943;
    }
    if (CLEARCOAT && glossy.clearcoat > 0.0) {
        vec3 above = vec3(clearcoat_evaluate(glossy.clearcoat, glossy.clearcoat_roughness, o, i, h), i.z);
        if (CLEARCOAT_NORMALS && glossy.coat_normal != vec3(0.0)) {
            above = glossy_above(glossy, wo, wi, vec2(o.z, i.z));
        }
        float through = min(
            glossy.through, clearcoat_through(scene, glossy.clearcoat, glossy.clearcoat_roughness, above.z));
        float share = glossy.clearcoat_probability;
        value = value * through + vec3(above.x);
        pdf = pdf * (1.0 - share) + above.y * share;
    }
    return Reflected(value, pdf);
}

// The uniform number that is left of `choice` after it has decided between two lobes, the first with probability `first`.
float glossy_rest(float choice, float first) {
    precise float rest = choice < first ? choice / first : (choice - first) / (1.0 - first);
    return min(rest, 1.0 - 1.1920929e-7);
}

// Samples a direction of the reflection.
Reflected glossy_sample(SceneRef scene, Glossy glossy, vec3 wo, vec3 normal, float u, float v, out vec3 wi) {
    float p = glossy.multiple_probability, share = glossy.clearcoat_probability;
    bool is_below = true;
    if (CLEARCOAT && share > 0.0) {
        is_below = u >= share;
        u = glossy_rest(u, share);
    }
    bool is_sheen = false;
    if (SHEEN && is_below && glossy.sheen_probability > 0.0) {
        is_sheen = u < glossy.sheen_probability;
        u = glossy_rest(u, glossy.sheen_probability);
    }
    if (SHEEN && is_sheen) {
        wi = sampling_about(normal, u, v);
    } else if (is_below && u < p) {
        precise float rest = u / p;
        wi = cosine_hemisphere(normal, rest, v);
    } else {
        vec3 tangent, bitangent;
        vec3 axis = is_below ? normal : glossy_coat_normal(glossy, normal);
        if (CLEARCOAT_NORMALS && !is_below && glossy.coat_normal != vec3(0.0)) {
            sampling_basis(axis, tangent, bitangent);
        } else {
            glossy_frame(glossy, normal, tangent, bitangent);
        }
        precise float rest = (u - p) / (1.0 - p);
        float alpha = is_below ? glossy.alpha : clearcoat_alpha(glossy.clearcoat_roughness);
        vec3 o = glossy_local(wo, tangent, bitangent, axis);
        float first = is_below ? min(rest, 1.0 - 1.1920929e-7) : u;
        vec3 i;
        if (ANISOTROPY && glossy.is_anisotropic && is_below) i = anisotropy_sample(glossy.widths, o, first, v);
        else i = ggx_sample(alpha, o, first, v);
        precise vec3 direction = tangent * i.x + bitangent * i.y + axis * i.z;
        wi = direction;
    }
    return glossy_evaluate(scene, glossy, wo, wi, normal);
}

vec3 glossy_weight(Reflected reflected, float factor) {
    precise float scale = factor / reflected.pdf;
    precise vec3 weight = reflected.value * scale;
    return reflected.pdf > 0.0 && factor > 0.0 ? weight : vec3(0.0);
}

// The cosine that counts over that to the shading normal.
float glossy_limited(vec3 direction, vec3 geometric, vec3 shading) {
    float below = dot3(direction, geometric), above = dot3(direction, shading);
    precise float ratio = SHADING_MAX_RATIO * below / above;
    return below > 0.0 && above > 0.0 ? min(ratio, 1.0) : 0.0;
}

#endif
