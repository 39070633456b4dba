// What a glossy surface has beyond its material: twin of photon-core's layers.rs.
#ifndef LAYERS_GLSL
#define LAYERS_GLSL

#include "shading/layout.glsl"

struct Layers {
    // Factor on the reflectance of the coat at normal incidence.
    vec3 specular_color;
    // Weight and roughness of the clearcoat.
    float clearcoat;
    float clearcoat_roughness;
    // Its shading normal on the side of the ray; 0 for that of the surface below.
    vec3 coat_normal;
    // Strength and direction of the anisotropy.
    float anisotropy;
    vec3 tangent;
    // Share of the base that transmits, and its albedo.
    float diffuse_transmission;
    vec3 transmission_color;
    // Colour and roughness of the sheen.
    vec3 sheen_color;
    float sheen_roughness;
};

Layers layers_none() {
    return Layers(vec3(1.0), 0.0, 0.0, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(1.0), vec3(0.0), 0.0);
}

// Reflectance of the coat at normal incidence.
vec3 layers_coat_f0(Layers layers, Material material) {
    precise float at_normal = (material.ior - 1.0) / (material.ior + 1.0);
    precise vec3 f0 = min(layers.specular_color * (at_normal * at_normal), vec3(1.0)) * material.specular;
    return f0;
}

#endif
