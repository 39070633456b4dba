//! Lights, the records that photons start from.

use bytemuck::{Pod, Zeroable};

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
    /// Total emitted flux, linear RGB, in units of the scene's total power.
    pub power: [f32; 3],
    /// Spot: 1 − cos of the angle up to which the intensity is full.
    pub versine_inner: f32,
    /// Spot: 1 − cos of the angle from which it is zero, ≥ `versine_inner`.
    pub versine_outer: f32,
    /// Directional and environment: radius of the disc that photons start from, normalised space.
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
}
