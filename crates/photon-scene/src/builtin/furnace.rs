//! Closed rooms with uniformly emitting walls (furnace tests).

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use crate::shapes::{Shape, cuboid, flip, icosphere, prism};
use std::f64::consts::FRAC_1_PI;

/// Shape of a [`furnace`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FurnaceShape {
    /// A box of 2 by 1.5 by 3.
    Box,
    /// An icosphere of radius 1, of 1280 triangles.
    Sphere,
    /// An L-shaped room, in which not all points see each other.
    LRoom,
}

impl FurnaceShape {
    /// The mesh, facing inwards, with the origin inside.
    fn shape(self) -> Shape {
        flip(match self {
            Self::Box => cuboid([-1.0, -0.75, -1.5], [1.0, 0.75, 1.5]),
            Self::Sphere => icosphere(3, [0.0; 3], 1.0),
            Self::LRoom => {
                let plan = [[-1.0, -1.0], [-1.0, 2.0], [0.5, 2.0], [0.5, 0.5], [2.0, 0.5], [2.0, -1.0]];
                prism(&plan, 3, -0.75, 0.75)
            }
        })
    }
}

/// A closed room whose walls all have the same albedo (in `[0, 1)`) and emit 1 W/m².
///
/// Radiosity is `1 / (1 − albedo)` everywhere, whatever the shape, and radiance is that over π: the sum
/// of the emitted light and the reflected light from walls that are all alike.
#[must_use]
pub fn furnace(albedo: f64, shape: FurnaceShape) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let wall = scene.material(MaterialDesc::emissive("wall", [albedo; 3], [FRAC_1_PI; 3]));
    add(&mut scene, "wall", shape.shape(), wall);
    scene.camera("inside", CameraDesc::look_at([0.1, 0.05, 0.2], [-0.9, 0.0, -0.6], [0., 1., 0.], 1.2));
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{area, open_edges, volume};
    use std::f64::consts::PI;

    #[test]
    fn rooms_are_closed_face_inwards_and_give_one_watt_for_each_square_metre() {
        for shape in [FurnaceShape::Box, FurnaceShape::Sphere, FurnaceShape::LRoom] {
            let walls = shape.shape();
            assert_eq!(open_edges(&walls), 0);
            assert!(volume(&walls) < 0.0);
            let scene = furnace(0.5, shape).build().expect("valid");
            let power = scene.units().power;
            assert!((power / area(&walls) - 1.0).abs() < 1e-6, "{shape:?}: {power}");
        }
    }

    #[test]
    fn the_emitted_radiance_comes_back_in_user_units() {
        let scene = furnace(0.5, FurnaceShape::Box).build().expect("valid");
        let radiance = f64::from(scene.view().materials[0].emission[0]) * scene.units().radiance_to_user();
        assert!((radiance * PI - 1.0).abs() < 1e-6, "{radiance}");
    }

    #[test]
    fn an_albedo_above_one_is_refused() {
        let error = furnace(2.0, FurnaceShape::Box).build().expect_err("albedo 2").to_string();
        assert!(error.contains("wall") && error.contains('2'), "{error}");
    }
}
