// The reflection of a glossy surface as density estimation weights photons by it: twin of photon-core's
// reflection_lobe.rs. Does not need a scene: the table of albedos is passed by its address.
#ifndef REFLECTION_LOBE_GLSL
#define REFLECTION_LOBE_GLSL

#include "shading/anisotropy.glsl"
#include "shading/constants.glsl"
#include "shading/ggx.glsl"
#include "shading/layers.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/sampling.glsl"
#include "shading/shading_normal.glsl"
#include "shading/sheen_lobe.glsl"

// Entries of albedo_table.glsl.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Albedos { vec2 at; };

struct ReflectionLobe {
    float alpha;
    float roughness;
    vec3 f0;
    float f90;
    vec3 multiple;
    // The shading normal and two vectors perpendicular to it.
    vec3 tangent;
    vec3 bitangent;
    vec3 normal;
    // Towards the viewer, in this frame.
    vec3 wo;
};

const float LOBE_STEPS = 255.0;
const float LOBE_COAT_STEPS = 2040.0;
const float LOBE_WEIGHT_STEPS = 127.0;
const float LOBE_ROUGHNESS_STEPS = 16383.0;
// The largest F0 that lobe_pack leaves as its steps make it.
const float LOBE_MIN_F0 = 1.0e-4;

float lobe_part(uint word, uint shift) {
    precise float part = float(word >> shift & 255u) / LOBE_STEPS;
    return part;
}

uint lobe_steps(float value, float most) {
    precise float scaled = min(value, 1.0) * most + 0.5;
    return uint(scaled);
}

vec3 lobe_color(uint word) {
    vec3 root = vec3(lobe_part(word, 0u), lobe_part(word, 8u), lobe_part(word, 16u));
    precise vec3 color = root * root;
    return color;
}

vec3 lobe_f0(vec3 color, float metallic, vec3 coat_f0) {
    precise vec3 f0 = color * metallic + coat_f0 * (1.0 - metallic);
    return f0;
}

vec3 lobe_unpack_f0(uvec2 words) {
    precise float root = float(words.x >> 24 | words.y >> 29 << 8) / LOBE_COAT_STEPS;
    precise float coat_f0 = root * root;
    float metallic = lobe_part(words.y, 14u);
    vec3 color = lobe_color(words.x);
    precise vec3 colored = color * coat_f0;
    return lobe_f0(color, metallic, metallic == 0.0 ? colored : vec3(coat_f0));
}

// The words of a query for the reflection of a glossy material, and the factor on its throughput.
uvec2 lobe_pack(Material material, Layers layers, out vec3 factor) {
    vec3 colored_f0 = layers_coat_f0(layers, material);
    float coat_f0 = max(max(colored_f0.x, colored_f0.y), colored_f0.z);
    bool is_metallic = lobe_steps(material.metallic, LOBE_STEPS) > 0u;
    vec3 root = sqrt(is_metallic ? material.albedo : coat_f0 > 0.0 ? colored_f0 / coat_f0 : vec3(1.0));
    uint coat = lobe_steps(sqrt(coat_f0), LOBE_COAT_STEPS);
    uvec2 words = uvec2(
        lobe_steps(root.x, LOBE_STEPS) | lobe_steps(root.y, LOBE_STEPS) << 8 | lobe_steps(root.z, LOBE_STEPS) << 16
            | coat << 24,
        lobe_steps(material.roughness, LOBE_ROUGHNESS_STEPS) | lobe_steps(material.metallic, LOBE_STEPS) << 14
            | lobe_steps(material.specular, LOBE_WEIGHT_STEPS) << 22 | coat >> 8 << 29);
    vec3 is = lobe_unpack_f0(words), wanted = lobe_f0(material.albedo, material.metallic, colored_f0);
    for (int c = 0; c < 3; ++c) factor[c] = is[c] > LOBE_MIN_F0 ? wanted[c] / is[c] : 1.0;
    return words;
}

// Albedos A and B between four entries of the table.
vec2 lobe_albedo(Albedos albedos, float cosine, float roughness) {
    precise float column = sqrt(cosine) * float(ALBEDO_TABLE_SIZE - 1u);
    precise float row = roughness * float(ALBEDO_TABLE_SIZE - 1u);
    uint first_column = min(uint(column), ALBEDO_TABLE_SIZE - 2u), first_row = min(uint(row), ALBEDO_TABLE_SIZE - 2u);
    uint first = first_row * ALBEDO_TABLE_SIZE + first_column;
    uint below = first + ALBEDO_TABLE_SIZE;
    float across = column - float(first_column);
    vec2 upper = mix(albedos[first].at, albedos[first + 1u].at, across);
    vec2 lower = mix(albedos[below].at, albedos[below + 1u].at, across);
    return mix(upper, lower, row - float(first_row));
}

// Their means over the hemisphere.
vec2 lobe_mean_albedo(Albedos albedos, float roughness) {
    precise float row = roughness * float(ALBEDO_TABLE_SIZE - 1u);
    uint first_row = min(uint(row), ALBEDO_TABLE_SIZE - 2u);
    uint first = ALBEDO_TABLE_SIZE * ALBEDO_TABLE_SIZE + first_row;
    return mix(albedos[first].at, albedos[first + 1u].at, row - float(first_row));
}

vec3 lobe_local(vec3 w, vec3 tangent, vec3 bitangent, vec3 normal) {
    return vec3(dot3(w, tangent), dot3(w, bitangent), dot3(w, normal));
}

float lobe_roughness(uvec2 words) { return float(words.y & 0x3FFFu) / LOBE_ROUGHNESS_STEPS; }

// With a frame and the roughness of the albedos.
ReflectionLobe lobe_in(
    Albedos albedos, uvec2 words, float roughness, vec3 wo, vec3 tangent, vec3 bitangent, vec3 normal
) {
    ReflectionLobe lobe;
    vec3 color = lobe_color(words.x);
    float metallic = lobe_part(words.y, 14u), weight = float(words.y >> 22 & 127u) / LOBE_WEIGHT_STEPS;
    lobe.roughness = roughness;
    lobe.alpha = max(lobe.roughness * lobe.roughness, GGX_MIN_ALPHA);
    lobe.f0 = lobe_unpack_f0(words);
    lobe.f90 = metallic + weight * (1.0 - metallic);
    lobe.tangent = tangent;
    lobe.bitangent = bitangent;
    lobe.normal = normal;
    lobe.wo = lobe_local(wo, lobe.tangent, lobe.bitangent, normal);
    vec2 directional = lobe_albedo(albedos, clamp(lobe.wo.z, 0.0, 1.0), lobe.roughness);
    vec2 mean = lobe_mean_albedo(albedos, lobe.roughness);
    float lost = 1.0 - (directional.x + directional.y);
    float mean_total = mean.x + mean.y;
    float mean_lost = 1.0 - mean_total;
    vec3 average = color + (vec3(1.0) - color) * (1.0 / 21.0);
    vec3 repeated = average * average * mean_total / (vec3(1.0) - average * mean_lost);
    lobe.multiple = mean_lost > GLOSSY_MIN_SHARE ? repeated * (metallic * max(lost, 0.0) / mean_lost) : vec3(0.0);
    return lobe;
}

ReflectionLobe lobe_new(Albedos albedos, uvec2 words, vec3 wo, vec3 normal) {
    vec3 tangent, bitangent;
    sampling_basis(normal, tangent, bitangent);
    return lobe_in(albedos, words, lobe_roughness(words), wo, tangent, bitangent, normal);
}

// With the anisotropy of `word`: the widths, 0 without any.
ReflectionLobe lobe_anisotropic(Albedos albedos, uvec2 words, uint word, vec3 wo, vec3 normal, out vec2 widths) {
    vec3 along, tangent, bitangent;
    float strength = anisotropy_unpack(word, normal, along), roughness = lobe_roughness(words);
    widths = vec2(0.0);
    if (!(strength > 0.0)) return lobe_new(albedos, words, wo, normal);
    widths = anisotropy_widths(roughness, strength);
    anisotropy_frame(along, normal, tangent, bitangent);
    return lobe_in(
        albedos, words, anisotropy_equivalent_roughness(widths), wo, tangent, bitangent, normal);
}

// The words of a query for a sheen of this roughness; its colour is in the throughput.
uvec2 lobe_pack_sheen(float roughness) {
    return uvec2(255u << 24, lobe_steps(max(roughness, SHEEN_MIN_ROUGHNESS), LOBE_ROUGHNESS_STEPS) | 7u << 29);
}

// Whether these words are from lobe_pack_sheen.
bool lobe_is_sheen(uvec2 words) { return words.x >> 24 == 255u && words.y >> 29 == 7u; }

// The table of its albedos, behind that of glossy surfaces.
SheenAlbedos lobe_sheen_table(Albedos albedos) { return SheenAlbedos(albedos + int(ROUGH_GLASS_STRIDE)); }

// Its lobe, for a direction towards the viewer in the frame of the shading normal.
Charlie lobe_sheen(Albedos albedos, uvec2 words, vec3 wo) {
    return charlie_new(lobe_sheen_table(albedos), lobe_roughness(words), clamp(wo.z, 0.0, 1.0));
}

// As lobe_weight, of a sheen with the frame of `lobe`.
vec3 lobe_weight_sheen(Albedos albedos, ReflectionLobe lobe, Charlie sheen, vec3 wi, vec3 geometric) {
    float ratio = shading_cosine_ratio(wi, geometric, lobe.normal);
    vec3 o = lobe.wo;
    vec3 i = lobe_local(wi, lobe.tangent, lobe.bitangent, lobe.normal);
    precise vec3 both = o + i;
    float size = sqrt(dot3(both, both));
    if (!(ratio > 0.0 && o.z > 0.0 && i.z > 0.0 && size > 0.0)) return vec3(0.0);
    precise vec3 h = both / size;
    return vec3(charlie_evaluate(lobe_sheen_table(albedos), sheen, o, i, h) * ratio);
}

// The factor on the power of a photon that came from the direction `wi`, on a surface with the geometric normal
// `geometric`: BSDF times ratio of cosines.
vec3 lobe_weight_of(Albedos albedos, ReflectionLobe lobe, bool is_anisotropic, vec2 widths, vec3 wi, vec3 geometric) {
    float ratio = shading_cosine_ratio(wi, geometric, lobe.normal);
    vec3 o = lobe.wo;
    vec3 i = lobe_local(wi, lobe.tangent, lobe.bitangent, lobe.normal);
    precise vec3 both = o + i;
    float size = sqrt(dot3(both, both));
    if (!(ratio > 0.0 && o.z > 0.0 && i.z > 0.0 && size > 0.0)) return vec3(0.0);
    precise vec3 h = both / size;
    precise float across = clamp(1.0 - dot3(o, h), 0.0, 1.0);
    float square = across * across;
    float grazing = square * square * across;
    vec3 fresnel = lobe.f0 * (1.0 - grazing) + vec3(lobe.f90 * grazing);
    float single;
    if (is_anisotropic) single = anisotropy_distribution(widths, h) * anisotropy_visibility(widths, o, i);
    else single = ggx_distribution(lobe.alpha, h) * ggx_visibility(lobe.alpha, o.z, i.z);
    vec2 albedo = lobe_albedo(albedos, min(i.z, 1.0), lobe.roughness);
    float lost = max(1.0 - (albedo.x + albedo.y), 0.0);
    return (fresnel * single + lobe.multiple * (lost * 0.318309886)) * ratio;
}

vec3 lobe_weight(Albedos albedos, ReflectionLobe lobe, vec3 wi, vec3 geometric) {
    return lobe_weight_of(albedos, lobe, false, vec2(0.0), wi, geometric);
}

// The same of lobe_anisotropic.
vec3 lobe_weight_anisotropic(Albedos albedos, ReflectionLobe lobe, vec2 widths, vec3 wi, vec3 geometric) {
    return lobe_weight_of(albedos, lobe, widths.x > 0.0, widths, wi, geometric);
}

#endif
