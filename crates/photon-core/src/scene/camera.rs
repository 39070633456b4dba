//! The camera's record.

use bytemuck::{Pod, Zeroable};

/// A camera: `origin + x·right + y·up` with x and y in `[-1, 1]`, x to the right, y upwards.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Camera {
    /// Normalised space.
    pub origin: [f32; 3],
    /// One of the constants of this type.
    pub kind: u32,
    /// Unit vector.
    pub forward: [f32; 3],
    /// The media at the origin: bits of a [`crate::MediumStack`]. Set by [`crate::Pipeline`].
    pub media: u32,
    /// Half the width of the picture, to its right edge. Perspective: at distance 1. Orthographic:
    /// normalised space.
    pub right: [f32; 3],
    /// Zero.
    pub reserved2: u32,
    /// Half the height of the picture, to its upper edge, likewise.
    pub up: [f32; 3],
    /// Zero.
    pub reserved3: u32,
}

impl Camera {
    /// All rays start at one point.
    pub const PERSPECTIVE: u32 = 0;
    /// Rays are parallel.
    pub const ORTHOGRAPHIC: u32 = 1;
}
