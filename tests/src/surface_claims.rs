//! Claims of error on textured and on glossy surfaces, in pixels whose radiance is known.

use std::f64::consts::PI;

use photon_core::random::SplitMix64;
use photon_core::{Direct, EnvironmentMap, Filter, Settings};
use photon_scene::{
    LightDesc, MaterialDesc, SceneBuilder, Surface, TextureDesc, TextureRef, TexturesDesc, VertexAttributes,
};

use crate::harness::{TestBackend, direct_settings, film, look_at_point};

/// Half the side of the floor; pixels along a side of a picture of its middle, 2 × 2 texels each.
const HALF: f64 = 0.6;
const SIDE: u32 = 16;
/// Half the side of what the camera sees, and texels along a side of the floor.
const SEEN: f64 = 0.4;
const TEXELS: u32 = 48;
const RADIUS: f64 = 0.02;

/// Random bytes from `least` to 255, a texture of the floor.
fn texels(least: u8, seed: u64) -> Vec<u8> {
    let mut numbers = SplitMix64(seed);
    let span = 256 - u64::from(least);
    (0..TEXELS * TEXELS).map(|_| least + (numbers.word() % span) as u8).collect()
}

/// A floor at y = 0 with a texture from its corner at (−, −), along x and then along z, seen along `normal`.
fn floor(
    material: MaterialDesc,
    bytes: &[u8],
    used: impl Fn(TextureRef) -> TexturesDesc,
    normal: [f64; 3],
) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let image: Vec<[u8; 4]> = bytes.iter().map(|&grey| [grey, grey, grey, 255]).collect();
    let image = TextureDesc::linear8("noise", TEXELS, TEXELS, &image).filtered(Filter::Nearest);
    let image = builder.texture(image);
    let material = builder.material(material.with_textures(used(TextureRef::new(image))));
    let positions = vec![[-HALF, 0.0, -HALF], [HALF, 0.0, -HALF], [HALF, 0.0, HALF], [-HALF, 0.0, HALF]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [p[0], p[2]].map(|x| 0.5 * x / HALF + 0.5)).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("floor", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
    look_at_point(&mut builder, [0.0; 3], normal, 1.0, SEEN);
    builder
}

/// Renders films with several seeds, and checks that at least 98 % of the pixels have an interval and at least 93 % of these
/// contain the truth. Intervals that were far too wide would also contain 1.2 times the truth: at most 85 % may, which is
/// eight standard errors, √(.93·.07/768), less than 93 %.
fn check<T: TestBackend>(name: &str, builder: &SceneBuilder, settings: &Settings, truth: impl Fn(usize) -> f64) {
    let scene = builder.clone().build().unwrap();
    let (mut pixels, mut claimed, mut covered, mut wrong) = (0, 0, 0, 0);
    for seed in 1..=3 {
        let settings = Settings { errors: true, seed, ..settings.clone() };
        let intervals = film::<T>(&scene, &settings, 24, SIDE).confidence_intervals().unwrap();
        for (pixel, interval) in intervals.iter().enumerate() {
            pixels += 1;
            if interval.flags.is_empty() {
                let holds = |truth: f64| usize::from((interval.value - truth).abs() <= interval.half_width);
                claimed += 1;
                covered += holds(truth(pixel));
                wrong += holds(1.2 * truth(pixel));
            }
        }
    }
    let what = format!("{name}: {claimed} of {pixels} claimed, {covered} covered, {wrong} with a wrong truth");
    eprintln!("{what}");
    assert!(claimed * 100 >= pixels * 98 && covered * 100 >= claimed * 93 && wrong * 100 <= claimed * 85, "{what}");
}

/// On a floor whose texture has several texels in each pixel, under parallel light of irradiance π that photons or shadow rays
/// bring: each pixel has the mean albedo of its four texels.
pub fn claims_hold_on_textures<T: TestBackend>() {
    let bytes = texels(40, 1);
    let textures = |used| TexturesDesc::default().with_base_color(used);
    let mut builder = floor(MaterialDesc::lambert("floor", [1.0; 3]), &bytes, textures, [0.0, 1.0, 0.0]);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
    // The picture's columns run towards −x, and its rows towards −z.
    let margin = (TEXELS - 2 * SIDE) / 2;
    let truth = |pixel: usize| {
        let (column, row) = (SIDE - 1 - pixel as u32 % SIDE, SIDE - 1 - pixel as u32 / SIDE);
        let (x, z) = (margin + 2 * column, margin + 2 * row);
        let at = |x: u32, z: u32| f64::from(bytes[(z * TEXELS + x) as usize]) / 255.0;
        (at(x, z) + at(x + 1, z) + at(x, z + 1) + at(x + 1, z + 1)) / 4.0
    };
    for direct in [Direct::Photons, Direct::Nee] {
        check::<T>(&format!("textures, {direct:?}"), &builder, &direct_settings(direct, RADIUS), truth);
    }
}

/// On a white metal floor of random roughness, 0.4 to 1 by texels, seen obliquely under an even sky of radiance 1: each pixel
/// has radiance 1, within the 2.5e-3 of the tables.
pub fn claims_hold_on_glossy_surfaces<T: TestBackend>() {
    let bytes = texels(102, 2);
    let textures = |used| TexturesDesc::default().with_metallic_roughness(used);
    let metal = Surface::Glossy { base_color: [1.0; 3], metallic: 1.0, roughness: 1.0, specular: 1.0, ior: 1.5 };
    let mut builder = floor(MaterialDesc::new("metal", metal), &bytes, textures, [0.0, 0.8, 0.6]);
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    for direct in [Direct::Photons, Direct::Nee] {
        check::<T>(&format!("gloss, {direct:?}"), &builder, &direct_settings(direct, RADIUS), |_| 1.0);
    }
}
