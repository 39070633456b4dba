//! The Cornell box with two balls, after the picture that made photon maps known (Jensen 1996).

use super::{add, cornell};
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::shapes::icosphere;

/// 327 680 triangles for each ball: facets are flat, and those of a coarser ball would show in the
/// mirror and in the caustic.
const SUBDIVISION: u32 = 7;
const RADIUS: f64 = 1.0;

/// A mirror ball behind on the left, a glass ball in front on the right.
pub(super) fn cornell_glass() -> SceneBuilder {
    // A small lamp, since a caustic is as sharp as the light that casts it, with as much flux as that
    // of the diffuse box; away from the glass, so that the caustic is not hidden under the ball.
    let mut scene = cornell::room([-1.2, -0.5], [0.6, 0.6], 110.0);
    let mirror = scene.material(MaterialDesc::mirror("mirror", [0.95; 3]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    add(&mut scene, "mirror ball", icosphere(SUBDIVISION, [-1.25, RADIUS, -1.15], RADIUS), mirror);
    // A hair above the floor: where they touched, it would be undecided which one a ray meets.
    add(&mut scene, "glass ball", icosphere(SUBDIVISION, [1.0, RADIUS + 0.002, 0.7], RADIUS), glass);
    scene
}
