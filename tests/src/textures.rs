//! Textures and vertex colours on surfaces and lights.

use std::f64::consts::PI;
use std::sync::Arc;

use photon_core::{Direct, Film, Filter, Settings, TexelFormat, Texture, Wrap};
use photon_scene::{
    CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, TextureDesc, TextureRef, TexturesDesc,
    VertexAttributes,
};

use crate::harness::{TestBackend, direct_settings, film, look_at_point, means_per_pass, per_pass, trace, watts};
use crate::stats::{assert_agrees, moments, standard_error};

/// Texels of the floor, row by row.
const TEXELS: [u8; 16] = [0, 64, 128, 255, 255, 10, 200, 30, 90, 180, 45, 220, 5, 250, 125, 60];

fn direct_light(direct: Direct) -> Settings {
    direct_settings(direct, 0.02)
}

/// A square of half side 2 at y = 0, seen from above. Between -1 and 1 texture coordinates run from 0 to 1: to the
/// right with x, downwards with z. The camera sees a square of half side `half_height` about `x`.
fn floor(builder: &mut SceneBuilder, textures: TexturesDesc, (x, half_height): (f64, f64)) {
    let material = builder.material(MaterialDesc::lambert("floor", [1.0; 3]).with_textures(textures));
    let positions = vec![[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [2.0, 0.0, 2.0], [-2.0, 0.0, 2.0]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5 * p[2] + 0.5]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("floor", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
    let projection = Projection::Orthographic { half_height };
    let (position, direction, up) = ([x, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]);
    builder.camera("above", CameraDesc::new(position, direction, up, projection));
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
}

fn red(film: &Film) -> Vec<f64> {
    film.beauty().iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// Mean weights of a texel and its neighbours over the area of the texel, with the linear filter.
const BLUR: [f64; 3] = [0.125, 0.75, 0.125];

/// Weights of a texel and its neighbours at a position across the texel, from 0 to 1, with the linear filter.
fn weights(across: f64) -> [f64; 3] {
    [(0.5 - across).max(0.0), 1.0 - (across - 0.5).abs(), (across - 0.5).max(0.0)]
}

/// G8: each pixel of a floor under parallel light is the mean of the texture there: a texel, or with the linear filter
/// `(1, 6, 1)/8` of it and its neighbours in each direction, which wrap around, are mirrored or end at the edge.
pub fn g8_textured_floor<T: TestBackend>() {
    let texels: Vec<[u8; 4]> = TEXELS.iter().map(|&grey| [grey, grey, grey, 255]).collect();
    for (wrap, filter) in [
        (Wrap::Repeat, Filter::Nearest),
        (Wrap::Repeat, Filter::Linear),
        (Wrap::Mirror, Filter::Linear),
        (Wrap::Clamp, Filter::Linear),
    ] {
        let mut builder = SceneBuilder::new();
        let image = TextureDesc::linear8("checks", 4, 4, &texels).wrapped([wrap; 2]).filtered(filter);
        let image = builder.texture(image);
        floor(&mut builder, TexturesDesc::default().with_base_color(TextureRef::new(image)), (0.0, 1.0));
        let scene = builder.build().unwrap();
        let passes = 64;
        let seen = red(&film::<T>(&scene, &direct_light(Direct::Nee), passes, 4));
        let texel = |x: i64, y: i64| {
            let inside = |i: i64| if wrap == Wrap::Repeat { i.rem_euclid(4) } else { i.clamp(0, 3) };
            f64::from(TEXELS[(4 * inside(y) + inside(x)) as usize]) / 255.0
        };
        for (pixel, &found) in seen.iter().enumerate() {
            let (x, y) = ((pixel % 4) as i64, (pixel / 4) as i64);
            if filter == Filter::Nearest {
                assert!((found - texel(x, y)).abs() < 1e-6, "{wrap:?} {pixel}: {found}");
                continue;
            }
            // Mean and variance over a fine grid of points of the pixel.
            let grid = 64;
            let values: Vec<f64> = (0..grid * grid)
                .map(|k| {
                    let [across, down] = [k % grid, k / grid].map(|i| weights((f64::from(i) + 0.5) / f64::from(grid)));
                    let at = |i: usize, j: usize| across[i] * down[j] * texel(x + i as i64 - 1, y + j as i64 - 1);
                    (0..9).map(|k| at(k % 3, k / 3)).sum()
                })
                .collect();
            let (mean, variance) = moments(&values);
            let blurred: f64 =
                (0..9).map(|k| BLUR[k % 3] * BLUR[k / 3] * texel(x + (k % 3) as i64 - 1, y + (k / 3) as i64 - 1)).sum();
            assert!((mean - blurred).abs() < 1e-4, "the grid: {mean} {blurred}");
            // The camera rays of the passes are independent: s/√n.
            let error = (variance / f64::from(passes)).sqrt();
            assert_agrees(&format!("{wrap:?} {pixel}"), found, blurred, error, 1e-6);
        }
    }
}

/// V9: of a texture of 16384² texels, 1 GiB, the last ones in the last rows are found.
pub fn v9_16384_squared<T: TestBackend>() {
    let side = 16_384_u32;
    let mut texels: Arc<[u32]> = std::iter::repeat_n(0x00FF_FFFF, side as usize * side as usize).collect();
    let all = Arc::get_mut(&mut texels).unwrap();
    for (k, &grey) in TEXELS.iter().enumerate() {
        let (x, y) = (side as usize - 4 + k % 4, side as usize - 4 + k / 4);
        all[y * side as usize + x] = u32::from_le_bytes([grey, grey, grey, 255]);
    }
    let image = Texture {
        texels,
        width: side,
        height: side,
        format: TexelFormat::Linear8,
        wrap: [Wrap::Clamp; 2],
        filter: Filter::Nearest,
    };
    let mut builder = SceneBuilder::new();
    let image = TextureRef::new(builder.texture(TextureDesc::new("large", image)));
    let share = 4.0 / f64::from(side);
    let image = image.with_transform([[share, 0.0, 1.0 - share], [0.0, share, 1.0 - share]]);
    floor(&mut builder, TexturesDesc::default().with_base_color(image), (0.0, 1.0));
    let scene = builder.build().unwrap();
    let seen = red(&film::<T>(&scene, &direct_light(Direct::Nee), 2, 4));
    for (found, grey) in seen.into_iter().zip(TEXELS) {
        let truth = f64::from(grey) / 255.0;
        assert!((found - truth).abs() < 1e-6, "{found} instead of {truth}");
    }
}

/// Mean over 16 pixels of each pass.
fn per_pass_rgb<T: TestBackend>(scene: &Scene, settings: &Settings, passes: u32) -> Vec<[f64; 3]> {
    let mean = |beauty: &[[f32; 3]], c: usize| {
        beauty.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / beauty.len() as f64
    };
    let found = means_per_pass::<T>(scene, settings, (passes, 4), |beauty| (0..3).map(|c| mean(beauty, c)).collect());
    (0..passes as usize).map(|pass| [0, 1, 2].map(|c| found[c][pass])).collect()
}

/// The same floor by photons: its colour is that at the visible point, not where photons land.
pub fn g8_textured_floor_by_photons<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::srgb8("halves", 2, 1, &[[255, 188, 0, 255], [0, 188, 255, 255]]).filtered(Filter::Nearest);
    let image = builder.texture(image);
    floor(&mut builder, TexturesDesc::default().with_base_color(TextureRef::new(image)), (-0.5, 0.2));
    let scene = builder.build().unwrap();
    let seen = per_pass_rgb::<T>(&scene, &direct_light(Direct::Photons), 16);
    let half = ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
    for (channel, truth) in [1.0, half, 0.0].into_iter().enumerate() {
        let values: Vec<f64> = seen.iter().map(|pixel| pixel[channel]).collect();
        assert_agrees("by photons", moments(&values).0, truth, standard_error(&values), 1e-6);
    }
}

/// A square light of side 1 at height 1 above the origin, facing down, whose radiance is x on its way from 0 to 1.
fn ramp() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::float32("ramp", 2, 1, &[[0.0, 0.0, 0.0, 1.0], [1.0; 4]]).wrapped([Wrap::Clamp; 2]);
    let image = builder.texture(image);
    let textures = TexturesDesc::default().with_emission(TextureRef::new(image));
    let material = builder.material(MaterialDesc::emissive("light", [0.0; 3], [1.0; 3]).with_textures(textures));
    let positions = vec![[-0.5, 1.0, -0.5], [0.5, 1.0, -0.5], [0.5, 1.0, 0.5], [-0.5, 1.0, 0.5]];
    // From the centre of one texel to that of the other.
    let uvs = positions.iter().map(|p: &[f64; 3]| [0.25 + 0.5 * (p[0] + 0.5), 0.5]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("light", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    builder
}

/// Irradiance from a square of side 1 and radiance 1 at distance 1, on its axis: four quadrants, each seen from below its
/// corner.
fn square_on_axis() -> f64 {
    let (a, s) = (0.5, 1.25_f64.sqrt());
    4.0 * (a / s) * (a / s).atan()
}

/// G13: a light whose radiance is x on the unit square sends out π/2, gives half of the irradiance of an even one on its
/// axis, and shows its ramp to a camera.
pub fn g13_ramp_light<T: TestBackend>() {
    let albedo = 0.5;
    let mut builder = ramp();
    let grey = builder.material(MaterialDesc::lambert("floor", [albedo; 3]));
    builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], grey);
    let mut seen_above = builder.clone();
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.02);
    let scene = builder.build().unwrap();
    let settings = direct_light(Direct::Nee);
    let (_, tally) = trace::<T>(2, &scene, &settings, &[20_000]);
    let power = watts(&scene, &tally, &tally.flux_emitted);
    // One seed: the flux of paths, which is from 0 to 2 times the mean, with a variance of 1/3 of its square.
    let error = (PI / 2.0) / (3.0_f64 * 20_000.0).sqrt();
    assert_agrees("power", power, PI / 2.0, error, 1e-6);
    let truth = albedo / PI * 0.5 * square_on_axis();
    for direct in [Direct::Nee, Direct::Photons] {
        let values = per_pass::<T>(&scene, &direct_settings(direct, 0.05), 64, 4);
        assert_agrees(&format!("{direct:?}"), moments(&values).0, truth, standard_error(&values), 2e-3 * truth);
    }
    let projection = Projection::Orthographic { half_height: 0.5 };
    let (position, direction, up) = ([0.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    seen_above.camera("below", CameraDesc::new(position, direction, up, projection));
    let passes = 64;
    let seen = red(&film::<T>(&seen_above.build().unwrap(), &settings, passes, 4));
    for (pixel, &found) in seen.iter().enumerate() {
        // Uniform over a quarter: a standard deviation of 1/(4√12).
        let error = 0.25 / (12.0 * f64::from(passes)).sqrt();
        assert_agrees("ramp", found, ((pixel % 4) as f64 + 0.5) / 4.0, error, 1e-5);
    }
}

/// The photons of a textured light are as strong as its radiance where they start, in every channel: a light of two
/// colours under which the floor is lit by photons as by shadow rays.
pub fn two_coloured_light<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::srgb8("two", 2, 1, &[[255, 0, 0, 255], [0, 0, 255, 255]]).filtered(Filter::Nearest);
    let image = builder.texture(image);
    let textures = TexturesDesc::default().with_emission(TextureRef::new(image));
    let emissive = MaterialDesc::emissive("light", [0.0; 3], [1.0, 1.0, 1.0]);
    let material = builder.material(emissive.with_both_sides(true).with_textures(textures));
    let positions = vec![[-0.5, 0.4, -0.5], [0.5, 0.4, -0.5], [0.5, 0.4, 0.5], [-0.5, 0.4, 0.5]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [p[0] + 0.5, 0.5]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("light", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    let white = builder.material(MaterialDesc::lambert("floor", [1.0; 3]));
    builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], white);
    look_at_point(&mut builder, [-0.4, 0.0, 0.0], [0.0, 1.0, 0.0], 0.2, 0.02);
    let scene = builder.build().unwrap();
    let by = |direct: Direct| per_pass_rgb::<T>(&scene, &direct_settings(direct, 0.03), 24);
    let (rays, photons) = (by(Direct::Nee), by(Direct::Photons));
    for channel in [0, 2] {
        let [rays, photons] =
            [&rays, &photons].map(|values| values.iter().map(|rgb| rgb[channel]).collect::<Vec<f64>>());
        let error = standard_error(&rays).hypot(standard_error(&photons));
        let truth = moments(&rays).0;
        assert_agrees(&format!("channel {channel}"), moments(&photons).0, truth, error, 3e-3 * truth);
    }
    let mean = |channel: usize| rays.iter().map(|rgb| rgb[channel]).sum::<f64>();
    assert!(mean(0) > 2.0 * mean(2), "the red half is nearer");
}

/// Colours of vertices are interpolated, and multiply those of textures.
pub fn vertex_colours<T: TestBackend>() {
    let scene = |textures: TexturesDesc, mut builder: SceneBuilder| -> Scene {
        let material = builder.material(MaterialDesc::lambert("floor", [0.5; 3]).with_textures(textures));
        let positions = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
        let colors = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 1.0, 0.0, 1.0]).collect();
        let uvs = vec![vec![[0.75, 0.5]; 4]];
        let attributes = VertexAttributes::default().with_colors(colors).with_uvs(uvs);
        builder.mesh_with("floor", positions, vec![[0, 2, 1], [0, 3, 2]], attributes, material);
        let projection = Projection::Orthographic { half_height: 1.0 };
        let (position, direction, up) = ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]);
        builder.camera("above", CameraDesc::new(position, direction, up, projection));
        builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
        builder.build().unwrap()
    };
    for (textured, factor) in [(false, [1.0, 1.0]), (true, [0.2, 0.4])] {
        let mut builder = SceneBuilder::new();
        let image = TextureDesc::linear8("x", 2, 1, &[[0; 4], [51, 102, 255, 255]]).filtered(Filter::Nearest);
        let mut textures = TexturesDesc::default();
        textures.base_color = textured.then(|| TextureRef::new(builder.texture(image)));
        let passes = 64;
        let film = film::<T>(&scene(textures, builder), &direct_light(Direct::Nee), passes, 2);
        for (pixel, color) in film.beauty().iter().enumerate() {
            let truth = 0.5 * factor[0] * (0.25 + 0.5 * (pixel % 2) as f64);
            let error = 0.25 * factor[0] / (12.0 * f64::from(passes)).sqrt();
            assert_agrees("red", f64::from(color[0]), truth, error, 1e-5);
            assert!((f64::from(color[1]) - 0.5 * factor[1]).abs() < 1e-5 && color[2] == 0.0, "{color:?}");
        }
    }
}
