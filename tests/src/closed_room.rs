//! G5: a closed room whose walls emit e = 1 and reflect ρ = ½: radiosity is e/(1 − ρ) = 2 everywhere, and what absorbs nothing
//! changes nothing.

use std::f64::consts::PI;

use photon_core::{Direct, Estimator, Indirect, Settings};
use photon_scene::{MaterialDesc, SceneBuilder, shapes};

use crate::harness::{TestBackend, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

/// A horizontal square in the room, which is the cube from −1 to 1: its height, half its side, its material.
pub(crate) type Square = (f64, f64, MaterialDesc);

/// Checks the radiosity at the middle of the room, seen from `direction` at this distance, by shadow rays, photons and final
/// gathering. `bound` is the error of radiosity that the squares' own tables may cause; gathering has a larger one.
pub(crate) fn assert_unchanged<T: TestBackend>(
    squares: impl IntoIterator<Item = Square>,
    view: ([f64; 3], f64),
    bound: f64,
) {
    assert_unchanged_with::<T>(squares, view, bound, None);
}

/// The same with this [`Settings::caustic_roughness`].
pub(crate) fn assert_unchanged_with<T: TestBackend>(
    squares: impl IntoIterator<Item = Square>,
    (direction, distance): ([f64; 3], f64),
    bound: f64,
    caustic_roughness: Option<f32>,
) {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [0.5; 3], [1.0 / PI; 3]));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, wall);
    for (y, half, material) in squares {
        let material = builder.material(material);
        builder.quad("square", [[-half, y, half], [half, y, half], [half, y, -half], [-half, y, -half]], material);
    }
    look_at_point(&mut builder, [0.0; 3], direction, distance, 0.2);
    let scene = builder.build().unwrap();
    let settings = || Settings {
        photons: 10_000,
        max_bounces: 4096,
        alpha: 1.0,
        caustic_roughness,
        estimator: Estimator::Radius { radius: Some(0.15) },
        ..Settings::default()
    };
    for (way, settings) in [
        ("shadow rays", settings()),
        ("photons", Settings { direct: Direct::Photons, ..settings() }),
        ("gather", Settings { indirect: Indirect::Gather, gather_rays: 4, ..settings() }),
    ] {
        let values: Vec<f64> = per_pass::<T>(&scene, &settings, 16, 8).iter().map(|l| l * PI).collect();
        // Gathered light comes from edges too, where estimates lose area (A8): of the walls' light, and of one part in
        // five of it.
        let bound = if way == "gather" { 0.08 } else { bound };
        assert_agrees(way, moments(&values).0, 2.0, standard_error(&values), bound);
    }
}
