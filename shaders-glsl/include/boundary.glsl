// What happens at glass. Twin of `boundary` in backend-cpu's trace.rs.
#ifndef BOUNDARY_GLSL
#define BOUNDARY_GLSL

#include "bsdf.glsl"
#include "constants.glsl"
#include "scene.glsl"

// Reflectance of glass; the direction of what passes in `beyond`.
float boundary(Material material, Surface at, vec3 direction, out vec3 beyond) {
    if (material.kind == MATERIAL_THIN) {
        beyond = direction;
        return sheet_reflectance(fresnel(at.cosine, material.ior).reflectance);
    }
    float eta = material.ior;
    if (!at.front) {
        precise float inverse = 1.0 / material.ior;
        eta = inverse;
    }
    Fresnel split = fresnel(at.cosine, eta);
    beyond = bsdf_refract(direction, at.normal, eta, split.cos_transmitted);
    return split.reflectance;
}

#endif
