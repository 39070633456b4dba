// What single scattering at rough glass loses: twin of photon-core's rough_glass_table.rs. The tables follow those of
// glossy surfaces: the ratios of refractive indices, then the entries of each.
#ifndef ROUGH_GLASS_TABLE_GLSL
#define ROUGH_GLASS_TABLE_GLSL

#include "shading/albedo_table.glsl"
#include "shading/constants.glsl"
#include "shading/scene.glsl"

// First entry of a table, and which of its two sides the path is on.
struct Losses {
    uint first;
    bool is_turned;
    bool is_sheet;
};

Losses losses_of_sheet() { return Losses(0u, false, true); }

vec2 losses_apart(vec2 pair, float eta) {
    precise vec2 apart = abs(pair - vec2(eta));
    return apart;
}

// The losses at a boundary with this ratio of the index behind it to that before it; of the most similar ratio.
Losses losses_of(SceneRef scene, float eta) {
    uint count = scene.shading.rough_ratios;
    uint best = 0u;
    bool is_turned = false;
    float least = 3.4028235e38;
    for (uint ratio = 0u; ratio < count; ++ratio) {
        vec2 pair = scene.shading.albedos[ROUGH_GLASS_STRIDE + ratio].at;
        vec2 apart = losses_apart(pair, eta);
        if (apart.x < least) {
            least = apart.x;
            best = ratio;
            is_turned = false;
        }
        if (apart.y < least) {
            least = apart.y;
            best = ratio;
            is_turned = true;
        }
    }
    return Losses(ROUGH_GLASS_STRIDE + count + best * ROUGH_GLASS_STRIDE, is_turned, false);
}

float losses_rest(Losses losses, uint side, vec2 albedos) {
    precise float lost = 1.0 - (losses.is_turned == (side == 1u) ? albedos.x : albedos.y);
    precise float of_sheet = 1.0 - (albedos.x + albedos.y);
    return max(losses.is_sheet ? of_sheet : lost, 0.0);
}

// 1 - E on side 0, where the path comes from, or 1.
float losses_lost(SceneRef scene, Losses losses, uint side, float cosine, float roughness) {
    return losses_rest(losses, side, albedo_directional_at(scene, losses.first, cosine, roughness));
}

// The mean of that over the hemisphere.
float losses_mean(SceneRef scene, Losses losses, uint side, float roughness) {
    return losses_rest(losses, side, albedo_mean_at(scene, losses.first, roughness));
}

#endif
