//! Two infinite parallel plates.

use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use std::f64::consts::PI;

/// Half the width of the box; also its height.
const HALF: f64 = 1.0;
const HEIGHT: f64 = 1.0;

/// A floor and a ceiling between four perfect mirrors, which make them effectively infinite; the floor emits
/// `exitance` W/m². Albedos are in `[0, 1]`, but not both 1.
///
/// All light that leaves one plate arrives at the other, so that with floor 1 and ceiling 2 the
/// radiosities are `B₁ = e + ρ₁ B₂` and `B₂ = ρ₂ B₁`: `B₁ = e / (1 − ρ₁ρ₂)`.
#[must_use]
pub fn plates(floor: f64, ceiling: f64, exitance: f64) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let below = scene.material(MaterialDesc::emissive("floor", [floor; 3], [exitance / PI; 3]));
    let above = scene.material(MaterialDesc::lambert("ceiling", [ceiling; 3]));
    let mirror = scene.material(MaterialDesc::mirror("mirror", [1.0; 3]));
    let (h, top) = (HALF, HEIGHT);
    scene.quad("floor", [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]], below);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], above);
    let [a, b, c, d] = [[-h, h], [h, h], [h, -h], [-h, -h]];
    for (name, [from, to]) in
        [("back mirror", [d, c]), ("right mirror", [c, b]), ("front mirror", [b, a]), ("left mirror", [a, d])]
    {
        let [p, q, r, s] = [(from, 0.0), (to, 0.0), (to, top), (from, top)].map(|([x, z], y)| [x, y, z]);
        scene.quad(name, [p, q, r, s], mirror);
    }
    // Rotated slightly, so that the camera does not look at the edges of its own reflections.
    scene.camera("inside", CameraDesc::look_at([0.1, 0.5, 0.6], [-0.25, 0.47, -0.7], [0., 1., 0.], 1.2));
    scene
}
