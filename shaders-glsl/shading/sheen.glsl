// Sheen over a glossy or diffuse surface: twin of photon-core's sheen.rs. Kernels call it if SHEEN of shade.glsl is true.
#ifndef SHEEN_GLSL
#define SHEEN_GLSL

#include "shading/albedo_table.glsl"
#include "shading/clearcoat.glsl"
#include "shading/constants.glsl"
#include "shading/layers.glsl"
#include "shading/scene.glsl"
#include "shading/shade.glsl"
#include "shading/sheen_lobe.glsl"

// The table of albedos, behind those of glossy surfaces and of rough glass.
SheenAlbedos sheen_table(SceneRef scene) {
    uint ratios = scene.shading.rough_ratios;
    return SheenAlbedos(scene.shading.albedos + int(ROUGH_GLASS_STRIDE * (1u + ratios) + ratios));
}

float sheen_rest(float strength, float albedo) {
    precise float through = 1.0 - strength * min(albedo, 1.0);
    return through;
}

// What it lets through in a direction with this cosine.
float sheen_through(SceneRef scene, float strength, float roughness, float cosine) {
    return sheen_rest(strength, sheen_directional(sheen_table(scene), cosine, roughness));
}

uint sheen_steps(float value, uint most, uint shift) {
    precise float scaled = min(value, 1.0) * float(most) + 0.5;
    return uint(scaled) << shift;
}

// The coat of a query, for a base under a coat of this roughness, F0 and F90, a sheen of this strength, and a clearcoat if
// there is one.
uint sheen_pack(float roughness, float f0, float f90, float strength, Layers layers) {
    float own = max(layers.sheen_roughness, SHEEN_MIN_ROUGHNESS), root = sqrt(f0);
    if (CLEARCOAT && layers.clearcoat > 0.0) {
        return sheen_steps(roughness, 31u, 0u) | sheen_steps(root, 31u, 5u) | sheen_steps(f90, 7u, 10u)
            | sheen_steps(strength, 15u, 13u) | sheen_steps(own, 15u, 22u) | sheen_steps(layers.clearcoat, 7u, 17u)
            | sheen_steps(layers.clearcoat_roughness, 15u, 26u) | 1u << 20;
    }
    return sheen_steps(roughness, 63u, 0u) | sheen_steps(root, 63u, 6u) | sheen_steps(f90, 7u, 12u)
        | sheen_steps(strength, 63u, 15u) | sheen_steps(own, 255u, 22u) | 1u << 21 | 1u << 30;
}

bool sheen_is_alone(uint bits) { return (bits & (1u << 21 | 3u << 30)) == (1u << 21 | 1u << 30); }

bool sheen_is_packed(uint bits) { return sheen_is_alone(bits) || (bits & (3u << 20 | 3u << 30)) == 1u << 20; }

float sheen_part(uint bits, uint most, uint shift) {
    precise float part = float(bits >> shift & most) / float(most);
    return part;
}

// All that is over a base.
struct SheenStack {
    float roughness, f0, f90, strength, own, clearcoat, clearcoat_roughness;
};

// What it lets through to the base.
float sheen_all(SceneRef scene, SheenStack stack, float cosine) {
    precise float through = sheen_through(scene, stack.strength, stack.own, cosine);
    if (stack.f90 > 0.0) {
        vec2 albedo = albedo_directional(scene, cosine, stack.roughness);
        precise float below = 1.0 - (stack.f0 * albedo.x + stack.f90 * albedo.y);
        through = through * below;
    }
    if (CLEARCOAT && stack.clearcoat > 0.0) {
        through = through * clearcoat_through(scene, stack.clearcoat, stack.clearcoat_roughness, cosine);
    }
    return through;
}

// The factor on light that arrives at the base, compared with a base without anything over it.
float sheen_entering(SceneRef scene, uint bits, float cosine) {
    SheenStack stack;
    float root;
    if (sheen_is_alone(bits)) {
        root = sheen_part(bits, 63u, 6u);
        stack = SheenStack(sheen_part(bits, 63u, 0u), 0.0, sheen_part(bits, 7u, 12u), sheen_part(bits, 63u, 15u),
            sheen_part(bits, 255u, 22u), 0.0, 0.0);
    } else {
        root = sheen_part(bits, 31u, 5u);
        stack = SheenStack(sheen_part(bits, 31u, 0u), 0.0, sheen_part(bits, 7u, 10u), sheen_part(bits, 15u, 13u),
            sheen_part(bits, 15u, 22u), sheen_part(bits, 7u, 17u), sheen_part(bits, 15u, 26u));
    }
    precise float f0 = root * root;
    stack.f0 = f0;
    precise float sum = 0.0, weights = 0.0;
    for (uint k = 0u; k < SHEEN_NODES; ++k) {
        // Uniform in the root of the cosine.
        precise float at = (float(k) + 0.5) / float(SHEEN_NODES);
        precise float square = at * at, share = at * at * at;
        sum = sum + share * sheen_all(scene, stack, square);
        weights = weights + share;
    }
    precise float mean = sum / weights;
    precise float through = sheen_all(scene, stack, clamp(cosine, 0.0, 1.0)) / mean;
    return mean > GLOSSY_MIN_SHARE ? through : 0.0;
}

#endif
