// Textures at a point of a triangle: a part of the twin of photon-core's shade.rs. Included by scene.glsl.
#ifndef TEXEL_GLSL
#define TEXEL_GLSL

vec2 texel_uv(vec2 a, vec2 b, vec2 c, vec3 weights) {
    precise vec2 sum = a * weights.x + b * weights.y + c * weights.z;
    return sum;
}

vec2 texel_transform(TextureUse used, vec2 uv) {
    precise vec2 moved = vec2(
        used.transform[0].x * uv.x + used.transform[0].y * uv.y + used.transform[0].z,
        used.transform[1].x * uv.x + used.transform[1].y * uv.y + used.transform[1].z);
    return moved;
}

// Weights of a triangle's vertices.
vec3 texel_weights(float u, float v) {
    precise float first = 1.0 - u - v;
    return vec3(first, u, v);
}

// The texture of a use, which is not NO_TEXTURE. `slot` is the triangle's position in the tables.
vec4 texel_at(SceneRef scene, uint index, uint slot, vec3 weights) {
    TextureUse used = scene.shading.uses[index].at;
    Uvs uvs = scene.shading.uvs + int(used.uv_set * scene.triangles + slot);
    vec2 uv = texel_uv(uvs.a, uvs.b, uvs.c, weights);
    Texture image = scene.shading.textures[used.texture_index].at;
    ByteValues values = scene.shading.values;
    return texture_lookup(image, values, texel_transform(used, uv));
}

#endif
