//! V6, V13: lights of which a small part is very bright: claims of a picture, and power.

use std::f64::consts::PI;

use photon_core::{ConfidenceInterval, Direct, EnvironmentMap, Flags, Settings, Wrap};
use photon_scene::{MaterialDesc, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes};

use crate::harness::{TestBackend, direct_settings, film, look_at_point, per_pass, trace, watts};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

const BRIGHT: f32 = 1e6;
const DIM: f32 = 1e-3;

/// A square light of side 1, at height 1 above a grey floor, of `side`² texels, one of them 10⁹ times as bright as the rest; and
/// the radiance of the floor below its centre, by a quadrature over the linear filter.
fn lit_by_one_texel(side: usize) -> (photon_scene::Scene, f64) {
    let mut texels = vec![[DIM, DIM, DIM, 1.0]; side * side];
    let (column, row) = (side / 4, side / 2);
    texels[row * side + column] = [BRIGHT, BRIGHT, BRIGHT, 1.0];
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::float32("spark", side as u32, side as u32, &texels).wrapped([Wrap::Clamp; 2]);
    let image = builder.texture(image);
    let textures = TexturesDesc::default().with_emission(TextureRef::new(image));
    let material = builder.material(MaterialDesc::emissive("light", [0.0; 3], [1.0; 3]).with_textures(textures));
    let positions = vec![[-0.5, 1.0, -0.5], [0.5, 1.0, -0.5], [0.5, 1.0, 0.5], [-0.5, 1.0, 0.5]];
    let uvs = positions.iter().map(|p: &[f64; 3]| [p[0] + 0.5, p[2] + 0.5]).collect();
    let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
    builder.mesh_with("light", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
    builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], grey);
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.02);
    let n = 40 * side;
    let sum: f64 = (0..n * n)
        .map(|k| {
            let at = [k % n, k / n].map(|i| (i as f64 + 0.5) / n as f64);
            let near = |at: f64, centre: usize| (1.0 - (at * side as f64 - centre as f64 - 0.5).abs()).max(0.0);
            let share = near(at[0], column) * near(at[1], row);
            let squared = (at[0] - 0.5).powi(2) + (at[1] - 0.5).powi(2) + 1.0;
            (f64::from(DIM) + share * f64::from(BRIGHT - DIM)) / (squared * squared)
        })
        .sum();
    (builder.build().unwrap(), 0.5 / PI * sum / (n * n) as f64)
}

/// V6: under a light that is a bright texel in the dark, claims hold or are [`Flags::RARE`] wherever the bright part was found.
/// Of 4² texels the linear filter lights a quarter, which most passes find, and 93 % of the intervals hold, less 4.5 standard errors. Of 16² texels it
/// lights p = 1/32 of the brighter triangle, which four of 128 shadow rays of a pixel find, and most pixels are flagged. A
/// pixel whose rays all missed it, `(1 − p)¹²⁸` of them, cannot know of it: that is the known limit of all claims.
pub fn v6_claims_under_a_bright_texel<T: TestBackend>() {
    let (passes, size) = (64, 16);
    for (side, claims) in [(4, 0.5..=1.0), (16, 0.0..=0.2)] {
        let (scene, truth) = lit_by_one_texel(side);
        let settings = Settings { errors: true, photons: 100, ..direct_settings(Direct::Nee, 0.05) };
        let intervals = film::<T>(&scene, &settings, passes, size).confidence_intervals().unwrap();
        let (found, missed): (Vec<ConfidenceInterval>, Vec<ConfidenceInterval>) =
            intervals.iter().partition(|interval| interval.value > 1e-6 * truth);
        let claimed: Vec<_> = found.iter().filter(|interval| interval.flags.is_empty()).collect();
        let held = claimed.iter().filter(|interval| (interval.value - truth).abs() <= interval.half_width).count();
        let what = format!("{side}: {held} of {} of {} of {}", claimed.len(), found.len(), intervals.len());
        // Of n intervals that hold with a probability of .95: √(.95 · .05/n).
        let share = held as f64 / claimed.len().max(1) as f64;
        assert!(claimed.is_empty() || share > 0.93 - 4.5 * (0.95 * 0.05 / claimed.len() as f64).powf(0.5), "{what}");
        assert!(claims.contains(&(claimed.len() as f64 / found.len() as f64)), "{what}");
        assert!(found.iter().all(|interval| (interval.flags - Flags::RARE).is_empty()), "{what}");
        // Two rays a pass; at 4² the part of the brighter triangle is larger still.
        let part = 8.0 / (side * side) as f64;
        let (all, unlucky) = (intervals.len() as f64, (1.0 - part).powi(2 * passes as i32));
        let error = (unlucky * (1.0 - unlucky) / all).sqrt().max(1.0 / all);
        assert_agrees(&what, missed.len() as f64 / all, unlucky, error, 0.0);
        // The mean of all pixels is the truth all the same.
        let values: Vec<f64> = intervals.iter().map(|interval| interval.value).collect();
        assert_agrees("the mean", moments(&values).0, truth, standard_error(&values), 1e-3 * truth);
        assert!(!agrees(moments(&values).0, 2.0 * truth, standard_error(&values), 0.0));
    }
}

/// ∫ L g(θ) dω of a map whose radiance is linear in θ between the centres of 32 rows, of which only the first is not black.
fn over_the_pole(scale: f64, factor: impl Fn(f64) -> f64) -> f64 {
    let step = PI / 32.0;
    let n = 20_000;
    let at = |k: i32| 1.5 * step * (f64::from(k) + 0.5) / f64::from(n);
    let radiance = |theta: f64| scale * (1.5 - theta / step).min(1.0);
    let sum: f64 = (0..n).map(|k| radiance(at(k)) * factor(at(k)) * at(k).sin()).sum();
    sum * 2.0 * PI * 1.5 * step / f64::from(n)
}

/// V13: of a map of the pole's row alone, times 10^±30 or 1, the power through the sphere of radius R around the scene is
/// `π R² ∫ L dω`, as stated by the lights' records and as carried by photons; and a plate shows `ρ/π ∫ L cos θ dω`, by shadow
/// rays and, where their power is that of an odd scale, by photons.
pub fn v13_power_of_odd_environments<T: TestBackend>() {
    for scale in [1.0_f32, 1e-30, 1e30] {
        let mut texels = vec![[0.0; 3]; 64 * 32];
        texels[..64].fill([scale; 3]);
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("plate", [0.5; 3]));
        builder.quad("plate", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], grey);
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.1);
        builder.environment(EnvironmentMap::new(64, &texels, 0.7).unwrap());
        let scene = builder.build().unwrap();
        let radius = f64::from(scene.view().radius) * scene.units().scale;
        let truth = PI * radius * radius * over_the_pole(f64::from(scale), |_| 1.0);
        let stated = f64::from(scene.view().lights[0].power[0]) * scene.units().power;
        // Squares of a radius in single precision.
        assert!((stated / truth - 1.0).abs() < 1e-6, "{scale:e}: {stated:e} {truth:e}");
        // Weights of photons are from 0 to 2 times the mean, as radiance within a row of cells is: a variance of at most
        // 1/3, as in `textures::g13_ramp_light`.
        let paths = 8000;
        let (_, tally) = trace::<T>(2, &scene, &direct_settings(Direct::Photons, 0.1), &[paths]);
        let (found, error) =
            (watts(&scene, &tally, &tally.flux_emitted) / truth, 1.0 / (3.0 * f64::from(paths)).sqrt());
        assert_agrees(&format!("{scale:e}, photons"), found, 1.0, error, 1e-4);
        assert!(!agrees(found, 1.1, error, 1e-4), "the noise is small enough to tell: {error}");
        let shown = 0.5 / PI * over_the_pole(f64::from(scale), f64::cos);
        for direct in if scale < 1.0 { vec![Direct::Nee, Direct::Photons] } else { vec![Direct::Nee] } {
            let values = per_pass::<T>(&scene, &direct_settings(direct, 0.1), 16, 8);
            let (found, error) = (moments(&values).0 / shown, standard_error(&values) / shown);
            assert_agrees(&format!("{scale:e}, {direct:?}"), found, 1.0, error, 2e-4);
            assert!(!agrees(found, 1.2, error, 2e-4), "the noise is small enough to tell: {error}");
        }
    }
}
