// Reflection and refraction at smooth dielectric boundaries. Twin of photon-core's fresnel.rs.
#ifndef FRESNEL_GLSL
#define FRESNEL_GLSL

#include "shading/math.glsl"

struct Fresnel {
    float reflectance;
    float cos_transmitted;
};

// `eta` is the index of refraction beyond the boundary divided by the one before it.
Fresnel fresnel(float cos_incident, float eta) {
    float c = clamp(cos_incident, 0.0, 1.0);
    if (eta == 1.0) return Fresnel(0.0, c);
    precise float steep = eta * eta - (1.0 - c) * (1.0 + c);
    precise float shallow = (eta - 1.0) * (eta + 1.0) + c * c;
    float discriminant = eta < 0.5 ? steep : shallow;
    if (discriminant <= 0.0) return Fresnel(1.0, 0.0);
    float eta_cos_t = sqrt(discriminant);
    precise float cos_t = eta_cos_t / eta;
    precise float s = (c - eta_cos_t) / (c + eta_cos_t);
    precise float p = (eta * c - cos_t) / (eta * c + cos_t);
    precise float reflectance = 0.5 * (s * s + p * p);
    return Fresnel(clamp(reflectance, 0.0, 1.0), min(cos_t, 1.0));
}

// Reflectance of a thin sheet, including all interreflections between its two faces.
float sheet_reflectance(float single) {
    precise float both = 2.0 * single / (1.0 + single);
    return both;
}

// (1 - cosine)^5, by which the reflectance of a metal rises to 1.
float schlick_rise(float cosine) {
    float across = 1.0 - clamp(cosine, 0.0, 1.0);
    precise float square = across * across;
    precise float rise = square * square * across;
    return rise;
}

// The mirror direction of `direction` about `normal`; both unit vectors.
vec3 bsdf_reflect(vec3 direction, vec3 normal) {
    precise vec3 mirrored = direction - normal * (2.0 * dot3(direction, normal));
    return normalize_or(mirrored, normal);
}

// The refracted direction; `normal` faces the side the ray comes from.
vec3 bsdf_refract(vec3 direction, vec3 normal, float eta, float cos_transmitted) {
    if (eta == 1.0) return direction;
    float c = -dot3(direction, normal);
    precise vec3 bent = direction / eta + normal * (c / eta - cos_transmitted);
    return normalize_or(bent, direction);
}

#endif
