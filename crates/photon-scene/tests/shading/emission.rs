//! Textured area lights: power by the integral of the texture.

use std::f64::consts::PI;

use photon_core::{Filter, Wrap};
use photon_scene::{MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef};

use crate::{UVS, built, with_uvs};

const CLAMP: [Wrap; 2] = [Wrap::Clamp; 2];

fn area_light(image: TextureDesc, uvs: [[f64; 2]; 4], radiance: [f64; 3]) -> Scene {
    let mut builder = SceneBuilder::new();
    let image = builder.texture(image);
    let mut material = MaterialDesc::emissive("screen", [0.0; 3], radiance);
    material.textures.emission = Some(TextureRef::new(image));
    built(builder, with_uvs(uvs), material)
}

/// Watts of each light, red.
fn watts(scene: &Scene) -> Vec<f64> {
    let view = scene.view();
    view.lights.iter().map(|light| f64::from(light.power[0]) * view.units.power).collect()
}

/// G13: a ramp e = x on the unit square emits π/2; its halves along the diagonal π/3 and π/6.
#[test]
fn a_ramp_has_the_power_of_its_integral() {
    for width in [4_u32, 64, 1000] {
        let ramp: Vec<[f32; 4]> = (0..width).map(|x| [(x as f32 + 0.5) / width as f32, 0.0, 0.0, 1.0]).collect();
        let scene = area_light(TextureDesc::float32("ramp", width, 1, &ramp).wrapped(CLAMP), UVS, [3.0; 3]);
        let found = watts(&scene);
        // Half a texel at each edge is constant instead of linear: h²/2 of an integral of 1/6 or 1/3, h = 1/(2 width).
        let width = f64::from(width);
        for (watts, expected) in found.iter().zip([PI, 0.5 * PI]) {
            assert!((watts / expected - 1.0).abs() < 1e-3 + 0.75 / width / width, "{width}: {found:?}");
        }
        assert!((found.iter().sum::<f64>() / (1.5 * PI) - 1.0).abs() < 1e-3, "{width}: {found:?}");
        assert!((f64::from(scene.view().materials[0].emission[0]) * scene.units().power - 3.0).abs() < 1e-4);
    }
}

/// V6: one very bright texel among dim ones, within a triangle, on the edge between both, and at a corner of the image, which
/// is repeated: the power of the light, `π (b + 10⁻³ (n − 1))/n` for n texels of which one has the radiance b. Points of the
/// quadrature are aligned with texels, so that its errors cancel.
#[test]
fn one_bright_texel_counts() {
    for bright in [1e6_f32, 1e20] {
        for [x, y] in [[200, 100], [100, 155], [100, 100], [0, 0], [255, 3]] {
            let mut texels = vec![[1e-3_f32; 4]; 256 * 256];
            texels[y * 256 + x] = [bright; 4];
            let scene = area_light(TextureDesc::float32("spark", 256, 256, &texels), UVS, [1.0; 3]);
            let expected = PI * (f64::from(bright) + 1e-3 * 65_535.0) / 65_536.0;
            let sum: f64 = watts(&scene).iter().sum();
            // Powers of triangles have 24 bits.
            assert!((sum / expected - 1.0).abs() < 1e-6, "{bright} at {x}, {y}: {sum} for {expected}");
        }
    }
}

/// V6: where coordinates are turned by 30°, parts are not aligned with texels, and the power of a bright texel within a
/// triangle is less exact.
#[test]
fn a_bright_texel_between_the_points_of_the_quadrature() {
    let mut texels = vec![[0.0_f32; 4]; 256 * 256];
    texels[150 * 256 + 128] = [1e6; 4];
    let (sin, cos) = (PI / 6.0).sin_cos();
    let side = 0.7;
    let turned = UVS.map(|[u, v]| {
        let (x, y) = (side * (u - 0.5), side * (v - 0.5));
        [0.5 + cos * x - sin * y, 0.5 + sin * x + cos * y]
    });
    let sum: f64 = watts(&area_light(TextureDesc::float32("spark", 256, 256, &texels), turned, [1.0; 3])).iter().sum();
    let expected = PI * 1e6 / (65_536.0 * side * side);
    let apart = (sum / expected - 1.0).abs();
    assert!(apart < 5e-4, "{apart}");
    // A known limit: with a better quadrature, the documentation has to say so.
    assert!(apart > 5e-5, "{apart}");
}

#[test]
fn where_the_texture_is_black_is_no_light() {
    // The left half is black; the second triangle has its right corner in the bright half.
    let mut texels = [[0_u8, 0, 0, 255]; 16];
    for (index, texel) in texels.iter_mut().enumerate() {
        *texel = if index % 4 >= 2 { [255; 4] } else { *texel };
    }
    let image = || TextureDesc::srgb8("half", 4, 4, &texels).wrapped(CLAMP);
    assert_eq!(area_light(image(), UVS, [1.0; 3]).view().lights.len(), 2);
    for filter in [Filter::Linear, Filter::Nearest] {
        // The outer quarter of the texture does not touch the bright texels, filtered or not.
        let left = UVS.map(|[u, v]| [0.3 * u, v]);
        assert!(area_light(image().filtered(filter), left, [1.0; 3]).view().lights.is_empty(), "{filter:?}");
    }
    // Between the centres of the second and the third column the filter brightens black texels.
    let middle = UVS.map(|[u, v]| [0.374 + 0.002 * u, v]);
    assert_eq!(area_light(image(), middle, [1.0; 3]).view().lights.len(), 2);
    assert!(area_light(image().filtered(Filter::Nearest), middle, [1.0; 3]).view().lights.is_empty());
}

/// A lone bright texel under the tip of a triangle, between the evaluated points, is a light with some power.
#[test]
fn a_tip_in_a_bright_texel_is_a_light() {
    let mut texels = vec![[0_u8, 0, 0, 255]; 64 * 64];
    texels[63] = [255; 4];
    let image = TextureDesc::srgb8("dot", 64, 64, &texels).wrapped(CLAMP).filtered(Filter::Nearest);
    let tip = 63.0 / 64.0 + 1e-6;
    // The second triangle's corner reaches the texel in the upper right by a millionth of the texture.
    let uvs = [[0.0, 1.0], [0.0, 1.0], [0.2, 0.9], [tip, 1.0 / 64.0 - 1e-6]];
    let scene = area_light(image, uvs, [1.0; 3]);
    let lights = scene.view().lights;
    assert!(lights.len() == 1 && lights[0].primitive == 1 && watts(&scene)[0] > 0.0, "{lights:?}");
}

/// Repetitions beyond count give the mean, and extreme coordinates an answer.
#[test]
fn many_repetitions_have_the_mean_power() {
    let image = || TextureDesc::linear8("stripes", 2, 1, &[[255, 255, 255, 255], [0, 0, 0, 255]]);
    for far in [1.0, 100.0, 12_345.0, 1e9] {
        let scene = area_light(image(), UVS.map(|[u, v]| [u * far, v * far]), [1.0; 3]);
        let sum: f64 = watts(&scene).iter().sum();
        assert!((sum / (0.5 * PI) - 1.0).abs() < 5e-3, "{far}: {sum}");
    }
    for far in [1e30, 1e300, f64::NAN, f64::INFINITY] {
        let scene = area_light(image(), UVS.map(|[u, v]| [u * far, v * far]), [1.0; 3]);
        assert!(watts(&scene).iter().all(|watts| watts.is_finite()));
    }
}

/// A texture too large to be decoded as a whole has the same power.
#[test]
fn large_textures_are_reduced_first() {
    let mut texels = vec![[0_u8; 4]; 4096 * 2048];
    texels.iter_mut().skip(1).step_by(2).for_each(|texel| *texel = [255; 4]);
    let sum: f64 = watts(&area_light(TextureDesc::linear8("large", 4096, 2048, &texels), UVS, [1.0; 3])).iter().sum();
    assert!((sum / (0.5 * PI) - 1.0).abs() < 1e-3, "{sum}");
}
