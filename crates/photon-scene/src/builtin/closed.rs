//! Closed scenes whose answer is known in closed form.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc};
use crate::shapes;
use std::f64::consts::{FRAC_1_PI, PI};

/// A closed room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FurnaceShape {
    /// A box.
    Box,
    /// A sphere of 5120 triangles.
    Sphere,
    /// A room with the plan of an L: not convex.
    LShape,
}

/// Every surface emits a radiosity of 1 and reflects `albedo` of what arrives: radiosity
/// `1/(1 − albedo)` everywhere, whatever the shape.
#[must_use]
pub fn furnace(albedo: f64, shape: FurnaceShape) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [albedo; 3], [FRAC_1_PI; 3]));
    let room = match shape {
        FurnaceShape::Box => shapes::cuboid([-1.0; 3], [1.0; 3]),
        FurnaceShape::Sphere => shapes::icosphere(4, [0.0; 3], 1.0),
        FurnaceShape::LShape => {
            let plan = [[0.0, 0.0], [1.0, 0.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [0.0, 1.0]];
            shapes::prism(&plan, 0, -0.5, 0.5)
        }
    };
    // Inside out: a room and not a solid, whichever way the plan ran.
    let room = if shapes::volume(&room) > 0.0 { shapes::flip(room) } else { room };
    add(&mut builder, "room", room, wall);
    builder.camera("inside", CameraDesc::look_at([-0.5, 0.1, -0.5], [-0.3, 0.0, 1.0], [0.0, 1.0, 0.0], 0.9));
    builder
}

/// A diffuse sphere of that radius and albedo about the origin, and a point light of `power` watts
/// anywhere inside: indirect irradiance is `Φρ/(4πR²(1−ρ))` everywhere. Icosphere of that
/// subdivision.
#[must_use]
pub fn integrating_sphere(radius: f64, albedo: f64, light: [f64; 3], power: f64, subdivision: u32) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [albedo; 3]));
    add(&mut builder, "sphere", shapes::flip(shapes::icosphere(subdivision, [0.0; 3], radius)), wall);
    builder.light("lamp", LightDesc::Point { position: light, intensity: [power / (4.0 * PI); 3] });
    let from = [-0.5, -0.2, -0.6].map(|c| c * radius);
    let to = [0.5, 0.1, 0.8].map(|c| c * radius);
    builder.camera("inside", CameraDesc::look_at(from, to, [0.0, 1.0, 0.0], 1.2));
    builder
}

/// A plate that emits a radiosity of 1 and reflects a half, opposite one that reflects 0.8, between
/// four perfect mirrors, which make the plates endless: radiosities 5/3 and 4/3.
#[must_use]
pub fn plates() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let lit = builder.material(MaterialDesc::emissive("lit plate", [0.5; 3], [FRAC_1_PI; 3]));
    let dark = builder.material(MaterialDesc::lambert("dark plate", [0.8; 3]));
    let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
    let w = 0.5;
    builder.quad("lit plate", [[-w, -w, w], [w, -w, w], [w, -w, -w], [-w, -w, -w]], lit);
    builder.quad("dark plate", [[-w, w, -w], [w, w, -w], [w, w, w], [-w, w, w]], dark);
    builder.quad("far mirror", [[-w, -w, -w], [w, -w, -w], [w, w, -w], [-w, w, -w]], mirror);
    builder.quad("near mirror", [[w, -w, w], [-w, -w, w], [-w, w, w], [w, w, w]], mirror);
    builder.quad("left mirror", [[-w, -w, w], [-w, -w, -w], [-w, w, -w], [-w, w, w]], mirror);
    builder.quad("right mirror", [[w, -w, -w], [w, -w, w], [w, w, w], [w, w, -w]], mirror);
    builder.camera("inside", CameraDesc::look_at([0.0, 0.0, 0.45], [0.0, 0.0, -0.5], [0.0, 1.0, 0.0], 1.4));
    builder
}
