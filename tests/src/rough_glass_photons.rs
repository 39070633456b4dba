//! G6: photons that pass a rough boundary, counted; V1: rough glass around the least width.

use std::f64::consts::{PI, SQRT_2};

use photon_core::{Direct, Settings};
use photon_scene::{CameraDesc, MaterialDesc, Projection, SceneBuilder, Surface, shapes};

use crate::harness::{TestBackend, direct_settings, per_pass, trace};
use crate::stats::{agrees, assert_agrees, moments, standard_error};

/// Half the side of the squares, and their distance from the boundary: 2·10⁻⁴ of the light misses the other square.
const HALF: f64 = 2.0;
const GAP: f64 = 2e-4;

fn horizontal(y: f64, faces_up: bool) -> [[f64; 3]; 4] {
    let corners = [[-HALF, y, HALF], [HALF, y, HALF], [HALF, y, -HALF], [-HALF, y, -HALF]];
    if faces_up { corners } else { [corners[3], corners[2], corners[1], corners[0]] }
}

/// Of a Lambertian light close to a rough boundary of glass of the index 1.5, whose light comes from all directions, the mean
/// shares 0.9382 and 0.9493 arrive behind it, for the widths 0.25 and 1, as an independent program integrates
/// single scattering and what it loses; from inside over 1.5². Tables allow 2.5·10⁻³, gaps 3·10⁻⁴.
pub fn g6_photons_through_a_boundary<T: TestBackend>() {
    for (alpha, share) in [(0.25_f64, 0.9382), (1.0, 0.9493)] {
        for from_inside in [false, true] {
            let mut builder = SceneBuilder::new();
            let surface =
                Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: alpha.sqrt() };
            let glass = builder.material(MaterialDesc::new("glass", surface));
            let (positions, triangles) = shapes::cuboid([-HALF, -0.1, -HALF], [HALF, 0.0, HALF]);
            builder.mesh("glass", positions, triangles, glass);
            let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [1.0 / PI; 3]));
            builder.quad("light", horizontal(if from_inside { -GAP } else { GAP }, from_inside), light);
            // Black but for what makes it a receiver of photons.
            let dark = builder.material(MaterialDesc::lambert("dark", [1e-6; 3]));
            builder.quad("dark", horizontal(if from_inside { GAP } else { -GAP }, !from_inside), dark);
            let scene = builder.build().unwrap();
            let paths = 60_000;
            let settings = Settings { max_bounces: 64, ..direct_settings(Direct::Photons, 0.1) };
            let (photons, _) = trace::<T>(2, &scene, &settings, &[paths]);
            // Each path arrives at most once, with a power p: √((⟨p²⟩ − ⟨p⟩²)/n).
            let powers = photons.iter().flat_map(|(_, photons)| photons).map(|photon| f64::from(photon.power[0]));
            let (sum, squares) = powers.fold((0.0, 0.0), |(sum, squares), p| (sum + p, squares + p * p));
            let n = f64::from(paths);
            let (mean, unit) = (sum / n, scene.units().power / (4.0 * HALF * HALF));
            let (found, error) = (mean * unit, ((squares / n - mean * mean) / n).sqrt() * unit);
            let truth = if from_inside { share / 2.25 } else { share };
            let what = format!("width {alpha}, from inside: {from_inside}");
            assert_agrees(&what, found, truth, error, 2.8e-3);
            assert!(!agrees(found, 0.95 * truth, error, 2.8e-3), "{what}: the noise is small enough to tell: {error}");
        }
    }
}

/// Thin sheets of the index 1.5 on both sides of the least width, and smooth.
pub(crate) fn sheets() -> [(&'static str, MaterialDesc); 3] {
    [("0", 0.0_f64), ("9.99e-4", 9.99e-4), ("1.001e-3", 1.001e-3)].map(|(name, alpha)| {
        (name, MaterialDesc::new("pane", Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness: alpha.sqrt() }))
    })
}

/// V1, camera paths: through a sheet at 45°, of any width around the least one, the edge of a luminous wall is where it is
/// without it, and its light is that of a smooth sheet, `(1 − F)/(1 + F)`, F = 0.0502399.
pub fn v1_seen_through_sheets_around_the_threshold<T: TestBackend>() {
    for (name, material) in sheets() {
        let mut builder = SceneBuilder::new();
        let material = builder.material(material);
        builder.quad("pane", horizontal(0.0, true), material);
        let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [3.0; 3]).with_both_sides(true));
        // Of the plane 0.5 below the pane the camera sees x from .3 to .7.
        builder.quad("wall", [[0.45, -0.5, 1.0], [2.0, -0.5, 1.0], [2.0, -0.5, -1.0], [0.45, -0.5, -1.0]], light);
        let projection = Projection::Orthographic { half_height: 0.2 / SQRT_2 };
        builder.camera("oblique", CameraDesc::new([-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0], projection));
        let scene = builder.build().unwrap();
        let values = per_pass::<T>(&scene, &direct_settings(Direct::Nee, 0.1), 16, 16);
        let face = 0.050_239_9;
        let truth = 3.0 * (1.0 - face) / (1.0 + face) * 0.25 / 0.4;
        // The blur moves the edge by less than .0015 of .4.
        let (found, error) = (moments(&values).0, standard_error(&values));
        assert_agrees(name, found, truth, error, 3.0 * 0.004);
        assert!(!agrees(found, 1.1 * truth, error, 3.0 * 0.004), "the noise is small enough to tell: {error}");
    }
}
