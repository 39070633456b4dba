// Evaluates the functions of texture.glsl.
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
#include "shading/scene.glsl"

// A coordinate, a size, a wrap mode and a filter; coordinates and the index of a texture; address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    if (FUNCTION == 0u) {
        TextureAxis found = texture_axis(a.x, words.a.y, words.a.z, words.a.w);
        return floats(vec4(float(found.first), float(found.second), found.weight, 0.0), vec4(0.0));
    }
    SceneRef scene = SceneRef(words.c.zw);
    Texture image = scene.shading.textures[words.b.z].at;
    ByteValues values = scene.shading.values;
    return floats(texture_lookup(image, values, b.xy), vec4(0.0));
}
