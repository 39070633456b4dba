//! Whether extras still belong to the object that they are attached to.

use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Projection, Surface};

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

impl Agrees for MaterialDesc {
    fn agrees(&self, exact: &Self) -> bool {
        let surface = match (&self.surface, &exact.surface) {
            (Surface::Lambert { albedo: a }, Surface::Lambert { albedo: b })
            | (Surface::Mirror { reflectance: a }, Surface::Mirror { reflectance: b }) => all_close(*a, *b),
            // glTF has no perfect mirrors: they are written as smooth metals.
            (Surface::Glossy { base_color, metallic, roughness, .. }, Surface::Mirror { reflectance }) => {
                close(*metallic, 1.0) && *roughness == 0.0 && all_close(*base_color, *reflectance)
            }
            (
                Surface::Dielectric { ior, absorption, tint, roughness },
                Surface::Dielectric {
                    ior: exact_ior,
                    absorption: exact_absorption,
                    tint: exact_tint,
                    roughness: exact_roughness,
                },
            ) => {
                close(*ior, *exact_ior)
                    && close(*roughness, *exact_roughness)
                    && all_close(*absorption, *exact_absorption)
                    && all_close(*tint, *exact_tint)
            }
            // glTF has no boundaries: they are written as glass.
            (Surface::Dielectric { ior, absorption, tint, roughness }, Surface::Boundary { absorption: exact }) => {
                close(*ior, 1.0) && *roughness == 0.0 && all_close(*absorption, *exact) && all_close(*tint, [1.0; 3])
            }
            (
                Surface::Thin { ior, tint, roughness },
                Surface::Thin { ior: exact_ior, tint: exact_tint, roughness: exact_roughness },
            ) => close(*ior, *exact_ior) && close(*roughness, *exact_roughness) && all_close(*tint, *exact_tint),
            (
                Surface::Glossy { base_color, metallic, roughness, specular, ior },
                Surface::Glossy {
                    base_color: exact_color,
                    metallic: exact_metallic,
                    roughness: exact_roughness,
                    specular: exact_specular,
                    ior: exact_ior,
                },
            ) => {
                let pairs = [
                    (metallic, exact_metallic),
                    (roughness, exact_roughness),
                    (specular, exact_specular),
                    (ior, exact_ior),
                ];
                all_close(*base_color, *exact_color) && pairs.into_iter().all(|(a, b)| close(*a, *b))
            }
            _ => false,
        };
        // Whether a non-emissive surface is double-sided does not matter.
        let sides = !self.is_emissive() || !exact.is_emissive() || self.emits_both_sides == exact.emits_both_sides;
        let coat = all_close(self.specular_color, exact.specular_color)
            && close(self.clearcoat, exact.clearcoat)
            && close(self.clearcoat_roughness, exact.clearcoat_roughness)
            && close(self.anisotropy, exact.anisotropy)
            && close(self.anisotropy_rotation, exact.anisotropy_rotation)
            && close(self.diffuse_transmission, exact.diffuse_transmission)
            && close(self.transmission, exact.transmission)
            && match (self.transmission_absorption, exact.transmission_absorption) {
                (Some(found), Some(exact)) => all_close(found, exact),
                (found, exact) => found == exact,
            }
            && close(strength(self), strength(exact))
            // It is written into the extras alone.
            && (self.scattering == [0.0; 3] || all_close(self.scattering, exact.scattering))
            && all_close(self.diffuse_transmission_color, exact.diffuse_transmission_color)
            && all_close(self.sheen_color, exact.sheen_color)
            && close(self.sheen_roughness, exact.sheen_roughness);
        surface && coat && sides && all_close(self.emission, exact.emission)
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
