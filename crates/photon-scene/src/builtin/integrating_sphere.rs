//! The integrating sphere, which laboratories use to measure flux.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc};
use crate::shapes::{area, flip, icosphere};
use std::f64::consts::PI;

/// A point light in a diffuse sphere around the origin.
///
/// Wherever the light is, the irradiance that the wall receives from the wall is the same everywhere,
/// [`IntegratingSphere::indirect_irradiance`]: between any two points of a sphere, the cosines and the
/// distance in the form factor cancel.
// Exhaustive: written as a literal with `..IntegratingSphere::default()`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratingSphere {
    /// Radius of the sphere whose area equals that of the mesh, > 0.
    pub radius: f64,
    /// Albedo of the wall, in `[0, 1)`.
    pub albedo: f64,
    /// Position of the light; inside the sphere.
    pub light: [f64; 3],
    /// Radiant flux of the light, watts, the same in every channel.
    pub power: f64,
    /// The mesh has `20 · 4^subdivision` triangles.
    pub subdivision: u32,
}

impl Default for IntegratingSphere {
    /// Radius 1 m, albedo 0.8, π W well off the centre, 20 480 triangles: the indirect irradiance is 1 W/m².
    fn default() -> Self {
        Self { radius: 1.0, albedo: 0.8, light: [0.3, 0.4, -0.2], power: PI, subdivision: 5 }
    }
}

impl IntegratingSphere {
    /// The scene, with a camera inside.
    #[must_use]
    pub fn builder(&self) -> SceneBuilder {
        let mut scene = SceneBuilder::new();
        let wall = scene.material(MaterialDesc::lambert("wall", [self.albedo; 3]));
        // Vertices slightly outside the sphere, so that the mesh has the sphere's area: the flux that the wall
        // absorbs must equal the light's, and irradiance is per area.
        let unit = area(&icosphere(self.subdivision, [0.0; 3], 1.0));
        let corners = self.radius * (4.0 * PI / unit).sqrt();
        add(&mut scene, "wall", flip(icosphere(self.subdivision, [0.0; 3], corners)), wall);
        let intensity = [self.power / (4.0 * PI); 3];
        scene.light("light", LightDesc::Point { position: self.light, intensity });
        let from = [-0.5, -0.3, 0.6].map(|part| part * self.radius);
        scene.camera("inside", CameraDesc::look_at(from, [0.0; 3], [0., 1., 0.], 1.2));
        scene
    }

    /// Irradiance by light that the wall has scattered at least once, W/m²:
    /// `Φ ρ / (4π R² (1 − ρ))`.
    #[must_use]
    pub fn indirect_irradiance(&self) -> f64 {
        self.power * self.albedo / (4.0 * PI * self.radius * self.radius * (1.0 - self.albedo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_power_and_answer_are_those_of_the_sphere() {
        let sphere = IntegratingSphere { radius: 2.0, power: 100.0, ..IntegratingSphere::default() };
        let builder = sphere.builder();
        let mesh = &builder.meshes[0];
        let area = area(&(mesh.positions.clone(), mesh.triangles.clone()));
        assert!((area / (16.0 * PI) - 1.0).abs() < 1e-12, "{area}");
        let power = builder.build().expect("valid").units().power;
        assert!((power / 100.0 - 1.0).abs() < 1e-6, "{power}");
        let answer = IntegratingSphere { power: 100.0, ..IntegratingSphere::default() }.indirect_irradiance();
        assert!((answer - 31.830_989).abs() < 1e-6, "{answer}");
        let answer = IntegratingSphere::default().indirect_irradiance();
        assert!((answer - 1.0).abs() < 1e-12, "{answer}");
    }
}
