//! Glossy surfaces that camera paths reach through more glass than they may split at.

use photon_core::{EnvironmentMap, Estimator, Indirect, Settings};
use photon_scene::{MaterialDesc, SceneBuilder, Surface};

use crate::harness::{TestBackend, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

/// A red plastic plate behind four thin panes, in an even environment of radiance 1. A pane reflects `R_s = 2R/(1+R)` with
/// `R = .04`; a stack of N reflects the rest of `T = (1 − R_s)/(1 + (N − 1) R_s)`, so that red is 1 and the other channels
/// are `1 − T + T E_s` with the albedo of the coat, E_s = .04 for a smooth one. The choice at the coat must not depend
/// on that at the last pane: a path that always passes it would never be reflected.
pub fn plastic_behind_panes<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let red = Surface::Glossy { base_color: [1.0, 0.0, 0.0], metallic: 0.0, roughness: 0.2, specular: 1.0, ior: 1.5 };
    let plate = builder.material(MaterialDesc::new("plate", red));
    let pane = builder.material(MaterialDesc::thin("pane", 1.5));
    let square = |half: f64, y: f64| [[-half, y, half], [half, y, half], [half, y, -half], [-half, y, -half]];
    builder.quad("plate", square(1.0, 0.0), plate);
    // So small that they hide no light from the plate.
    for k in 0..4 {
        builder.quad("pane", square(1e-3, 0.45 + 0.01 * f64::from(k)), pane);
    }
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 1e-5);
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    let scene = builder.build().unwrap();
    let settings = Settings {
        indirect: Indirect::None,
        photons: 1000,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(0.1) },
        max_bounces: 64,
        ..Settings::default()
    };
    let values = per_pass::<T>(&scene, &settings, 32, 16);
    let sheet = 2.0 * 0.04 / 1.04;
    let through = (1.0 - sheet) / (1.0 + 3.0 * sheet);
    let others = 1.0 - through + through * 0.04;
    // The tables of the coat allow 2.5e-3.
    assert_agrees(
        "plastic behind panes",
        moments(&values).0,
        (1.0 + 2.0 * others) / 3.0,
        standard_error(&values),
        2.5e-3,
    );
}
