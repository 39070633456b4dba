// Which photons count in which glossy reflections: twin of photon-core's gloss_caustics.rs.
#ifndef GLOSS_CAUSTICS_GLSL
#define GLOSS_CAUSTICS_GLSL

#include "shading/constants.glsl"
#include "shading/layers.glsl"
#include "shading/layout.glsl"

// The roughness of the narrowest part of a glossy reflection.
float gloss_caustics_narrowest(Material material, Layers layers) {
    float roughness = material.roughness;
    if (layers.clearcoat > 0.0) roughness = min(roughness, layers.clearcoat_roughness);
    if (layers.sheen_color != vec3(0.0)) roughness = min(roughness, layers.sheen_roughness);
    return roughness;
}

// Whether camera paths find a light of this kind only by sampling it.
bool gloss_caustics_is_sampled_only(uint kind) {
    return kind == LIGHT_POINT || kind == LIGHT_SPOT || kind == LIGHT_DIRECTIONAL;
}

// A packed direction with its mark.
uint gloss_caustics_with_mark(uint packed, bool marked) { return (packed & ~1u) | (marked ? 1u : 0u); }

// Whether the photon of one packed direction counts for the query of the other.
bool gloss_caustics_counts(uint photon, uint query) { return ((photon | query) & 1u) != 0u; }

#endif
