//! The Cornell box with rough glass.

use super::{add, cornell};
use crate::builder::SceneBuilder;
use crate::describe::{LightDesc, MaterialDesc, Surface};
use crate::shapes::icosphere;

/// 81 920 triangles per ball.
const SUBDIVISION: u32 = 6;

/// A slightly rough and a very rough, coloured ball, and a frosted pane with a spotlight behind it.
pub(super) fn frosted_glass() -> SceneBuilder {
    let mut scene = cornell::room([-1.0, -0.4], [0.7, 0.7], 75.0);
    let glass = |name: &str, roughness: f64, absorption: [f64; 3]| {
        MaterialDesc::new(name, Surface::Dielectric { ior: 1.5, absorption, tint: [1.0; 3], roughness })
    };
    let satin = scene.material(glass("satin glass", 0.25, [0.0; 3]));
    let frosted = scene.material(glass("frosted glass", 0.7, [1.2, 0.15, 0.3]));
    let pane = Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness: 0.45 };
    let pane = scene.material(MaterialDesc::new("frosted pane", pane));
    // Slightly above the floor: if they touched, it would be ambiguous which one a ray hits.
    add(&mut scene, "satin ball", icosphere(SUBDIVISION, [-1.1, 0.902, 0.5], 0.9), satin);
    add(&mut scene, "frosted ball", icosphere(SUBDIVISION, [0.55, 0.602, 1.2], 0.6), frosted);
    let corners = [[0.2, 0.01, 0.1], [2.0, 0.01, -0.7], [2.0, 2.6, -0.7], [0.2, 2.6, 0.1]];
    scene.quad("pane", corners, pane);
    let spot = LightDesc::Spot {
        position: [1.0, 3.6, -2.2],
        direction: [0.1, -2.4, 1.8],
        intensity: [30.0, 26.0, 20.0],
        inner_angle: 0.25,
        outer_angle: 0.35,
    };
    scene.light("spot", spot);
    scene
}
