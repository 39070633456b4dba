//! V12: pictures of surfaces with vertex normals and normal maps that are no normals.

use std::f64::consts::PI;

use photon_core::{Direct, EnvironmentMap, Filter, Settings};
use photon_scene::{
    LightDesc, MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes,
};

use crate::harness::{InFull, TestBackend, direct_settings, look_at_point, per_pass};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// A square of half side 1 at y = 0, seen along its normal.
fn square(attributes: VertexAttributes, textures: TexturesDesc, mut builder: SceneBuilder) -> SceneBuilder {
    let material = builder.material(MaterialDesc::lambert("square", [0.8; 3]).with_textures(textures));
    let positions = vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5 * p[2] + 0.5]).collect();
    builder.mesh_with("square", positions, vec![[0, 1, 2], [0, 2, 3]], attributes.with_uvs(vec![uvs]), material);
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.3);
    builder
}

fn shown<T: TestBackend>(scene: &Scene, direct: Direct) -> (f64, f64) {
    let settings = Settings { photons: 10_000, ..direct_settings(direct, 0.1) };
    let values = per_pass::<InFull<T>>(scene, &settings, 24, 8);
    (moments(&values).0, standard_error(&values))
}

/// V12: vertex normals that are zero, not finite or behind their triangle are replaced by the geometric one: in
/// parallel light the square shows `ρ E cos θ/π`, by shadow rays and photons.
pub fn v12_bad_vertex_normals<T: TestBackend>() {
    let cosine = 0.6;
    let bad = vec![[0.0; 3], [f64::NAN, 1.0, 0.0], [0.3, -1.0, 0.0], [0.0, f64::INFINITY, 0.0]];
    let attributes = VertexAttributes::default().with_normals(bad);
    let mut builder = square(attributes, TexturesDesc::default(), SceneBuilder::new());
    builder.light("sun", LightDesc::Directional { direction: [-0.8, -cosine, 0.0], irradiance: [PI; 3] });
    let scene = builder.build().unwrap();
    // Those of two corners count for both triangles.
    assert!(scene.warnings().iter().any(|warning| warning.starts_with("6 vertex normals")), "{:?}", scene.warnings());
    for direct in [Direct::Nee, Direct::Photons] {
        let (found, error) = shown::<T>(&scene, direct);
        // Packed normals are off by 2⁻¹⁵, times the sine over the cosine.
        assert_agrees(&format!("{direct:?}"), found, 0.8 * cosine, error, 1e-4);
        assert!(!agrees(found, 0.8 * 0.9 * cosine, error, 1e-4), "{direct:?}: {error}");
    }
}

/// V12: normal maps of the texel 0, of one that points backwards, and with a scale of 1000: under an even sky the picture is
/// finite, not brighter than that of the plain surface, and the same by shadow rays and photons.
pub fn v12_bad_normal_maps<T: TestBackend>() {
    for (texel, scale) in [([0, 0, 0, 255], 1.0), ([128, 128, 20, 255], 1.0), ([131, 128, 255, 255], 1000.0)] {
        let mut builder = SceneBuilder::new();
        let map = TextureDesc::linear8("bad", 1, 1, &[texel]).filtered(Filter::Nearest);
        let map = builder.texture(map);
        let textures = TexturesDesc::default().with_normal(TextureRef::new(map)).with_normal_scale(scale);
        let mut builder = square(VertexAttributes::default(), textures, builder);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        let scene = builder.build().unwrap();
        let [(rays, error), (photons, other)] = [Direct::Nee, Direct::Photons].map(|direct| shown::<T>(&scene, direct));
        let what = format!("{texel:?} {scale}");
        assert!(rays > 0.0 && rays <= 0.8 * 1.001 + 4.5 * error, "{what}: {rays}");
        assert_agrees(&what, photons, rays, error.hypot(other), 3e-3);
        assert!(!agrees(photons, 1.5 * rays, error.hypot(other), 3e-3), "{what}: {error} {other}");
    }
}
