//! Radii of estimates: derived from photons, reduced from pass to pass, adapted per pixel.

pub(crate) mod bandwidth;
pub(crate) mod footprint;
pub mod neighbour_radius;
pub(crate) mod progressive;
pub(crate) mod radii;
pub(crate) mod schedule;
