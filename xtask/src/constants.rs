//! Constants shared by Rust and GLSL: generates `shaders-glsl/shading/constants.glsl` from Rust.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use photon_core::random::{BLOCK_LIGHT, BLOCK_START, BLOCK_SURFACES, Domain};
use photon_core::{
    Camera, Estimate, Features, Filter, Kernel, Layer, Light, MapKind, Material, MaterialKind, MaterialTextures,
    MediaFeatures, QUERIES_PER_PIXEL, RandomKind, ShadingTables, TexelFormat, Wrap,
};

use crate::shell;

/// A description of a group of constants, and their names and values.
type Group = (&'static str, Vec<(&'static str, u32)>);

/// All shared constants.
fn groups() -> Vec<Group> {
    vec![
        (
            "Material::kind.",
            vec![
                ("MATERIAL_LAMBERT", MaterialKind::Lambert as u32),
                ("MATERIAL_MIRROR", MaterialKind::Mirror as u32),
                ("MATERIAL_DIELECTRIC", MaterialKind::Dielectric as u32),
                ("MATERIAL_THIN", MaterialKind::Thin as u32),
            ],
        ),
        ("Material::flags.", vec![("MATERIAL_EMITS_BOTH_SIDES", Material::EMITS_BOTH_SIDES)]),
        (
            "Light::kind.",
            vec![
                ("LIGHT_TRIANGLE", Light::TRIANGLE),
                ("LIGHT_POINT", Light::POINT),
                ("LIGHT_SPOT", Light::SPOT),
                ("LIGHT_DIRECTIONAL", Light::DIRECTIONAL),
            ],
        ),
        ("MediaFeatures: bits of a specialization constant.", vec![("MEDIA_NESTED", MediaFeatures::NESTED.bits())]),
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
        (
            "RandomKind.",
            vec![
                ("RANDOM_COUNTER", RandomKind::Counter as u32),
                ("RANDOM_LCG", RandomKind::Lcg as u32),
                ("RANDOM_SOBOL", RandomKind::Sobol as u32),
            ],
        ),
        (
            "random::Domain.",
            vec![
                ("DOMAIN_PHOTON", Domain::Photon as u32),
                ("DOMAIN_EYE", Domain::Eye as u32),
                ("DOMAIN_SHADOW", Domain::Shadow as u32),
                ("DOMAIN_GATHER", Domain::Gather as u32),
                ("DOMAIN_AREA", Domain::Area as u32),
                ("DOMAIN_AIMED", Domain::Aimed as u32),
            ],
        ),
        (
            "Blocks of dimensions.",
            vec![("BLOCK_LIGHT", BLOCK_LIGHT), ("BLOCK_START", BLOCK_START), ("BLOCK_SURFACES", BLOCK_SURFACES)],
        ),
        (
            "Kernel::number.",
            vec![
                ("KERNEL_CONSTANT", Kernel::Constant.number()),
                ("KERNEL_EPANECHNIKOV", Kernel::Epanechnikov.number()),
                ("KERNEL_CONE", Kernel::Cone { slope: 1.0 }.number()),
                ("KERNEL_BIWEIGHT", Kernel::Biweight.number()),
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

/// The text of the file.
fn text() -> String {
    let mut text = "// Numbers that Rust and GLSL share. Written by `cargo xtask constants`.\n\
                    #ifndef CONSTANTS_GLSL\n#define CONSTANTS_GLSL\n"
        .to_owned();
    for (what, numbers) in groups() {
        let _ = writeln!(text, "\n// {what}");
        for (name, number) in numbers {
            let _ = writeln!(text, "const uint {name} = {number}u;");
        }
    }
    text.push_str("\n#endif\n");
    text
}

fn file() -> PathBuf {
    shell::root().join("shaders-glsl/shading/constants.glsl")
}

/// Writes the file, if it differs.
pub(crate) fn write() -> Result<(), String> {
    let path = file();
    if compare(&path).is_ok() {
        return Ok(());
    }
    eprintln!("wrote {}", path.display());
    fs::write(&path, text()).map_err(|error| format!("{}: {error}", path.display()))
}

/// Fails if the file is not up to date.
pub(crate) fn fresh() -> Result<(), String> {
    compare(&file())
}

fn compare(path: &Path) -> Result<(), String> {
    let old = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    if old == text() {
        return Ok(());
    }
    Err(format!("{} is stale: run `cargo xtask constants`, then `cargo xtask shaders`", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_file_is_fresh() {
        fresh().unwrap();
    }

    #[test]
    fn a_doctored_file_is_stale() {
        let path = std::env::temp_dir().join(format!("photon-constants-{}.glsl", std::process::id()));
        fs::write(&path, text()).unwrap();
        assert!(compare(&path).is_ok());
        fs::write(&path, text().replace("LIGHT_SPOT = 2u", "LIGHT_SPOT = 3u")).unwrap();
        assert!(compare(&path).unwrap_err().contains("stale"));
        fs::remove_file(&path).unwrap();
        assert!(compare(&path).is_err());
    }
}
