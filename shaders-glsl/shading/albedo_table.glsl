// Directional albedos of GGX reflection: twin of photon-core's albedo_table.rs.
#ifndef ALBEDO_TABLE_GLSL
#define ALBEDO_TABLE_GLSL

#include "shading/constants.glsl"
#include "shading/scene.glsl"

vec2 albedo_mix(vec2 from, vec2 to, float share) {
    precise vec2 mixed = from * (1.0 - share) + to * share;
    return mixed;
}

// The entry before a coordinate in [0, 1], and the position between it and the next one.
uint albedo_place(float coordinate, out float within) {
    precise float at = coordinate * float(ALBEDO_TABLE_SIZE - 1u);
    uint first = min(uint(at), ALBEDO_TABLE_SIZE - 2u);
    precise float rest = at - float(first);
    within = rest;
    return first;
}

vec2 albedo_row(SceneRef scene, uint first, float across) {
    return albedo_mix(scene.shading.albedos[first].at, scene.shading.albedos[first + 1u].at, across);
}

// Both albedos of the table whose entries begin at `table`.
vec2 albedo_directional_at(SceneRef scene, uint table, float cosine, float roughness) {
    float across, down;
    uint column = albedo_place(sqrt(cosine), across);
    uint row = albedo_place(roughness, down);
    uint first = table + row * ALBEDO_TABLE_SIZE + column;
    return albedo_mix(albedo_row(scene, first, across), albedo_row(scene, first + ALBEDO_TABLE_SIZE, across), down);
}

// Both means of that table over the hemisphere.
vec2 albedo_mean_at(SceneRef scene, uint table, float roughness) {
    float down;
    uint row = albedo_place(roughness, down);
    return albedo_row(scene, table + ALBEDO_TABLE_SIZE * ALBEDO_TABLE_SIZE + row, down);
}

// Albedos for F0 = 1 and for F90 = 1.
vec2 albedo_directional(SceneRef scene, float cosine, float roughness) {
    return albedo_directional_at(scene, 0u, cosine, roughness);
}

// Their means over the hemisphere.
vec2 albedo_mean(SceneRef scene, float roughness) { return albedo_mean_at(scene, 0u, roughness); }

#endif
