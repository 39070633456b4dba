// Evaluates the functions of shade.glsl.
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
#include "shading/coated_light.glsl"
#include "shading/shade.glsl"

// Functions of vectors: three of them, and a number beside each. Functions of a scene: barycentric coordinates, a
// light, the position of a triangle in BVH order and whether its front is hit; address of the scene.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    switch (FUNCTION) {
        case 0u: return floats(vec4(shade_interpolate(a.xyz, b.xyz, c.xyz, vec3(a.w, b.w, c.w)), 0.0), vec4(0.0));
        case 1u: return floats(vec4(shade_color(words.a.xy), 0.0), vec4(0.0));
        case 2u: return floats(vec4(shade_turned(a.xyz, a.w, b.xyz, c.xyz, b.w), 0.0), vec4(0.0));
    }
    SceneRef scene = SceneRef(words.c.zw);
    uint slot = words.a.w;
    if (FUNCTION == 3u) {
        Light light = scene.lights[words.a.z].at;
        return floats(vec4(shade_emission_ratio(scene, light, slot, a.x, a.y), 0.0), vec4(0.0));
    }
    if (FUNCTION == 11u) {
        return floats(vec4(emission_through(scene, slot, a.x, a.y, vec3(b.z, b.w, c.x))), vec4(0.0));
    }
    Primitive primitive = scene.primitives[slot].at;
    Surface at;
    at.front = words.b.x != 0u;
    at.normal = at.front ? primitive.normal : -primitive.normal;
    Hit hit;
    hit.u = a.x;
    hit.v = a.y;
    hit.slot = slot;
    Material material = scene.materials[primitive.material].at;
    Layers layers = layers_none();
    vec3 normal = shade(scene, at, hit, material, layers);
    if (FUNCTION == 4u) {
        float metallic = partial_has_glass(material) ? 0.0 : material.metallic;
        return floats(vec4(material.albedo, material.roughness), vec4(material.emission, metallic));
    }
    if (FUNCTION == 6u) {
        return floats(vec4(material.specular, layers.specular_color),
            vec4(layers.clearcoat, layers.clearcoat_roughness, 0.0, 0.0));
    }
    if (FUNCTION == 7u) return floats(vec4(layers.tangent, layers.anisotropy), vec4(0.0));
    if (FUNCTION == 8u) {
        return floats(vec4(layers.transmission_color, layers.diffuse_transmission), vec4(0.0));
    }
    if (FUNCTION == 12u) return floats(vec4(material.metallic, 0.0, 0.0, 0.0), vec4(0.0));
    if (FUNCTION == 10u) return floats(vec4(layers.sheen_color, layers.sheen_roughness), vec4(0.0));
    if (FUNCTION == 9u) return floats(vec4(layers.coat_normal, 0.0), vec4(0.0));
    return floats(vec4(normal, 0.0), vec4(0.0));
}
