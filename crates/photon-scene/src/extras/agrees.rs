//! Whether extras still belong to the object that they are attached to.

use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Projection, Surface};
use crate::parameter::{self, Kind, Value};

/// Whether the extras refine the single-precision glTF content, or are stale because that was changed.
pub(crate) trait Agrees {
    fn agrees(&self, exact: &Self) -> bool;
}

/// Equal up to single precision, a few operations and a logarithm.
pub(super) fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs()) + 1e-30
}

/// Each component equal up to the rounding error of the largest one.
fn all_close(a: [f64; 3], b: [f64; 3]) -> bool {
    let greatest = a.iter().chain(&b).fold(0.0_f64, |most, x| most.max(x.abs()));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-4 * greatest + 1e-30)
}

fn parallel(a: [f64; 3], b: [f64; 3]) -> bool {
    let unit = |v: [f64; 3]| glam::DVec3::from(v).normalize_or_zero();
    unit(a).distance(unit(b)) <= 1e-4
}

/// The dispersion as glTF has it.
fn strength(desc: &MaterialDesc) -> f64 {
    let both = desc.dispersion.zip(desc.ior());
    both.map_or(0.0, |(dispersion, ior)| dispersion.strength(ior))
}

/// The surface of the file as that which was written: glTF has no perfect mirrors, which are written as smooth metals, and no
/// boundaries, which are written as glass.
fn as_written(found: &Surface, exact: &Surface) -> Surface {
    match (found, exact) {
        (Surface::Glossy { base_color, metallic, roughness: 0.0, .. }, Surface::Mirror { .. })
            if close(*metallic, 1.0) =>
        {
            Surface::Mirror { reflectance: *base_color }
        }
        (Surface::Dielectric { ior, absorption, tint, roughness: 0.0 }, Surface::Boundary { .. })
            if close(*ior, 1.0) && all_close(*tint, [1.0; 3]) =>
        {
            Surface::Boundary { absorption: *absorption }
        }
        _ => found.clone(),
    }
}

impl Agrees for MaterialDesc {
    fn agrees(&self, exact: &Self) -> bool {
        let surface = as_written(&self.surface, &exact.surface);
        if Kind::of(&surface) != Kind::of(&exact.surface) {
            return false;
        }
        let found = Self { surface, ..self.clone() };
        let mut pairs = parameter::values(&found).zip(parameter::values(exact));
        let parameters = pairs.all(|((parameter, found), (_, exact))| match (found, exact) {
            // It is written into the extras alone.
            (Value::Color([0.0, 0.0, 0.0]), _) if parameter.key == "scattering" => true,
            (Value::Number(a), Value::Number(b)) => close(a, b),
            (Value::Color(a), Value::Color(b)) => all_close(a, b),
            _ => false,
        });
        // Whether a non-emissive surface is double-sided does not matter.
        let sides = !self.is_emissive() || !exact.is_emissive() || self.emits_both_sides == exact.emits_both_sides;
        let inside = match (self.transmission_absorption, exact.transmission_absorption) {
            (Some(found), Some(exact)) => all_close(found, exact),
            (found, exact) => found == exact,
        };
        parameters
            && sides
            && inside
            && close(strength(self), strength(exact))
            && all_close(self.emission, exact.emission)
    }
}

impl Agrees for LightDesc {
    fn agrees(&self, exact: &Self) -> bool {
        match (self, exact) {
            (Self::Point { position: a, intensity: i }, Self::Point { position: b, intensity: j }) => {
                all_close(*a, *b) && all_close(*i, *j)
            }
            (
                Self::Spot { position, direction, intensity, inner_angle, outer_angle },
                Self::Spot { position: p, direction: d, intensity: i, inner_angle: inner, outer_angle: outer },
            ) => {
                let angles = close(*inner_angle, *inner) && close(*outer_angle, *outer);
                all_close(*position, *p) && parallel(*direction, *d) && all_close(*intensity, *i) && angles
            }
            (Self::Directional { direction: a, irradiance: i }, Self::Directional { direction: b, irradiance: j }) => {
                parallel(*a, *b) && all_close(*i, *j)
            }
            _ => false,
        }
    }
}

impl Agrees for CameraDesc {
    fn agrees(&self, exact: &Self) -> bool {
        let projection = match (self.projection, exact.projection) {
            (Projection::Perspective { vertical_fov: a }, Projection::Perspective { vertical_fov: b })
            | (Projection::Orthographic { half_height: a }, Projection::Orthographic { half_height: b }) => close(a, b),
            _ => false,
        };
        // The up vector in the file is perpendicular to the direction.
        let right = |camera: &Self| glam::DVec3::from(camera.direction).cross(glam::DVec3::from(camera.up)).to_array();
        let axes = parallel(self.direction, exact.direction) && parallel(right(self), right(exact));
        projection && axes && all_close(self.position, exact.position)
    }
}
