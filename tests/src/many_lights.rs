//! Scenes with so many lights that shadow rays choose among them by a light tree.

use std::f64::consts::PI;

use photon_core::Features;
use photon_scene::{LightDesc, SceneBuilder};

use crate::direct::{floor, irradiance};
use crate::harness::{TestBackend, Uniform};
use crate::stats::assert_agrees;

/// Irradiance of the floor at (x, 0, 0) from a point light.
fn from_point(x: f64, position: [f64; 3], intensity: f64) -> f64 {
    let [px, height, pz] = position;
    let squared = (px - x).powi(2) + height * height + pz * pz;
    intensity * height / (squared * squared.sqrt())
}

fn with_points(lights: &[([f64; 3], f64)]) -> SceneBuilder {
    let mut builder = floor();
    for &(position, intensity) in lights {
        builder.light("point", LightDesc::Point { position, intensity: [intensity; 3] });
    }
    builder
}

/// G14: 32² point lights above a floor. The mean of n shadow rays is the sum over the lights, with a standard error of
/// `√Σs²/n` over pixels; `n` times its square, the variance of one shadow ray, is at most that of lights chosen by power,
/// `Σ v²/p − (Σ v)²`.
pub fn g14_grid_of_point_lights<T: TestBackend>() {
    let place = |i: u32| (f64::from(i) + 0.5) / 8.0 - 2.0;
    let lights: Vec<_> = (0..1024).map(|i| ([place(i % 32), 0.5, place(i / 32)], 1.0)).collect();
    let samples = 16.0 * 64.0;
    for x in [0.0, 1.1, 3.0] {
        let values: Vec<f64> = lights.iter().map(|&(position, intensity)| from_point(x, position, intensity)).collect();
        let sum: f64 = values.iter().sum();
        let by_power = values.iter().map(|value| value * value * 1024.0).sum::<f64>() - sum * sum;
        let (found, error) = irradiance::<T>(with_points(&lights), x, 1);
        assert_agrees("grid of lights", found, sum, error, 3e-5 * sum);
        let variance = error * error * samples;
        assert!(variance <= by_power, "x = {x}: variance {variance}, by power {by_power}");
    }
}

/// V14: 10⁵ point lights with powers from 1 to 10²⁰, a third of them in one place and a third at distances that halve. The
/// mean is the sum over the lights; the standard error is `√Σs²/n` over pixels.
pub fn v14_powers_apart_and_coincident_lights<T: TestBackend>() {
    let mut uniform = Uniform::new(14);
    let light = |index: i32| {
        let intensity = 1e-20_f64.powf(uniform.draw());
        let position = match index % 3 {
            0 => [0.5, 1.0, 0.5],
            1 => [3.0 * 0.5_f64.powi(index % 40), 0.7, 0.0],
            _ => [6.0 * uniform.draw() - 3.0, 0.5 + uniform.draw(), 6.0 * uniform.draw() - 3.0],
        };
        (position, intensity)
    };
    let lights: Vec<_> = (0..100_000).map(light).collect();
    let sum: f64 = lights.iter().map(|&(position, intensity)| from_point(0.2, position, intensity)).sum();
    let (found, error) = irradiance::<T>(with_points(&lights), 0.2, 4);
    assert_agrees("extreme lights", found, sum, error, 3e-5 * sum);
    assert!(error < 0.05 * sum, "{error} of {sum}");
}

/// A light at infinity among many lights nearby: a sun of irradiance 1 and 100 point lights of intensity 1.
pub fn sun_among_many_lights<T: TestBackend>() {
    let place = |i: u32| (f64::from(i) + 0.5) / 2.0 - 2.5;
    let lights: Vec<_> = (0..100).map(|i| ([place(i % 10), 2.0, place(i / 10)], 0.02)).collect();
    let mut builder = with_points(&lights);
    let direction = [0.6, -0.8, 0.0];
    builder.light("sun", LightDesc::Directional { direction, irradiance: [1.0; 3] });
    let scene = builder.clone().build().unwrap();
    assert!(Features::of(&scene.view()).contains(Features::LIGHT_TREE));
    let sum: f64 = lights.iter().map(|&(position, intensity)| from_point(0.0, position, intensity)).sum::<f64>() + 0.8;
    let (found, error) = irradiance::<T>(builder, 0.0, 4);
    assert_agrees("sun among lights", found, sum, error, 3e-5 * sum);
    assert!(error < 0.02 * sum && scene.units().power > PI, "{error} of {sum}");
}
