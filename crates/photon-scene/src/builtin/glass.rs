//! The Cornell box with two balls, after the well-known photon mapping test scene (Jensen 1996).

use super::{add, cornell};
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::shapes::icosphere;

/// 327 680 triangles per ball: triangles are flat, and those of a coarser ball would be visible in the
/// mirror and in the caustic.
const SUBDIVISION: u32 = 7;
const RADIUS: f64 = 1.0;

/// A mirror ball at the back left, a glass ball at the front right.
pub(super) fn cornell_glass() -> SceneBuilder {
    // A small area light, since a caustic is as sharp as the light that casts it, with as much flux as the
    // one of the diffuse box; off to the side of the glass, so that the ball does not hide the caustic.
    let mut scene = cornell::room([-1.2, -0.5], [0.6, 0.6], 110.0);
    let mirror = scene.material(MaterialDesc::mirror("mirror", [0.95; 3]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    add(&mut scene, "mirror ball", icosphere(SUBDIVISION, [-1.25, RADIUS, -1.15], RADIUS), mirror);
    // Slightly above the floor: if they touched, it would be ambiguous which one a ray hits.
    add(&mut scene, "glass ball", icosphere(SUBDIVISION, [1.0, RADIUS + 0.002, 0.7], RADIUS), glass);
    scene
}
