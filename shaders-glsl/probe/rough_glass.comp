// Evaluates the functions of rough_glass.glsl and rough_glass_table.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shading/constants.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 0) const uint FEATURES = FEATURE_ALL;
layout(constant_id = 7) const uint MEDIA = 1;

#include "probe/probe.glsl"
#include "shading/rough_glass.glsl"

// A direction and the roughness, another direction and the kind of boundary (0: into glass, 1: out of it, 2: a sheet)
// plus a uniform number, two uniform numbers; address of the scene, whose first material is the glass and whose second
// the sheet.
Output probe(vec4 a, vec4 b, vec4 c, Input words) {
    SceneRef scene = SceneRef(words.c.zw);
    float kind = floor(b.w);
    bool is_sheet = kind == 2.0;
    Material material = scene.materials[is_sheet ? 1u : 0u].at;
    material.roughness = a.w;
    vec3 normal = vec3(0.48, 0.6, -0.64);
    Interface sides = media_interface(scene, material, kind != 1.0, VACUUM);
    if (!rough_glass_is_rough(material, sides)) return floats(vec4(-1.0), vec4(0.0));
    RoughGlass glass = rough_glass_new(scene, material, dot3(a.xyz, normal), sides);
    if (FUNCTION == 0u) {
        float lost = losses_lost(scene, glass.losses, 1u, c.x, a.w);
        return floats(vec4(glass.lost, lost, glass.staying, glass.light_side), vec4(glass.spread, 0.0, 0.0));
    }
    if (FUNCTION == 1u) {
        Reflected found = rough_glass_evaluate(scene, glass, a.xyz, b.xyz, normal);
        return floats(vec4(found.value, found.pdf), vec4(0.0));
    }
    RoughSample drawn = rough_glass_sample(scene, glass, a.xyz, normal, b.w - kind, c.x, c.y);
    return floats(vec4(drawn.direction, drawn.stays ? 1.0 : 0.0), vec4(glossy_weight(drawn.found, 1.0), drawn.rest));
}
