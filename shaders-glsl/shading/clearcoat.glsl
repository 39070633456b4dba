// A clearcoat over a glossy or diffuse surface: twin of photon-core's clearcoat.rs. Kernels call it if CLEARCOAT of
// shade.glsl is true.
#ifndef CLEARCOAT_GLSL
#define CLEARCOAT_GLSL

#include "shading/albedo_table.glsl"
#include "shading/constants.glsl"
#include "shading/ggx.glsl"
#include "shading/layers.glsl"

float clearcoat_alpha(float roughness) {
    precise float alpha = roughness * roughness;
    return max(alpha, GGX_MIN_ALPHA);
}

float clearcoat_rest(vec2 albedo, float weight) {
    precise float through = 1.0 - weight * (CLEARCOAT_F0 * albedo.x + albedo.y);
    return through;
}

// What it lets through of light in a direction with this cosine.
float clearcoat_through(SceneRef scene, float weight, float roughness, float cosine) {
    return clearcoat_rest(albedo_directional(scene, clamp(cosine, 0.0, 1.0), roughness), weight);
}

// Its reflection of light from `i` towards `o`, with the half vector `h`: value and density.
vec2 clearcoat_evaluate(float weight, float roughness, vec3 o, vec3 i, vec3 h) {
    precise float across = clamp(1.0 - dot3(o, h), 0.0, 1.0);
    precise float square = across * across;
    precise float grazing = square * square * across;
    precise float fresnel = CLEARCOAT_F0 * (1.0 - grazing) + grazing;
    float alpha = clearcoat_alpha(roughness);
    precise float single = ggx_distribution(alpha, h) * ggx_visibility(alpha, o.z, i.z) * i.z;
    precise float value = weight * fresnel * single;
    return vec2(value, ggx_pdf(alpha, o, h));
}

uint clearcoat_steps(float value, float most) {
    precise float scaled = min(value, 1.0) * most + 0.5;
    return uint(scaled);
}

// The coat of a query, for a base under a coat of this roughness, F0 and F90, and a clearcoat over both.
uint clearcoat_pack(float roughness, float f0, float f90, Layers layers) {
    uint weight = clearcoat_steps(layers.clearcoat, CLEARCOAT_WEIGHT);
    uint below = clearcoat_steps(roughness, CLEARCOAT_LOWER_ROUGHNESS)
        | clearcoat_steps(f90, CLEARCOAT_LOWER_F90) << 6 | clearcoat_steps(sqrt(f0), CLEARCOAT_LOWER_F0) << 10;
    uint above = (weight & 15u) << 17 | clearcoat_steps(layers.clearcoat_roughness, CLEARCOAT_ROUGHNESS) << 22
        | weight >> 4 << 28;
    return below | above | 1u << 21;
}

bool clearcoat_is_packed(uint bits) { return (bits & (1u << 21 | 3u << 30)) == 1u << 21; }

float clearcoat_part(uint bits, uint shift, float most) {
    precise float part = float(bits >> shift & uint(most)) / most;
    return part;
}

// What both coats let through to the base.
float clearcoat_both(
    SceneRef scene, float roughness, float f0, float f90, float weight, float above_roughness, float cosine
) {
    vec2 albedo = albedo_directional(scene, cosine, roughness);
    precise float below = 1.0 - (f0 * albedo.x + f90 * albedo.y);
    precise float both =
        (f90 > 0.0 ? below : 1.0) * clearcoat_through(scene, weight, above_roughness, cosine);
    return both;
}

// The factor on light that arrives at the base, compared with a base without coats.
float clearcoat_entering(SceneRef scene, uint bits, float cosine) {
    float roughness = clearcoat_part(bits, 0u, CLEARCOAT_LOWER_ROUGHNESS);
    float root = clearcoat_part(bits, 10u, CLEARCOAT_LOWER_F0), f90 = clearcoat_part(bits, 6u, CLEARCOAT_LOWER_F90);
    precise float f0 = root * root;
    precise float weight = float(bits >> 17 & 15u | (bits >> 28 & 3u) << 4) / CLEARCOAT_WEIGHT;
    float above = clearcoat_part(bits, 22u, CLEARCOAT_ROUGHNESS);
    precise float mean = clearcoat_rest(albedo_mean(scene, above), weight);
    if (f90 > 0.0) {
        precise float sum = 0.0, weights = 0.0;
        for (uint k = 0u; k < CLEARCOAT_NODES; ++k) {
            // Uniform in the root of the cosine, as the table is.
            precise float at = (float(k) + 0.5) / float(CLEARCOAT_NODES);
            precise float square = at * at, share = at * at * at;
            sum = sum + share * clearcoat_both(scene, roughness, f0, f90, weight, above, square);
            weights = weights + share;
        }
        mean = sum / weights;
    }
    precise float through =
        clearcoat_both(scene, roughness, f0, f90, weight, above, clamp(cosine, 0.0, 1.0)) / mean;
    return mean > GLOSSY_MIN_SHARE ? through : 0.0;
}

// The glossy material that reflects like the clearcoat alone.
Material clearcoat_reflector(Layers layers) {
    Material material;
    material.albedo = vec3(0.0);
    material.kind = MATERIAL_GLOSSY;
    material.roughness = layers.clearcoat_roughness;
    material.specular = layers.clearcoat;
    material.metallic = 0.0;
    material.ior = 1.5;
    return material;
}

#endif
