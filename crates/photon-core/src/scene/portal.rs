//! Portals: openings through which light from infinitely far away enters.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// A triangle of an opening, such as half of a window, in normalised space; it is not a surface.
///
/// Photons of the environment and of directional lights are started through portals more often than elsewhere:
/// [`crate::portals`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[non_exhaustive]
pub struct Portal {
    /// One corner.
    pub corner: [f32; 3],
    /// The other two, relative to it.
    pub edges: [[f32; 3]; 2],
    /// Half the cross product of the edges: a normal as long as the triangle's area.
    pub area: [f32; 3],
}

impl Portal {
    /// Largest number in a scene: each photon of the environment is tested against all.
    pub const MAX: usize = 64;

    /// Smallest valid length of [`Self::area`].
    pub const MIN_AREA: f32 = 1e-20;

    /// Largest valid distance of a corner from the origin, in radii of the scene: those beyond are no opening of it.
    pub const REACH: f32 = 4.0;

    /// The portal with these corners, in either order.
    #[must_use]
    pub fn new(corners: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(DVec3::from_array);
        let edges = [b - a, c - a].map(|edge| edge.as_vec3());
        // Of the edges as they are stored, so that densities and crossings agree.
        let area = 0.5 * edges[0].as_dvec3().cross(edges[1].as_dvec3());
        Self {
            corner: a.as_vec3().to_array(),
            edges: edges.map(|edge| edge.to_array()),
            area: area.as_vec3().to_array(),
        }
    }
}
