//! Thin lenses: the blur of an edge out of focus, and none in focus.

use std::f64::consts::PI;

use photon_core::{Camera, Error, Film, Indirect, Layer, Pipeline, Render, Settings, View};
use photon_scene::{CameraDesc, MaterialDesc, Scene, SceneBuilder, ThinLens};

use crate::harness::TestBackend;
use crate::stats::agrees;

/// Distance of the screen from the camera.
const DISTANCE: f64 = 4.0;
/// Half the width of the picture at the screen.
const HALF: f64 = 2.0;
const SIZE: u32 = 16;

/// A screen across the view with these materials left and right of its middle.
pub(crate) fn halves(materials: [MaterialDesc; 2]) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let [left, right] = materials.map(|material| builder.material(material));
    let z = -DISTANCE;
    for (name, from, to, material) in [("left", -9.0, 0.0, left), ("right", 0.0, 9.0, right)] {
        builder.quad(name, [[from, -9.0, z], [to, -9.0, z], [to, 9.0, z], [from, 9.0, z]], material);
    }
    let fov = 2.0 * (HALF / DISTANCE).atan();
    builder.camera("front", CameraDesc::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], fov));
    builder
}

/// A screen across the view that glows on its left half.
fn screen() -> Scene {
    let bright = MaterialDesc::emissive("bright", [0.5; 3], [1.0; 3]);
    halves([bright, MaterialDesc::lambert("dark", [0.5; 3])]).build().unwrap()
}

fn settings() -> Settings {
    Settings { photons: 100, indirect: Indirect::None, caustics: false, ..Settings::default() }
}

fn picture<T: TestBackend>(camera: Camera, passes: u32) -> Film {
    let view = View { camera, width: SIZE, height: SIZE };
    let mut renderer = Pipeline::new(T::make(2), &screen().view(), view, settings()).unwrap();
    for pass in 0..passes {
        renderer.pass(pass, &mut ()).unwrap();
    }
    renderer.film().unwrap()
}

/// Mean radiance of the screen in each column of pixels.
fn columns(film: &Film) -> Vec<f64> {
    let glow = film.layer(Layer::Emission);
    let mean = |x: u32| (0..SIZE).map(|y| f64::from(glow[(y * SIZE + x) as usize][0])).sum::<f64>() / f64::from(SIZE);
    (0..SIZE).map(mean).collect()
}

/// Antiderivative of the share of a disc of radius 1, whose centre is at t, that lies left of 0:
/// ½ − (t√(1−t²) + asin t)/π.
fn antiderivative(t: f64) -> f64 {
    if t.abs() >= 1.0 {
        return t.min(0.0);
    }
    let height = (1.0 - t * t).sqrt();
    0.5 * t - (t * t.asin() + height - height.powi(3) / 3.0) / PI
}

/// The same mean for a lens of that diameter, whose focus blurs the screen to discs of the diameter
/// `diameter |distance − focus| / focus`.
fn expected(lens: ThinLens) -> Vec<f64> {
    let radius = 0.5 * lens.diameter * (DISTANCE - lens.focus_distance).abs() / lens.focus_distance;
    let width = 2.0 * HALF / f64::from(SIZE);
    let mean = |x: u32| {
        let left = f64::from(x) * width - HALF;
        radius / width * (antiderivative((left + width) / radius) - antiderivative(left / radius))
    };
    (0..SIZE).map(mean).collect()
}

/// Whether each column agrees within the standard error of a share of `samples` rays.
fn agree(found: &[f64], truth: &[f64], samples: f64) -> bool {
    found.iter().zip(truth).all(|(&found, &truth)| {
        let error = (truth * (1.0 - truth)).max(0.0) / samples;
        agrees(found, truth, error.sqrt(), 1e-5)
    })
}

/// An edge beyond and before the plane in focus.
pub fn l1_edge_out_of_focus<T: TestBackend>() {
    let (scene, passes) = (screen(), 128);
    for (diameter, focus_distance) in [(1.0, 2.0), (2.0, 8.0)] {
        let lens = ThinLens::new(diameter, focus_distance);
        let camera = scene.camera_with_lens(None, lens, SIZE, SIZE).unwrap();
        let found = columns(&picture::<T>(camera, passes));
        let samples = f64::from(SIZE * passes);
        let truth = expected(lens);
        assert!(agree(&found, &truth, samples), "focus {focus_distance}: {found:?} instead of {truth:?}");
        // The comparison rejects a lens a quarter larger or smaller, and a sharp edge.
        for factor in [0.75, 1.25] {
            let other = ThinLens::new(factor * lens.diameter, lens.focus_distance);
            assert!(!agree(&found, &expected(other), samples), "{focus_distance} {factor}");
        }
        let sharp: Vec<f64> = (0..SIZE).map(|x| if x < SIZE / 2 { 1.0 } else { 0.0 }).collect();
        assert!(!agree(&found, &sharp, samples));
    }
}

/// What is in focus is as sharp as through a pinhole; a lens without a diameter is a pinhole, to the bit.
pub fn l2_in_focus<T: TestBackend>() {
    let scene = screen();
    let pinhole = picture::<T>(scene.camera(None, SIZE, SIZE).unwrap(), 4);
    let sharp = columns(&pinhole);
    let lens = |diameter| ThinLens::new(diameter, DISTANCE);
    let focused = picture::<T>(scene.camera_with_lens(None, lens(1.0), SIZE, SIZE).unwrap(), 4);
    assert!(agree(&columns(&focused), &sharp, 1.0), "{:?}", columns(&focused));
    assert!((sharp[0] - 1.0).abs() < 1e-6 && sharp[SIZE as usize - 1] == 0.0, "{sharp:?}");
    assert_ne!(focused.depth(), pinhole.depth(), "rays through a lens are longer");
    let closed = picture::<T>(scene.camera_with_lens(None, lens(0.0), SIZE, SIZE).unwrap(), 4);
    assert!(closed == pinhole);
}

/// Records with an invalid lens are refused.
pub fn l3_invalid_lenses<T: TestBackend>() {
    let scene = screen();
    let good = scene.camera(None, SIZE, SIZE).unwrap();
    for (lens_radius, focus_distance, name) in [
        (-0.1, 1.0, "lens_radius"),
        (f32::NAN, 1.0, "lens_radius"),
        (0.1, 0.0, "focus_distance"),
        (0.1, f32::NAN, "focus_distance"),
    ] {
        let camera = Camera { lens_radius, focus_distance, ..good };
        let view = View { camera, width: SIZE, height: SIZE };
        match Pipeline::new(T::make(1), &scene.view(), view, settings()) {
            Err(Error::InvalidSetting { name: found, .. }) => assert_eq!(found, name),
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("{lens_radius} {focus_distance}: accepted"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_expected_edge_is_that_of_many_points() {
        let lens = ThinLens::new(1.0, 2.0);
        let found = expected(lens);
        let (points, width) = (400, 2.0 * HALF / f64::from(SIZE));
        for (x, found) in found.iter().enumerate() {
            let (mut inside, mut left) = (0, 0);
            for k in 0..points * points {
                let unit = |i: usize| (i as f64 + 0.5) / points as f64;
                let (u, v) = (2.0 * unit(k % points) - 1.0, 2.0 * unit(k / points) - 1.0);
                if u * u + v * v < 1.0 {
                    inside += 1;
                    let pixel = (x as f64 + (0.618_034 * k as f64).fract()) * width - HALF;
                    left += usize::from(pixel + 0.5 * u < 0.0);
                }
            }
            assert!((left as f64 / inside as f64 - found).abs() < 2e-3, "{x}: {left} of {inside}, {found}");
        }
    }
}
