// Light that a surface with a clearcoat emits: twin of photon-core's coated_light.rs. Kernels call it if COATED_LIGHTS is
// true.
#ifndef COATED_LIGHT_GLSL
#define COATED_LIGHT_GLSL

#include "shading/clearcoat.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"

const bool COATED_LIGHTS = (FEATURES & FEATURE_COATED_LIGHTS) != 0u;

// The share of the radiance emitted at barycentric coordinates (u, v) of the triangle at `slot` that leaves through its
// clearcoat in `direction`.
float emission_through(SceneRef scene, uint slot, float u, float v, vec3 direction) {
    Primitive primitive = scene.primitives[slot].at;
    uint index = scene.materials[primitive.material].at.textures;
    if (index == 0u) return 1.0;
    MaterialTextures textures = scene.shading.material_textures[index - 1u].at;
    if (!(textures.clearcoat_factor > 0.0)) return 1.0;
    vec3 weights = texel_weights(u, v), front = primitive.normal;
    vec3 normal = front;
    vec2 coat = shade_clearcoat(scene, textures, slot, weights);
    if (SHADING_NORMALS) {
        uint map = textures.normal;
        float scale = textures.normal_scale;
        if (CLEARCOAT_NORMALS) {
            ClearcoatNormal own = scene.shading.clearcoat_normals[index - 1u].at;
            if (own.is_own != 0u) {
                map = own.texture;
                scale = own.scale;
            }
        }
        if (scene.shading.has_normals != 0u) {
            CornerWords packed = scene.shading.normals + int(slot);
            if (packed.a != FLAT_TRIANGLE) {
                normal = shade_interpolate(
                    octahedral_unpack(packed.a), octahedral_unpack(packed.b), octahedral_unpack(packed.c), weights);
                normal = normalize_or(normal, front);
            }
        }
        if (NORMAL_MAPS && map != NO_TEXTURE) {
            vec3 texel = shade_sample(scene, map, slot, weights);
            normal = shade_mapped_normal(scene, slot, weights, normal, texel, scale);
        }
        normal = shading_bend(normal, front);
    }
    float cosine = dot3(direction, normal);
    if (dot3(direction, front) < 0.0) cosine = -cosine;
    return clearcoat_through(scene, coat.x, coat.y, cosine);
}

#endif
