//! The paper's formulas show the errors predicted for them; the defaults do not.

use photon_core::{Direct, Estimator, Paper, RandomKind, Settings};
use std::f64::consts::{FRAC_1_PI, PI};

use crate::harness::{TestBackend, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};
use photon_scene::{MaterialDesc, SceneBuilder, shapes};

fn furnace() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [0.5; 3], [FRAC_1_PI; 3]));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, wall);
    look_at_point(&mut builder, [0.1, -1.0, 0.2], [0.0, 1.0, 0.0], 0.2, 0.05);
    builder
}

/// A14: the extra cosine retains two thirds of the incident light. Radiosity is `1 + ρ·(2/3)·H`, with H = 2.
pub fn a14_extra_cosine_loses_a_third<T: TestBackend>() {
    let scene = furnace().build().unwrap();
    let paper = Paper { max: 100_000, radius: Some(0.2), threshold: 0, factor: 1.0, clamp: false };
    for random in [RandomKind::Counter, RandomKind::Lcg] {
        for (estimator, share) in [(Estimator::Paper(paper), 2.0 / 3.0), (Estimator::Radius { radius: Some(0.2) }, 1.0)]
        {
            // The LCG's passes are shifts of one another; only independent passes give a valid standard error.
            if random == RandomKind::Lcg && share == 1.0 {
                continue;
            }
            let settings = Settings {
                photons: 40_000,
                direct: Direct::Photons,
                estimator,
                random,
                alpha: 1.0,
                ..Settings::default()
            };
            let values: Vec<f64> = per_pass::<T>(&scene, &settings, 16, 6).iter().map(|l| l * PI - 1.0).collect();
            let bound = if random == RandomKind::Lcg { 0.05 } else { 0.0 };
            assert_agrees("reflected", moments(&values).0, share, standard_error(&values), bound);
        }
    }
}

/// The final colour is clamped to [0, 1] in the paper's mode only.
pub fn the_clamp_is_the_papers<T: TestBackend>() {
    let mut builder = photon_scene::builtin("cornell").unwrap();
    for material in builder.materials_mut() {
        material.emission = material.emission.map(|e| e * 100.0);
    }
    let scene = builder.build().unwrap();
    let base = Settings { photons: 5000, ..Settings::default() };
    let brightest = |settings: &Settings| {
        let film = crate::harness::film::<T>(&scene, settings, 1, 24);
        film.beauty().into_iter().flatten().fold(0.0_f32, f32::max)
    };
    assert!(brightest(&base) > 1.0);
    let paper = Settings { estimator: Estimator::Paper(Paper::default()), ..base };
    assert_eq!(brightest(&paper), 1.0);
}
