//! Lights, the records that photons start from.

use std::f32::consts::PI;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A light that emits photons; an area light is one of these per triangle.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Light {
    /// Point and spot: position, normalised space.
    pub position: [f32; 3],
    /// One of the constants of this type.
    pub kind: u32,
    /// Spot and directional: unit vector along which the light travels.
    pub direction: [f32; 3],
    /// Triangle: its index. Otherwise `u32::MAX`.
    pub primitive: u32,
    /// Total emitted flux, linear RGB, in units of the scene's total power; before a clearcoat over it dims them.
    pub power: [f32; 3],
    /// Spot: 1 − cos of the angle up to which the intensity is full.
    pub versine_inner: f32,
    /// Spot: 1 − cos of the angle from which it is zero, ≥ `versine_inner`. Directional: 1 − cos of the radius of its disc
    /// in the sky, of constant radiance; 0 for parallel light.
    pub versine_outer: f32,
    /// Directional and environment: radius of the disc that photons pass through, normalised space. That of a directional
    /// light is perpendicular to its direction; `power` over its area is the irradiance of a plane facing the light.
    pub radius: f32,
    /// Triangle: its area, squared normalised length.
    pub area: f32,
    /// Bits: [`Light::BOTH_SIDES`].
    pub flags: u32,
}

impl Light {
    /// One emissive triangle, Lambertian.
    pub const TRIANGLE: u32 = 0;
    /// The same intensity in all directions.
    pub const POINT: u32 = 1;
    /// Intensity within a cone, falling to zero between two angles as glTF defines it.
    pub const SPOT: u32 = 2;
    /// Parallel light from infinitely far away.
    pub const DIRECTIONAL: u32 = 3;
    /// [`crate::SceneView::environment`].
    pub const ENVIRONMENT: u32 = 4;

    /// Flag: a triangle that emits from both sides.
    pub const BOTH_SIDES: u32 = 1;

    /// Largest [`Self::versine_outer`] of a directional light: a radius of 60 degrees.
    pub const MAX_SUN_VERSINE: f32 = 0.5;

    /// Whether this is a directional light with a disc.
    #[inline]
    #[must_use]
    pub fn is_sun(&self) -> bool {
        self.kind == Self::DIRECTIONAL && self.versine_outer > 0.0
    }

    /// Radiance of the disc of a directional light, linear RGB: its irradiance over `π sin² δ`, for the radius δ.
    #[inline]
    #[must_use]
    pub fn sun_radiance(&self) -> Vec3 {
        let through = PI * self.radius * self.radius;
        let squared_sine = self.versine_outer * (2.0 - self.versine_outer);
        Vec3::from(self.power) / (through * (PI * squared_sine))
    }
}
