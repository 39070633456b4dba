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
        let is_close = |found: Value, exact: Value| match (found, exact) {
            (Value::Number(a), Value::Number(b)) => close(a, b),
            (Value::Color(a), Value::Color(b)) => all_close(a, b),
            _ => false,
        };
        let found = Self { surface, ..self.clone() };
        let mut of_surface = parameter::values(&found).filter(|(parameter, _)| parameter.layer.is_none());
        // Also of layers that the surface does not have: another program may have added them.
        let mut of_layers = parameter::layers(self).zip(parameter::layers(exact));
        let parameters = of_surface
            .all(|(parameter, found)| parameter.value(exact).is_some_and(|exact| is_close(found, exact)))
            && of_layers.all(|((parameter, _, found), (_, _, exact))| {
                // It is written into the extras alone.
                parameter.key == "scattering" && found == Value::Color([0.0; 3]) || is_close(found, exact)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A layer that another program adds shows, also where the surface of the extras has no such layer.
    #[test]
    fn added_layers_are_noticed() {
        let mirror = MaterialDesc::mirror("a", [0.5; 3]);
        let written = MaterialDesc::metal("a", [0.5; 3], 0.0);
        assert!(written.agrees(&mirror) && !written.with_anisotropy(0.5, 0.0).agrees(&mirror));
        for exact in [MaterialDesc::glass("a", 1.5), MaterialDesc::thin("a", 1.5)] {
            assert!(exact.agrees(&exact));
            assert!(!exact.clone().with_clearcoat(1.0, 0.0).agrees(&exact));
            assert!(!exact.clone().with_sheen([0.5; 3], 0.5).agrees(&exact));
        }
        let mist = MaterialDesc::boundary("a", [0.5; 3]).with_scattering([1.0; 3], 0.0);
        let Surface::Boundary { absorption } = mist.surface else { unreachable!() };
        let surface = Surface::Dielectric { ior: 1.0, absorption, tint: [1.0; 3], roughness: 0.0 };
        assert!(MaterialDesc::new("a", surface).agrees(&mist));
    }
}
