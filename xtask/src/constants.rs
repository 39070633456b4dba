//! Constants shared by Rust and GLSL: generates `shaders-glsl/shading/constants.glsl` from the libraries that
//! backends share, and `shaders-glsl/device/constants.glsl` from the Vulkan backend.

mod device;
mod file;
mod library;

use std::fs;

use photon_core::random::{
    BLOCK_LIGHT, BLOCK_LIGHT_SIDES, BLOCK_LIGHTS, BLOCK_SEGMENTS, BLOCK_START, BLOCK_SURFACES, Domain, GOLDEN_STEP,
};
use photon_core::{
    Camera, Estimate, Features, Filter, Kernel, Layer, Light, MapKind, Material, MaterialKind, MaterialTextures,
    MediaFeatures, Medium, QUERIES_PER_PIXEL, RandomKind, ShadingTables, TexelFormat, Wrap,
};

use self::file::{Group, compare, text};
use crate::shell;

/// Constants of records and settings, by group.
fn groups() -> Vec<(&'static str, Vec<(&'static str, u32)>)> {
    vec![
        (
            "Material::kind.",
            vec![
                ("MATERIAL_LAMBERT", MaterialKind::Lambert as u32),
                ("MATERIAL_MIRROR", MaterialKind::Mirror as u32),
                ("MATERIAL_DIELECTRIC", MaterialKind::Dielectric as u32),
                ("MATERIAL_THIN", MaterialKind::Thin as u32),
                ("MATERIAL_GLOSSY", MaterialKind::Glossy as u32),
            ],
        ),
        (
            "Material::flags.",
            vec![
                ("MATERIAL_EMITS_BOTH_SIDES", Material::EMITS_BOTH_SIDES),
                ("MATERIAL_ALPHA", Material::ALPHA),
                ("MATERIAL_DIFFUSE_TRANSMISSION", Material::DIFFUSE_TRANSMISSION),
                ("MATERIAL_PARTIAL_TRANSMISSION", Material::PARTIAL_TRANSMISSION),
            ],
        ),
        (
            "Light::kind.",
            vec![
                ("LIGHT_TRIANGLE", Light::TRIANGLE),
                ("LIGHT_POINT", Light::POINT),
                ("LIGHT_SPOT", Light::SPOT),
                ("LIGHT_DIRECTIONAL", Light::DIRECTIONAL),
                ("LIGHT_ENVIRONMENT", Light::ENVIRONMENT),
            ],
        ),
        (
            "MediaFeatures: bits of a specialization constant.",
            vec![
                ("MEDIA_NESTED", MediaFeatures::NESTED.bits()),
                ("MEDIA_DISPERSION", MediaFeatures::DISPERSION.bits()),
                ("MEDIA_SCATTERING", MediaFeatures::SCATTERING.bits()),
                ("MEDIA_AMBIENT", MediaFeatures::AMBIENT.bits()),
                ("MEDIA_PHASES", MediaFeatures::PHASES.bits()),
                ("MEDIA_GRIDS", MediaFeatures::GRIDS.bits()),
                ("MEDIA_BOUNDARIES", MediaFeatures::BOUNDARIES.bits()),
            ],
        ),
        (
            "Medium::dispersion.",
            vec![
                ("MEDIUM_CAUCHY", Medium::CAUCHY),
                ("MEDIUM_SELLMEIER", Medium::SELLMEIER),
                ("MEDIUM_MATCHED", Medium::MATCHED),
            ],
        ),
        ("Medium::phase.", vec![("MEDIUM_RAYLEIGH", Medium::RAYLEIGH), ("MEDIUM_MIE", Medium::MIE)]),
        ("Light::flags.", vec![("LIGHT_BOTH_SIDES", Light::BOTH_SIDES)]),
        (
            "Camera::kind.",
            vec![("CAMERA_PERSPECTIVE", Camera::PERSPECTIVE), ("CAMERA_ORTHOGRAPHIC", Camera::ORTHOGRAPHIC)],
        ),
        ("Estimate::flags.", vec![("ESTIMATE_SINGULAR", Estimate::SINGULAR)]),
        (
            "Bits of Features: specialization constant 0.",
            vec![
                ("FEATURE_DIFFUSE", Features::DIFFUSE.bits()),
                ("FEATURE_MIRROR", Features::MIRROR.bits()),
                ("FEATURE_DIELECTRIC", Features::DIELECTRIC.bits()),
                ("FEATURE_THIN", Features::THIN.bits()),
                ("FEATURE_ABSORPTION", Features::ABSORPTION.bits()),
                ("FEATURE_AREA_LIGHTS", Features::AREA_LIGHTS.bits()),
                ("FEATURE_POINT_LIGHTS", Features::POINT_LIGHTS.bits()),
                ("FEATURE_SPOT_LIGHTS", Features::SPOT_LIGHTS.bits()),
                ("FEATURE_DIRECTIONAL_LIGHTS", Features::DIRECTIONAL_LIGHTS.bits()),
                ("FEATURE_TEXTURES", Features::TEXTURES.bits()),
                ("FEATURE_SHADING_NORMALS", Features::SHADING_NORMALS.bits()),
                ("FEATURE_NORMAL_MAPS", Features::NORMAL_MAPS.bits()),
                ("FEATURE_VERTEX_COLORS", Features::VERTEX_COLORS.bits()),
                ("FEATURE_TEXTURED_LIGHTS", Features::TEXTURED_LIGHTS.bits()),
                ("FEATURE_ENVIRONMENT", Features::ENVIRONMENT.bits()),
                ("FEATURE_GLOSSY", Features::GLOSSY.bits()),
                ("FEATURE_ROUGH_GLASS", Features::ROUGH_GLASS.bits()),
                ("FEATURE_ALPHA", Features::ALPHA.bits()),
                ("FEATURE_LIGHT_TREE", Features::LIGHT_TREE.bits()),
                ("FEATURE_THIN_LENS", Features::THIN_LENS.bits()),
                ("FEATURE_SPECULAR_COLORS", Features::SPECULAR_COLORS.bits()),
                ("FEATURE_CLEARCOAT", Features::CLEARCOAT.bits()),
                ("FEATURE_SUN", Features::SUN.bits()),
                ("FEATURE_ANISOTROPY", Features::ANISOTROPY.bits()),
                ("FEATURE_DIFFUSE_TRANSMISSION", Features::DIFFUSE_TRANSMISSION.bits()),
                ("FEATURE_CLEARCOAT_NORMALS", Features::CLEARCOAT_NORMALS.bits()),
                ("FEATURE_COATED_LIGHTS", Features::COATED_LIGHTS.bits()),
                ("FEATURE_SHEEN", Features::SHEEN.bits()),
                ("FEATURE_PARTIAL_TRANSMISSION", Features::PARTIAL_TRANSMISSION.bits()),
                ("FEATURE_PORTALS", Features::PORTALS.bits()),
                ("FEATURE_SPECULAR", Features::SPECULAR.bits()),
                ("FEATURE_ALL", Features::ALL.bits()),
            ],
        ),
        (
            "TexelFormat, Wrap, Filter.",
            vec![
                ("TEXEL_LINEAR8", TexelFormat::Linear8 as u32),
                ("TEXEL_SRGB8", TexelFormat::Srgb8 as u32),
                ("TEXEL_FLOAT32", TexelFormat::Float32 as u32),
                ("WRAP_REPEAT", Wrap::Repeat as u32),
                ("WRAP_MIRROR", Wrap::Mirror as u32),
                ("WRAP_CLAMP", Wrap::Clamp as u32),
                ("FILTER_LINEAR", Filter::Linear as u32),
                ("FILTER_NEAREST", Filter::Nearest as u32),
            ],
        ),
        (
            "MaterialTextures without a texture; a triangle without vertex normals.",
            vec![("NO_TEXTURE", MaterialTextures::NONE), ("FLAT_TRIANGLE", ShadingTables::FLAT)],
        ),
        ("RandomKind.", vec![("RANDOM_COUNTER", RandomKind::Counter as u32), ("RANDOM_LCG", RandomKind::Lcg as u32)]),
        (
            "random::Domain.",
            vec![
                ("DOMAIN_PHOTON", Domain::Photon as u32),
                ("DOMAIN_EYE", Domain::Eye as u32),
                ("DOMAIN_SHADOW", Domain::Shadow as u32),
                ("DOMAIN_GATHER", Domain::Gather as u32),
                ("DOMAIN_AREA", Domain::Area as u32),
                ("DOMAIN_AIMED", Domain::Aimed as u32),
                ("DOMAIN_FLIGHT", Domain::Flight as u32),
                ("DOMAIN_DEPOSIT", Domain::Deposit as u32),
                ("DOMAIN_SEGMENT", Domain::Segment as u32),
                ("DOMAIN_WAVELENGTH", Domain::Wavelength as u32),
            ],
        ),
        (
            "Blocks of dimensions.",
            vec![
                ("BLOCK_LIGHT", BLOCK_LIGHT),
                ("BLOCK_START", BLOCK_START),
                ("BLOCK_SURFACES", BLOCK_SURFACES),
                ("BLOCK_LIGHTS", BLOCK_LIGHTS),
                ("BLOCK_LIGHT_SIDES", BLOCK_LIGHT_SIDES),
                ("BLOCK_SEGMENTS", BLOCK_SEGMENTS),
                ("GOLDEN_STEP", GOLDEN_STEP),
            ],
        ),
        (
            "Kernel::number.",
            vec![
                ("KERNEL_CONSTANT", Kernel::Constant.number()),
                ("KERNEL_EPANECHNIKOV", Kernel::Epanechnikov.number()),
            ],
        ),
        (
            "Layer.",
            vec![
                ("LAYER_EMISSION", Layer::Emission as u32),
                ("LAYER_DIRECT", Layer::Direct as u32),
                ("LAYER_CAUSTIC", Layer::Caustic as u32),
                ("LAYER_INDIRECT", Layer::Indirect as u32),
            ],
        ),
        (
            "MapKind, how many there are, and the bits that one takes beside an ordinal.",
            vec![
                ("MAP_DIRECT", MapKind::Direct as u32),
                ("MAP_CAUSTIC", MapKind::Caustic as u32),
                ("MAP_GLOBAL", MapKind::Global as u32),
                ("MAP_COUNT", MapKind::COUNT as u32),
                ("MAP_BITS", MapKind::BITS),
            ],
        ),
        ("Camera paths that one pixel of one pass may end in.", vec![("QUERIES_PER_PIXEL", QUERIES_PER_PIXEL)]),
    ]
}

/// The files that are written: path below the root, include guard, constants.
fn files() -> [(&'static str, &'static str, Vec<Group>); 2] {
    let records = groups()
        .into_iter()
        .map(|(what, numbers)| (what, numbers.into_iter().map(|(name, number)| (name, number.into())).collect()));
    [
        ("shaders-glsl/shading/constants.glsl", "CONSTANTS_GLSL", records.chain(library::groups()).collect()),
        ("shaders-glsl/device/constants.glsl", "DEVICE_CONSTANTS_GLSL", device::groups()),
    ]
}

/// Writes the files that differ.
pub(crate) fn write() -> Result<(), String> {
    for (path, guard, groups) in files() {
        let (path, text) = (shell::root().join(path), text(guard, &groups));
        if compare(&path, &text).is_err() {
            eprintln!("wrote {}", path.display());
            fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        }
    }
    Ok(())
}

/// Fails if a file is not up to date.
pub(crate) fn fresh() -> Result<(), String> {
    files().iter().try_for_each(|(path, guard, groups)| compare(&shell::root().join(path), &text(guard, groups)))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_committed_files_are_fresh() {
        super::fresh().unwrap();
    }
}
