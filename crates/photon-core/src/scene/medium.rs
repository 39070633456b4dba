//! The table of media, the insides of solids.

use bytemuck::{Pod, Zeroable};

/// Medium inside a solid. Entry 0 of a scene's table is the vacuum outside of all solids.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Medium {
    /// Absorption coefficient (Beer–Lambert), per normalised length, ≥ 0, linear RGB.
    pub absorption: [f32; 3],
    /// Refractive index relative to vacuum, > 0.
    pub ior: f32,
    /// Where solids overlap, the medium with the highest priority applies; with equal priorities, the one
    /// entered last.
    pub priority: u32,
    /// Zero.
    pub reserved: [u32; 11],
}

impl Medium {
    /// Entry 0 of every table.
    pub const VACUUM: Self = Self { absorption: [0.0; 3], ior: 1.0, priority: 0, reserved: [0; 11] };
}

impl Default for Medium {
    fn default() -> Self {
        Self::VACUUM
    }
}
