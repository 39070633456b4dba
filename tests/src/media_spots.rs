//! Spot lights in media: light that is scattered once, against an integral.

use std::f64::consts::FRAC_1_PI;

use photon_core::glam::DVec3;
use photon_core::{Direct, Layer, Settings};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

use crate::harness::{TestBackend, direct_settings};
use crate::media::{Fog, assert_mean, camera, cases, per_pass};

/// Extinction and albedo, length of the view along x, and intensity on the axis.
const EXTINCTION: f64 = 0.1;
const ALBEDO: f64 = 0.5;
const LENGTH: f64 = 10.0;
const INTENSITY: f64 = 100.0;

#[derive(Clone, Copy, Debug)]
struct Spot {
    position: [f64; 3],
    direction: [f64; 3],
    inner_angle: f64,
    outer_angle: f64,
}

/// A spot light beside a view that ends at a black wall.
fn scene(spot: Spot) -> Scene {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("wall", [0.0; 3]));
    let x = LENGTH;
    builder.quad("wall", [[x, -0.3, 0.3], [x, 0.3, 0.3], [x, 0.3, -0.3], [x, -0.3, -0.3]], black);
    let Spot { position, direction, inner_angle, outer_angle } = spot;
    let intensity = [INTENSITY; 3];
    builder.light("spot", LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle });
    camera(&mut builder, [0.0; 3], [1.0, 0.0, 0.0], 1e-6);
    builder.build().unwrap()
}

/// ∫ σ_s I e^(−σ(t+d))/(4πd²) dt by the midpoint rule, with the fall-off of glTF between both angles. In steps of the angle φ
/// seen from the light, dt = d²/h dφ, which are as fine as they have to be beside it.
fn expected(spot: Spot) -> f64 {
    let steps = 1_000_000;
    let axis = DVec3::from(spot.direction).normalize_or_zero();
    let [inner, outer] = [spot.inner_angle, spot.outer_angle].map(f64::cos);
    let [x, y, z] = spot.position;
    let height = y.hypot(z);
    let [start, end] = [0.0, LENGTH].map(|t| ((t - x) / height).atan());
    let sum: f64 = (0..steps)
        .map(|step| {
            let t = x + height * (start + (end - start) * (f64::from(step) + 0.5) / f64::from(steps)).tan();
            let offset = DVec3::new(t, 0.0, 0.0) - DVec3::from(spot.position);
            let (distance, cosine) = (offset.length(), offset.dot(axis) / offset.length());
            let falloff = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
            falloff * (-EXTINCTION * (t + distance)).exp()
        })
        .sum();
    EXTINCTION * ALBEDO * INTENSITY * 0.25 * FRAC_1_PI * sum * (end - start) / (height * f64::from(steps))
}

/// Across the view, narrow and oblique, along the view and against it, from within the cone, wide, and from lights that the view
/// all but meets, of which the height is known to some 10⁻⁴ of it.
pub fn light_of_spots_is_scattered_once<T: TestBackend>() {
    let spot = |position, direction, inner_angle, outer_angle| Spot { position, direction, inner_angle, outer_angle };
    let settings = Settings { shadow_rays: 4, photons: 100, ..direct_settings(Direct::Nee, 0.1) };
    for &spot in cases::<T, _>(&[
        spot([5.0, 1e-3, 0.0], [-1.0, 0.0, 0.0], 0.7, 0.785),
        spot([8.5, 1e-3, 0.0], [1.0, 0.0, 0.0], 0.7, 0.785),
        spot([5.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.3, 0.300_001),
        spot([3.0, 1.0, 0.5], [1.0, -1.0, -0.5], 0.04, 0.05),
        spot([-1.0, 0.5, 0.0], [1.0, 0.0, 0.0], 0.2, 0.25),
        spot([9.0, -0.5, 0.2], [-1.0, 0.0, 0.0], 0.2, 0.25),
        spot([-0.5, 0.01, 0.0], [1.0, 0.0, 0.0], 0.3, 0.4),
        spot([6.0, 0.3, 0.1], [-1.0, -1.0, 0.0], 1.2, 1.4),
        spot([4.0, 1.0, 0.0], [0.3, -1.0, 0.0], 0.1, 0.2),
    ]) {
        let scene = scene(spot);
        let media = Fog::new(EXTINCTION, ALBEDO, 0.0).at(&scene, 0);
        let [found, ..] = per_pass::<T>(&scene, &media, &settings, (16, 8), &[Layer::Direct]);
        let relative = if spot.position[1].abs() < 2e-3 { 1e-3 } else { 1e-4 };
        assert_mean(&format!("{spot:?}"), &found, expected(spot), relative);
    }
}

/// A cone that ends before the view, or points away from it, lights nothing there.
pub fn spots_beside_the_view_are_not_seen<T: TestBackend>() {
    let settings = Settings { photons: 100, ..direct_settings(Direct::Nee, 0.1) };
    for direction in [[0.0, 1.0, 0.0], [1.0, 0.2, 0.0], [0.0, 0.0, 1.0]] {
        let scene = scene(Spot { position: [5.0, 1.0, 0.0], direction, inner_angle: 0.1, outer_angle: 0.15 });
        let media = Fog::new(EXTINCTION, ALBEDO, 0.0).at(&scene, 0);
        let [found, ..] = per_pass::<T>(&scene, &media, &settings, (2, 8), &[Layer::Direct]);
        assert_eq!(found, [0.0; 2], "{direction:?}");
    }
}
