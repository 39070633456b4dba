// How a surface scatters: which of the three rules applies at a path vertex. Twin of photon-core's scattering.rs.
//
// Called once the material has been evaluated at the point and the media on both sides are known. Kernels write `GLOSSY &&`
// and `ROUGH_GLASS &&` before they compare the answer: functions behind constants that are false are not compiled.
#ifndef SCATTERING_GLSL
#define SCATTERING_GLSL

#include "shading/bsdf.glsl"
#include "shading/glossy.glsl"
#include "shading/rough_glass.glsl"
#include "shading/shade.glsl"

// Diffuse reflection, mirrors and smooth glass: bsdf_new.
const uint SCATTERING_SIMPLE = 0u;
// A reflection about the mirror direction over a diffuse base: glossy_at.
const uint SCATTERING_GLOSSY = 1u;
// Reflection and transmission by microfacets: rough_glass_new.
const uint SCATTERING_ROUGH_GLASS = 2u;

uint scattering_at(Material material, Interface sides) {
    if (GLOSSY && material.kind == MATERIAL_GLOSSY) return SCATTERING_GLOSSY;
    if (ROUGH_GLASS && rough_glass_is_rough(material, sides)) return SCATTERING_ROUGH_GLASS;
    return SCATTERING_SIMPLE;
}

// Whether camera paths sample lights here; twin of Material::samples_lights. What is rough between equal media does too,
// which changes nothing: it scatters nothing.
bool material_samples_lights(Material material) {
    return material.kind == MATERIAL_LAMBERT || material.kind == MATERIAL_GLOSSY
        || (ROUGH_GLASS && kind_transmits(material.kind)
            && material.roughness * material.roughness >= GGX_MIN_ALPHA);
}

#endif
