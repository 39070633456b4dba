// The records of photon-core (layout.rs, material.rs, medium.rs, light.rs, light_tree.rs, camera.rs), member by member: offsets are checked against the SPIR-V.
// `Photons p` is the address of an array; its element i is `p[i].at`.
#ifndef LAYOUT_GLSL
#define LAYOUT_GLSL

struct Photon {
    vec3 position;
    uint normal;
    vec3 power;
    uint direction;
};

struct PhotonRay {
    vec3 origin;
    uint path;
    vec3 direction;
    uint light;
    vec3 power;
    uint media;
};

struct Query {
    vec3 position;
    float radius;
    vec3 normal;
    uint pixel;
    vec3 throughput;
    uint media;
    // Packed offset of shadow rays; in a query for a reflection, the packed direction towards the viewer.
    uint offset_or_wo;
    uint path;
    uint shading_normal;
    uint coat;
};

struct Estimate {
    vec3 flux;
    float radius_squared;
    uint photons;
    uint flags;
    vec2 power_sums;
};

struct ErrorMoments {
    vec3 wide;
    float power;
    vec3 narrow;
    float power_squared;
    vec2 slope;
    vec2 quadrupole;
    float stray;
    uint photons;
    uint reserved[2];
};

struct Primitive {
    vec3 normal;
    uint material;
};

struct Material {
    vec3 albedo;
    uint kind;
    vec3 emission;
    uint flags;
    uint medium;
    float ior;
    uint textures;
    float metallic;
    float roughness;
    float specular;
    float alpha;
    float alpha_cutoff;
};

struct Medium {
    vec3 absorption;
    float ior;
    uint priority;
    uint dispersion;
    float terms[6];
    vec3 scattering;
    float anisotropy;
    uint phase;
    float draine[3];
};

struct Grid {
    vec4 x;
    vec4 y;
    vec4 z;
    uvec3 cells;
    uint first;
};

struct Light {
    vec3 position;
    uint kind;
    vec3 direction;
    uint primitive;
    vec3 power;
    float versine_inner;
    float versine_outer;
    float radius;
    float area;
    uint flags;
};

struct Camera {
    vec3 origin;
    uint kind;
    vec3 forward;
    uint media;
    vec3 right;
    float lens_radius;
    vec3 up;
    float focus_distance;
};

struct TextureUse {
    vec3 transform[2];
    uint texture_index;
    uint uv_set;
};

struct MaterialTextures {
    uint base_color;
    uint emission;
    uint normal;
    float normal_scale;
    uint metallic_roughness;
    uint alpha;
    uint specular;
    uint specular_color;
    vec3 specular_color_factor;
    float clearcoat_factor;
    float clearcoat_roughness_factor;
    uint clearcoat;
    uint clearcoat_roughness;
    uint anisotropy;
};

struct Anisotropy {
    float strength;
    vec2 direction;
    uint texture;
};

struct DiffuseTransmission {
    vec3 color;
    float factor;
    uint color_texture;
    uint factor_texture;
    uint reserved[2];
};

struct SheenLayer {
    vec3 color;
    float roughness;
    uint color_texture;
    uint roughness_texture;
    uint reserved[2];
};

struct PartialTransmission {
    float factor;
    uint factor_texture;
    uint glass;
    uint reserved;
};

struct ClearcoatNormal {
    uint is_own;
    uint texture;
    float scale;
    uint reserved;
};

struct LightNode {
    vec3 center;
    float radius;
    float intensity;
    uint axis;
    uint cone;
    uint next;
};

// Every record is a multiple of 16 bytes long, and every buffer begins at a multiple of 16.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Photons { Photon at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PhotonRays { PhotonRay at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Queries { Query at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Estimates { Estimate at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ErrorMomentsBuffer { ErrorMoments at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Primitives { Primitive at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Materials { Material at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Media { Medium at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Grids { Grid at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Lights { Light at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Cameras { Camera at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer TextureUses { TextureUse at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer LightNodes { LightNode at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer MaterialTextureTable { MaterialTextures at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer AnisotropyTable { Anisotropy at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ClearcoatNormalTable { ClearcoatNormal at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer TransmissionTable { DiffuseTransmission at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer SheenLayerTable { SheenLayer at; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PartialTransmissionTable { PartialTransmission at; };

// Entries of photon-core's SheenTable.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SheenAlbedos { float at; };

#endif
