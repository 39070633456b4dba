//! V16: a scene with all kinds of surfaces and lights gives the same bits in any size that is a power of two, on any number of
//! threads, and for requirements that include more than it needs.

use photon_core::{
    CausticPhotons, EnvironmentMap, Features, Film, Pipeline, Render, Requirements, Settings, TransportBackend, View,
};
use photon_scene::{
    AlphaMode, CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, TextureDesc, TextureRef,
    TexturesDesc, VertexAttributes, shapes,
};

use crate::harness::TestBackend;

/// Texture coordinates across a square.
const UVS: [[f64; 2]; 4] = [[0.0, 1.0], [2.0, 1.0], [2.0, 0.0], [0.0, 0.0]];

fn images(builder: &mut SceneBuilder) -> [TextureRef; 3] {
    let texels = |of: fn(u32) -> [u8; 4]| (0..16).map(of).collect::<Vec<_>>();
    let colors = texels(|k| [(60 + 12 * k) as u8, 200, (250 - 14 * k) as u8, 255]);
    let bumps = texels(|k| [(100 + 3 * k) as u8, (150 - 3 * k) as u8, 240, 255]);
    let holes = texels(|k| [200, 180, 90, (17 * k) as u8]);
    [
        TextureDesc::srgb8("colours", 4, 4, &colors),
        TextureDesc::linear8("bumps", 4, 4, &bumps),
        TextureDesc::srgb8("holes", 4, 4, &holes),
    ]
    .map(|image| TextureRef::new(builder.texture(image)))
}

/// A floor with a normal map, leaves with holes, balls of plaster, glass and a mirror with vertex normals, a textured light, an
/// environment, and 25 point lights, more than are chosen without a tree. Lengths are `size` times as large and radiances
/// the same. With `gloss` there are a metal and frosted glass, whose kernels take long to compile, instead of plaster and a
/// mirror.
fn scene(size: f64, gloss: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let [colors, bumps, holes] = images(&mut builder);
    let uvs = || VertexAttributes::default().with_uvs(vec![UVS.to_vec()]);
    let quad = |builder: &mut SceneBuilder, corners: [[f64; 3]; 4], material: MaterialDesc| {
        let material = builder.material(material);
        let positions = corners.iter().map(|p| p.map(|x| x * size)).collect();
        builder.mesh_with("quad", positions, vec![[0, 1, 2], [0, 2, 3]], uvs(), material);
    };
    let all = TexturesDesc::default().with_base_color(colors).with_normal(bumps);
    let floor = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    quad(&mut builder, floor, MaterialDesc::lambert("floor", [0.9; 3]).with_textures(all));
    let wall = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.4, -1.0], [-1.0, 1.4, -1.0]];
    let painted = TexturesDesc::default().with_base_color(colors);
    quad(&mut builder, wall, MaterialDesc::lambert("wall", [0.8; 3]).with_textures(painted));
    let covered = TexturesDesc::default().with_base_color(holes).with_alpha(holes);
    for (y, mode) in [(0.5, AlphaMode::Blend), (0.6, AlphaMode::Mask { cutoff: 0.5 })] {
        let leaf = [[-0.6, y, 0.5], [0.1, y, 0.5], [0.1, y, -0.4], [-0.6, y, -0.4]];
        let paint = MaterialDesc::lambert("leaf", [0.9; 3]).with_textures(covered).with_alpha(mode, 1.0);
        quad(&mut builder, leaf, paint);
    }
    let shining = TexturesDesc::default().with_emission(colors);
    let corners = [[0.2, 1.3, -0.3], [0.7, 1.3, -0.3], [0.7, 1.3, 0.3], [0.2, 1.3, 0.3]];
    quad(&mut builder, corners, MaterialDesc::emissive("area light", [0.0; 3], [3.0, 2.5, 2.0]).with_textures(shining));
    let frosted = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [0.9, 1.0, 0.9], roughness: 0.4 };
    let [first, second] = match gloss {
        false => [MaterialDesc::lambert("plaster", [0.8, 0.7, 0.6]), MaterialDesc::mirror("mirror", [0.9; 3])],
        true => [MaterialDesc::metal("metal", [0.9, 0.7, 0.4], 0.5), MaterialDesc::new("frosted", frosted)],
    };
    for (centre, radius, material) in [
        ([0.5, 0.3, 0.3], 0.25, first),
        ([0.45, 0.3, -0.4], 0.25, second),
        ([-0.4, 0.22, 0.3], 0.2, MaterialDesc::glass("glass", 1.5)),
    ] {
        let (positions, triangles) = shapes::icosphere(2, centre, radius);
        let normals = positions.iter().map(|p| [0, 1, 2].map(|axis| p[axis] - centre[axis])).collect();
        let positions = positions.iter().map(|p| p.map(|x| x * size)).collect();
        let material = builder.material(material);
        builder.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), material);
    }
    for k in 0..25 {
        let position = [f64::from(k % 5) * 0.3 - 0.6, 1.1, f64::from(k / 5) * 0.3 - 0.6].map(|x| x * size);
        let intensity = [0.01 * f64::from(1 + k % 4) * size * size; 3];
        builder.light("bulb", LightDesc::Point { position, intensity });
    }
    let sky: Vec<[f32; 3]> = (0..32).map(|k| [0.1 + 0.02 * k as f32, 0.3, 0.6 - 0.015 * k as f32]).collect();
    builder.environment(EnvironmentMap::new(8, &sky, 0.25).unwrap());
    let projection = Projection::Perspective { vertical_fov: 0.9 };
    let position = [0.1, 1.0, 2.4].map(|x| x * size);
    builder.camera("front", CameraDesc::new(position, [-0.05, -0.25, -1.0], [0.0, 1.0, 0.0], projection));
    builder.build().unwrap()
}

fn settings() -> Settings {
    Settings { photons: 3000, caustic_photons: CausticPhotons::Aimed(1500), seed: 6, ..Settings::default() }
}

/// Two passes of a picture on this backend, which keeps what it has compiled.
fn picture<B: TransportBackend>(on: B, scene: &Scene, required: Requirements, seed: u64) -> (Film, B) {
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let settings = Settings { seed, ..settings() };
    let mut renderer = Pipeline::with_requirements(on, &scene.view(), view, settings, required).unwrap();
    for pass in 0..2 {
        renderer.pass(pass, &mut ()).unwrap();
    }
    (renderer.film().unwrap(), renderer.into_backend().unwrap())
}

fn required(scene: &Scene) -> Requirements {
    let required = Requirements::of(&scene.view(), &settings());
    let needed = [
        Features::TEXTURES,
        Features::ALPHA,
        Features::SHADING_NORMALS,
        Features::NORMAL_MAPS,
        Features::TEXTURED_LIGHTS,
        Features::ENVIRONMENT,
        Features::LIGHT_TREE,
    ];
    assert!(needed.into_iter().all(|feature| required.features.contains(feature)), "{:?}", required.features);
    required
}

/// V16: sizes of 2⁻⁶⁰, 2⁶⁰ and 2⁹⁹, and requirements that include all there is, give the same bits; 10^±30, whose coordinates
/// are rounded otherwise, the same mean.
pub fn v16_sizes_and_requirements<T: TestBackend>() {
    let original = scene(1.0, false);
    let derived = required(&original);
    let (expected, mut on) = picture(T::make(2), &original, derived, 6);
    let mean = |film: &Film| film.beauty().iter().flatten().map(|&c| f64::from(c)).sum::<f64>();
    for (size, is_power) in [(-60, true), (60, true), (99, true), (-30, false), (30, false)] {
        let size = if is_power { 2.0_f64.powi(size) } else { 10.0_f64.powi(size) };
        let (found, back) = picture(on, &scene(size, false), derived, 6);
        on = back;
        assert!(!is_power || found.pixels == expected.pixels, "{size:e}");
        let apart = mean(&found) / mean(&expected) - 1.0;
        // Chosen: photons that rounding sends elsewhere; another seed differs by more, below.
        assert!(apart.abs() < 2e-3, "{size:e}: {apart}");
    }
    let (other, on) = picture(on, &original, derived, 7);
    assert!((mean(&other) / mean(&expected) - 1.0).abs() > 2e-3 && other.pixels != expected.pixels);
    let (wider, _) = picture(on, &original, Requirements::everything(&settings()), 6);
    assert!(wider.pixels == expected.pixels);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::OnCpu;
    use crate::harness::trace;
    use photon_core::MapKind;

    /// V16: one, two and seven threads of the CPU find the same photons and pictures, as do sizes of 2^±60 and 2⁹⁹; with gloss
    /// and frosted glass too.
    #[test]
    fn v16_threads() {
        for gloss in [false, true] {
            let scene = |size| scene(size, gloss);
            let original = scene(1.0);
            assert_eq!(required(&original).features.contains(Features::GLOSSY | Features::ROUGH_GLASS), gloss);
            let photons = |threads, scene: &Scene| trace::<OnCpu>(threads, scene, &settings(), &[3000]);
            let pixels = |threads, scene: &Scene| picture(OnCpu::make(threads), scene, required(scene), 6).0.pixels;
            let (traced, seen) = (photons(1, &original), pixels(1, &original));
            assert!(MapKind::ALL.into_iter().map(|kind| traced.0[kind].len()).sum::<usize>() > 1000);
            for (threads, exponent) in [(2, 0), (7, 0), (2, -60), (2, 60), (2, 99)] {
                let scene = scene(2.0_f64.powi(exponent));
                assert!(traced == photons(threads, &scene), "{threads} threads, 2^{exponent}");
                assert!(seen == pixels(threads, &scene), "{threads} threads, 2^{exponent}");
            }
            let other = Settings { seed: 7, ..settings() };
            assert!(traced != trace::<OnCpu>(2, &original, &other, &[3000]), "the comparison can fail");
        }
    }
}
