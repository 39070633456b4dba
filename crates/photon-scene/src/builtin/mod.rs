//! Built-in scenes that need no file: demonstration scenes, and rooms with analytic solutions.
//!
//! All are in metres and watts, with y upwards, and have one camera, set up for a square picture.

mod cloud;
mod cornell;
mod fog;
mod frosted;
mod furnace;
mod glass;
mod gloss;
mod integrating_sphere;
mod many_lights;
mod milk;
mod plates;
mod pool;
mod prism;
mod rainbow;
mod ring;
#[cfg(feature = "sky")]
mod sky;
mod textures;
mod two_rooms;

pub use furnace::{FurnaceShape, furnace};
pub use integrating_sphere::IntegratingSphere;
pub use plates::plates;

use crate::builder::{MaterialId, SceneBuilder};
use crate::shapes::Shape;

/// Names, each with a one-line description.
const NAMES: &[(&str, &str)] = &[
    ("cornell", "the Cornell box: diffuse walls, two blocks, an area light in the ceiling"),
    ("cornell-glass", "the Cornell box with a mirror ball and a glass ball, with their caustics"),
    ("ring", "a golden ring on a table, with the cardioid caustic of its inner wall"),
    ("pool", "the floor of a swimming pool in the sun, under waves"),
    ("prism", "a glass prism, and the spectrum of white light on the wall behind it"),
    ("rainbow", "a ball of water in sunlight, and its rainbow on a screen"),
    ("fog", "shafts of light through a window into a room full of mist"),
    ("glass-fog", "a glass ball in fog, with its caustic in the air"),
    ("milk", "a glass of milk, which scatters light behind the glass"),
    ("cloud", "a cloud over a meadow, in the sun"),
    ("textures", "a room with tiles, a normal map, a textured light, and smooth balls of few triangles"),
    ("gloss", "metal and plastic balls of several roughnesses, on glazed tiles"),
    ("frosted-glass", "the Cornell box with two balls of rough glass, and a frosted pane before a spotlight"),
    ("many-lights", "a room under 256 coloured bulbs, with spotlights and glowing lanterns"),
    #[cfg(feature = "sky")]
    ("sky", "a terrace under a clear sky, with coloured panes, a glass ball and metals in the sun"),
    ("two-rooms", "a dark room, lit through a partly open door"),
    ("furnace", "inside a uniformly emitting sphere: radiosity 2 everywhere"),
    ("integrating-sphere", "inside a diffuse sphere: indirect irradiance 1 everywhere"),
    ("plates", "two infinite parallel plates, modelled with four mirrors: radiosities 5/3 and 4/3"),
];

/// The built-in scenes: name and one-line description.
#[must_use]
pub fn builtin_names() -> &'static [(&'static str, &'static str)] {
    NAMES
}

/// A built-in scene by name, one of [`builtin_names`]; `None` for any other name.
///
/// ```
/// let scene = photon_scene::builtin("cornell").expect("listed").build()?;
/// assert!(scene.warnings().is_empty());
/// # Ok::<(), photon_scene::SceneError>(())
/// ```
#[must_use]
pub fn builtin(name: &str) -> Option<SceneBuilder> {
    Some(match name {
        "cornell" => cornell::cornell(),
        "cornell-glass" => glass::cornell_glass(),
        "ring" => ring::ring(),
        "pool" => pool::pool(),
        "prism" => prism::prism(),
        "rainbow" => rainbow::rainbow(),
        "fog" => fog::fog(),
        "glass-fog" => fog::glass_fog(),
        "milk" => milk::milk(),
        "cloud" => cloud::cloud(),
        "textures" => textures::textures(),
        "gloss" => gloss::gloss(),
        "frosted-glass" => frosted::frosted_glass(),
        "many-lights" => many_lights::many_lights(),
        #[cfg(feature = "sky")]
        "sky" => sky::sky(),
        "two-rooms" => two_rooms::two_rooms(),
        "furnace" => furnace(0.5, FurnaceShape::Sphere),
        "integrating-sphere" => IntegratingSphere::default().builder(),
        "plates" => plates(0.5, 0.8, 1.0),
        _ => return None,
    })
}

fn add(scene: &mut SceneBuilder, name: &str, (positions, triangles): Shape, material: MaterialId) {
    scene.mesh(name, positions, triangles, material);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_each_has_a_scene() {
        for (index, (name, line)) in builtin_names().iter().enumerate() {
            assert!(!line.is_empty());
            assert!(builtin_names()[..index].iter().all(|(other, _)| other != name), "{name} twice");
            assert!(builtin(name).is_some(), "{name}");
        }
        assert!(builtin("no-such-scene").is_none());
        assert!(builtin("").is_none());
    }

    #[test]
    fn every_scene_builds_without_a_warning_and_is_seen_and_lit() {
        for (name, _) in builtin_names() {
            let scene = builtin(name).expect("listed").build().unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(scene.warnings().is_empty(), "{name}: {:?}", scene.warnings());
            assert_eq!(scene.dropped_triangles(), 0, "{name}");
            assert_eq!(scene.camera_names().count(), 1, "{name}");
            scene.camera(None, 512, 512).unwrap_or_else(|error| panic!("{name}: {error}"));
            let view = scene.view();
            view.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(!view.lights.is_empty(), "{name}");
            let keeps = photon_core::Material::stores_photons;
            assert!(view.materials.iter().any(keeps), "{name}");
        }
    }

    /// The check for open solids must work on these scenes: a hole in the glass makes a warning.
    #[test]
    fn a_hole_in_the_glass_is_told() {
        let mut scene = glass::cornell_glass();
        let ball = scene.meshes.iter_mut().find(|mesh| &*mesh.name == "glass ball").expect("a glass ball");
        ball.triangles.pop();
        let scene = scene.build().expect("a hole is no error");
        assert_eq!(scene.warnings().len(), 1, "{:?}", scene.warnings());
        assert!(scene.warnings()[0].contains("glass"));
    }
}
