// Vertex attributes and textures at a hit: twin of photon-core's shade.rs. The including kernel declares FEATURES;
// scenes without textures and vertex attributes compile none of this.
#ifndef SHADE_GLSL
#define SHADE_GLSL

#include "shading/layers.glsl"
#include "shading/octahedral.glsl"
#include "shading/scene.glsl"
#include "shading/shading_normal.glsl"
#include "shading/texture.glsl"

const bool TEXTURES = (FEATURES & FEATURE_TEXTURES) != 0u;
const bool SHADING_NORMALS = (FEATURES & FEATURE_SHADING_NORMALS) != 0u;
const bool NORMAL_MAPS = (FEATURES & FEATURE_NORMAL_MAPS) != 0u;
const bool VERTEX_COLORS = (FEATURES & FEATURE_VERTEX_COLORS) != 0u;
const bool GLOSSY = (FEATURES & FEATURE_GLOSSY) != 0u;
const bool ROUGH_GLASS = (FEATURES & FEATURE_ROUGH_GLASS) != 0u;
// Surfaces at which camera paths sample lights, and go on.
const bool FOLLOWED = GLOSSY || ROUGH_GLASS;
// Whether specular surfaces see a normal that is bent towards the ray.
const bool BENT_NORMALS = SHADING_NORMALS || FOLLOWED;
const bool SPECULAR_COLORS = (FEATURES & FEATURE_SPECULAR_COLORS) != 0u;
const bool CLEARCOAT = (FEATURES & FEATURE_CLEARCOAT) != 0u;
const bool ANISOTROPY = (FEATURES & FEATURE_ANISOTROPY) != 0u;
const bool CLEARCOAT_NORMALS = (FEATURES & FEATURE_CLEARCOAT_NORMALS) != 0u;
const bool DIFFUSE_TRANSMISSION = (FEATURES & FEATURE_DIFFUSE_TRANSMISSION) != 0u;
const bool SHEEN = (FEATURES & FEATURE_SHEEN) != 0u;
// Whether materials have a record of layers, with or without textures.
const bool LAYERED =
    SPECULAR_COLORS || CLEARCOAT || ANISOTROPY || DIFFUSE_TRANSMISSION || SHEEN || PARTIAL_TRANSMISSION;
const bool SHADED = TEXTURES || SHADING_NORMALS || NORMAL_MAPS || VERTEX_COLORS || LAYERED;
const bool TEXTURED_LIGHTS = (FEATURES & FEATURE_TEXTURED_LIGHTS) != 0u;

vec3 shade_interpolate(vec3 a, vec3 b, vec3 c, vec3 weights) {
    precise vec3 sum = a * weights.x + b * weights.y + c * weights.z;
    return sum;
}

// Red, green and blue of the texture of a use; 1 for NO_TEXTURE. `slot` is the triangle's position in the tables.
vec3 shade_sample(SceneRef scene, uint index, uint slot, vec3 weights) {
    if (index == NO_TEXTURE) return vec3(1.0);
    return texel_at(scene, index, slot, weights).xyz;
}

vec3 shade_color(uvec2 packed) {
    vec3 color = vec3(packed.x & 0xFFFFu, packed.x >> 16, packed.y & 0xFFFFu);
    precise vec3 scaled = color * (1.0 / 65535.0);
    return scaled;
}

vec3 shade_multiply(vec3 a, vec3 b) {
    precise vec3 product = a * b;
    return product;
}

// `normal` turned by a texel of a normal map: `sign` is that of the bitangent.
vec3 shade_turned(vec3 tangent, float sign, vec3 normal, vec3 texel, float scale) {
    precise vec3 across = tangent - normal * dot3(normal, tangent);
    across = normalize_or(across, vec3(0.0));
    if (across == vec3(0.0)) return normal;
    precise vec3 bitangent = cross3(normal, across) * sign;
    precise vec3 offset = texel * 2.0 - vec3(1.0);
    precise vec3 turned = across * (offset.x * scale) + bitangent * (offset.y * scale) + normal * offset.z;
    return normalize_or(turned, normal);
}

// The normal of a normal map, from a texel of it.
vec3 shade_mapped_normal(SceneRef scene, uint slot, vec3 weights, vec3 normal, vec3 texel, float scale) {
    CornerWords packed = scene.shading.tangents + int(slot);
    vec3 tangent =
        shade_interpolate(octahedral_unpack(packed.a), octahedral_unpack(packed.b), octahedral_unpack(packed.c), weights);
    return shade_turned(tangent, (packed.a & 1u) == 1u ? -1.0 : 1.0, normal, texel, scale);
}

// Strength and direction of an anisotropy with a texel of its texture.
vec3 shade_direction(float strength, vec2 direction, vec3 texel) {
    precise vec2 at = texel.xy * 2.0 - vec2(1.0);
    precise vec2 turned = vec2(direction.x * at.x - direction.y * at.y, direction.y * at.x + direction.x * at.y);
    precise float scaled = strength * texel.z;
    return vec3(scaled, turned);
}

// The unit vector of this direction in the frame of a tangent and normal.
vec3 shade_turned_tangent(vec3 tangent, float sign, vec3 normal, vec2 direction) {
    precise vec3 across = tangent - normal * dot3(normal, tangent);
    across = normalize_or(across, vec3(0.0));
    precise vec3 bitangent = cross3(normal, across) * sign;
    precise vec3 turned = across * direction.x + bitangent * direction.y;
    return normalize_or(turned, across);
}

void shade_anisotropy(SceneRef scene, uint index, uint slot, vec3 weights, vec3 normal, inout Layers layers) {
    Anisotropy found = scene.shading.anisotropies[index].at;
    vec3 texel = vec3(1.0, 0.5, 1.0);
    if (found.texture != NO_TEXTURE) texel = texel_at(scene, found.texture, slot, weights).xyz;
    vec3 turned = shade_direction(found.strength, found.direction, texel);
    CornerWords packed = scene.shading.tangents + int(slot);
    vec3 tangent =
        shade_interpolate(octahedral_unpack(packed.a), octahedral_unpack(packed.b), octahedral_unpack(packed.c), weights);
    layers.anisotropy = turned.x;
    layers.tangent = shade_turned_tangent(tangent, (packed.a & 1u) == 1u ? -1.0 : 1.0, normal, turned.yz);
}

// `normal` is the vertex normal on the front.
void shade_coat_normal(
    SceneRef scene, Surface at, uint index, uint slot, vec3 weights, vec3 normal, inout Layers layers
) {
    ClearcoatNormal found = scene.shading.clearcoat_normals[index].at;
    if (found.is_own == 0u) return;
    if (found.texture != NO_TEXTURE) {
        vec3 texel = texel_at(scene, found.texture, slot, weights).xyz;
        normal = shade_mapped_normal(scene, slot, weights, normal, texel, found.scale);
    }
    normal = shading_bend(normal, at.front ? at.normal : -at.normal);
    layers.coat_normal = at.front ? normal : -normal;
}

// Weight and roughness of the clearcoat of a material with one.
vec2 shade_clearcoat(SceneRef scene, MaterialTextures textures, uint slot, vec3 weights) {
    float weight = 1.0, roughness = 1.0;
    if (TEXTURES) {
        weight = shade_sample(scene, textures.clearcoat, slot, weights).x;
        roughness = shade_sample(scene, textures.clearcoat_roughness, slot, weights).y;
    }
    return vec2(alpha_multiply(textures.clearcoat_factor, weight),
        alpha_multiply(textures.clearcoat_roughness_factor, roughness));
}

void shade_transmission(SceneRef scene, uint index, uint slot, vec3 weights, inout Layers layers) {
    DiffuseTransmission found = scene.shading.diffuse_transmissions[index].at;
    layers.diffuse_transmission = found.factor;
    if (found.factor_texture != NO_TEXTURE) {
        layers.diffuse_transmission = alpha_multiply(found.factor, texel_at(scene, found.factor_texture, slot, weights).w);
    }
    layers.transmission_color =
        shade_multiply(found.color, shade_sample(scene, found.color_texture, slot, weights));
}

void shade_sheen(SceneRef scene, uint index, uint slot, vec3 weights, inout Layers layers) {
    SheenLayer found = scene.shading.sheens[index].at;
    layers.sheen_roughness = found.roughness;
    if (found.roughness_texture != NO_TEXTURE) {
        layers.sheen_roughness = alpha_multiply(found.roughness, texel_at(scene, found.roughness_texture, slot, weights).w);
    }
    layers.sheen_color = shade_multiply(found.color, shade_sample(scene, found.color_texture, slot, weights));
}

// Evaluates the surface `at` of a hit: replaces the colours of `material` and `layers`, and returns the shading normal.
vec3 shade(SceneRef scene, Surface at, Hit hit, inout Material material, inout Layers layers) {
    vec3 weights = texel_weights(hit.u, hit.v);
    uint slot = hit.slot;
    if (VERTEX_COLORS) {
        CornerColors colors = scene.shading.colors + int(slot);
        vec3 color =
            shade_interpolate(shade_color(colors.a), shade_color(colors.b), shade_color(colors.c), weights);
        material.albedo = shade_multiply(material.albedo, color);
    }
    vec3 front = at.front ? at.normal : -at.normal;
    vec3 normal = front;
    if (SHADING_NORMALS && scene.shading.has_normals != 0u) {
        CornerWords packed = scene.shading.normals + int(slot);
        if (packed.a != FLAT_TRIANGLE) {
            normal = shade_interpolate(
                octahedral_unpack(packed.a), octahedral_unpack(packed.b), octahedral_unpack(packed.c), weights);
            normal = normalize_or(normal, front);
        }
    }
    if ((TEXTURES || NORMAL_MAPS || LAYERED) && material.textures != 0u) {
        MaterialTextures textures = scene.shading.material_textures[material.textures - 1u].at;
        float share = 0.0;
        if (PARTIAL_TRANSMISSION && GLOSSY) share = partial_share_at(scene, material, slot, hit.u, hit.v);
        if (TEXTURES) {
            material.albedo =
                shade_multiply(material.albedo, shade_sample(scene, textures.base_color, slot, weights));
            material.emission =
                shade_multiply(material.emission, shade_sample(scene, textures.emission, slot, weights));
            if (FOLLOWED && textures.metallic_roughness != NO_TEXTURE) {
                vec3 texel = shade_sample(scene, textures.metallic_roughness, slot, weights);
                vec3 scaled = shade_multiply(vec3(0.0, material.roughness, material.metallic), texel);
                material.roughness = scaled.y;
                material.metallic = scaled.z;
            }
            if (GLOSSY && textures.specular != NO_TEXTURE) {
                float texel = texel_at(scene, textures.specular, slot, weights).w;
                material.specular = alpha_multiply(material.specular, texel);
            }
        }
        if (PARTIAL_TRANSMISSION && GLOSSY) material.metallic = partial_opaque_metallic(material.metallic, share);
        if (SPECULAR_COLORS) {
            layers.specular_color =
                shade_multiply(textures.specular_color_factor, shade_sample(scene, textures.specular_color, slot, weights));
        }
        if (CLEARCOAT && textures.clearcoat_factor > 0.0) {
            vec2 coat = shade_clearcoat(scene, textures, slot, weights);
            layers.clearcoat = coat.x;
            layers.clearcoat_roughness = coat.y;
        }
        if (CLEARCOAT_NORMALS && textures.clearcoat_factor > 0.0) {
            shade_coat_normal(scene, at, material.textures - 1u, slot, weights, normal, layers);
        }
        if (ANISOTROPY && textures.anisotropy != NO_TEXTURE) {
            shade_anisotropy(scene, textures.anisotropy, slot, weights, normal, layers);
        }
        if (DIFFUSE_TRANSMISSION && (material.flags & MATERIAL_DIFFUSE_TRANSMISSION) != 0u) {
            shade_transmission(scene, material.textures - 1u, slot, weights, layers);
        }
        if (SHEEN) shade_sheen(scene, material.textures - 1u, slot, weights, layers);
        if (NORMAL_MAPS && textures.normal != NO_TEXTURE) {
            vec3 texel = shade_sample(scene, textures.normal, slot, weights);
            normal = shade_mapped_normal(scene, slot, weights, normal, texel, textures.normal_scale);
        }
    }
    if (!SHADING_NORMALS) return at.normal;
    normal = shading_bend(normal, front);
    return at.front ? normal : -normal;
}

// The surface as a mirror or glass with the shading normal `normal` sees it: the cosine is to that normal, which is
// bent towards the ray.
void shade_specular(inout Surface at, vec3 direction, inout vec3 normal) {
    normal = shading_bend(normal, -direction);
    at.cosine = -dot3(direction, normal);
}

// A channel of the ratio of a flux to the light's power.
float shade_ratio(float flux, float power) { return power > 0.0 ? flux / power : 0.0; }

vec3 shade_ratios(vec3 emission, vec3 power, float sides, float area) {
    precise vec3 flux = emission * (sides * 3.14159265 * area);
    return vec3(shade_ratio(flux.x, power.x), shade_ratio(flux.y, power.y), shade_ratio(flux.z, power.z));
}

// Ratio of the radiance that an area light emits at barycentric coordinates (u, v) to its mean; alpha multiplies it.
vec3 shade_emission_ratio(SceneRef scene, Light light, uint slot, float u, float v) {
    Material material = scene.materials[scene.primitives[slot].at.material].at;
    vec3 emission = material.emission;
    if (material.textures != 0u) {
        uint used = scene.shading.material_textures[material.textures - 1u].at.emission;
        emission = shade_multiply(emission, shade_sample(scene, used, slot, texel_weights(u, v)));
    }
    if (ALPHA && (material.flags & MATERIAL_ALPHA) != 0u) {
        emission = shade_multiply(emission, vec3(alpha_coverage_at(scene, material, slot, u, v)));
    }
    return shade_ratios(emission, light.power, (light.flags & LIGHT_BOTH_SIDES) != 0u ? 2.0 : 1.0, light.area);
}

#endif
