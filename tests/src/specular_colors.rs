//! Specular colours of coats: each channel looks as if all had its factor.

use photon_core::{Direct, Filter};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, TextureDesc, TextureRef, TexturesDesc};

use crate::harness::{TestBackend, direct_settings, film};
use crate::stripes;

/// sRGB of byte 188.
const HALF: f64 = 0.502_886_458_032_568_5;

/// Coats without a base, and mixtures with black metal.
fn coat(metallic: f64, specular_color: [f64; 3]) -> MaterialDesc {
    let surface = Surface::Glossy { base_color: [0.0; 3], metallic, roughness: 0.45, specular: 0.8, ior: 1.9 };
    MaterialDesc::new("coat", surface).with_specular_color(specular_color)
}

/// Eight stripes at y = 0 under a sun, one for each column of pixels. The texture of the first two times a factor of 2 gives
/// the colours (2, 2 HALF, 0) and (2 HALF, 2, 2 HALF); grey ones follow. With a pane, only photons find the sun.
fn scene(pane: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::srgb8("colours", 2, 1, &[[255, 188, 0, 255], [188, 255, 188, 0]]);
    let image = TextureRef::new(builder.texture(image.filtered(Filter::Nearest)));
    let textured = TexturesDesc::default().with_specular_color(image);
    let grey = |metallic: f64, factor: f64| coat(metallic, [2.0 * factor; 3]);
    let descs = [
        (2, coat(0.0, [2.0; 3]).with_textures(textured)),
        (1, grey(0.0, 1.0)),
        (1, grey(0.0, HALF)),
        // A black coat is no grey one, which has a refractive index.
        (1, grey(0.0, 1e-9)),
        (1, coat(0.4, [2.0, 2.0 * HALF, 0.0])),
        (1, grey(0.4, 1.0)),
        (1, grey(0.4, HALF)),
    ];
    stripes::add(&mut builder, descs, pane);
    builder.light("sun", LightDesc::Directional { direction: [0.2, -1.0, 0.3], irradiance: [2.0; 3] });
    builder.build().unwrap()
}

/// The mean of each column.
fn columns<T: TestBackend>(scene: &Scene, passes: u32) -> [[f64; 3]; 8] {
    let beauty = film::<T>(scene, &direct_settings(Direct::Nee, 0.15), passes, 8).beauty();
    let mut columns = [[0.0; 3]; 8];
    for (k, pixel) in beauty.iter().enumerate() {
        (0..3).for_each(|c| columns[k % 8][c] += f64::from(pixel[c]) / 8.0);
    }
    columns
}

/// A textured specular colour, by shadow rays and in caustics that only photons find.
pub fn channels_are_grey_coats<T: TestBackend>() {
    let close = |what: &str, found: f64, expected: f64, allowed: f64| {
        assert!((found / expected - 1.0).abs() < allowed, "{what}: {found}, {expected}");
    };
    let [first, second, white, half, black, mixture, mixed_white, mixed_half] = columns::<T>(&scene(false), 1);
    for (found, expected) in [(first, [white, half, black]), (second, [half, white, half])] {
        (0..3).for_each(|c| close("a texture", found[c], expected[c][0], 1e-4));
    }
    close("a mixture, red", mixture[0], mixed_white[0], 1e-4);
    close("a mixture, green", mixture[1], mixed_half[1], 1e-4);
    assert!(white[0] > 1.5 * half[0] && half[0] > 1.5 * black[0] && mixed_white[0] > 1.2 * mixed_half[0], "{white:?}");

    // The same photons in all channels; their colours have steps of 1/255.
    let [first, second, ..] = columns::<T>(&scene(true), 2);
    close("photons, green", first[1] / first[0], half[0] / white[0], 5e-3);
    close("photons, blue", first[2] / first[0], black[0] / white[0], 5e-3);
    close("photons, red of the second", second[0] / second[1], half[0] / white[0], 5e-3);
}
