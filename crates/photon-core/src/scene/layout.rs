//! Data layouts of the elements that backends store in buffers: photons, queries and estimates; those of a
//! scene are in files of their own.
//!
//! Each has a GLSL counterpart with the same name and offsets. All consist of 16-byte rows of a `vec3` and
//! a scalar, so that their `repr(C)` layout is also their std430 and scalar layout.

use bytemuck::{Pod, Zeroable};

use crate::scene::camera::Camera;
use crate::scene::grid::Grid;
use crate::scene::light::Light;
use crate::scene::material::{Material, Primitive};
use crate::scene::medium::Medium;
use crate::scene::texture::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, MaterialTextures, PartialTransmission, SheenLayer, TextureUse,
};
use crate::shading::light_tree::LightNode;

/// An element type of buffers; its GLSL counterpart has the same offsets.
pub trait Element: Pod + Send + Sync {
    /// Name of the GLSL type.
    const GLSL_NAME: &'static str;
}

/// A photon stored at a surface.
///
/// It has no identifier: its index is its position in the buffer that the tracer fills, ordered by path,
/// then bounce. Maps store only as many of the leading fields as are needed: [`crate::PhotonFormat`].
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Photon {
    /// Normalised space.
    pub position: [f32; 3],
    /// Geometric normal of the surface on the side where the photon arrived, packed by
    /// [`crate::octahedral::pack`].
    pub normal: u32,
    /// Flux of its path, linear RGB, in units of the scene's total power; *not* divided by the number of
    /// paths.
    pub power: [f32; 3],
    /// Unit vector towards where it came from, packed by [`crate::octahedral::pack`].
    pub direction: u32,
}

/// A photon that leaves a light.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PhotonRay {
    /// Normalised space, already moved off the emitting surface.
    pub origin: [f32; 3],
    /// Index of the path within its pass.
    pub path: u32,
    /// Unit vector.
    pub direction: [f32; 3],
    /// Index of the light in the scene's table.
    pub light: u32,
    /// Like [`Photon::power`].
    pub power: [f32; 3],
    /// The media at its origin: bits of a [`crate::MediumStack`].
    pub media: u32,
}

/// A visible point, or another point where radiance is estimated.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Query {
    /// Normalised space.
    pub position: [f32; 3],
    /// Search radius, normalised space, > 0; multiplied by [`crate::EstimateParams::radius_scale`].
    pub radius: f32,
    /// Unit normal on the visible side.
    pub normal: [f32; 3],
    /// Index of the pixel that the estimate is added to, row by row from the top left. Pixels of camera samples that are traced
    /// together are numbered on: [`crate::Pass::samples`].
    pub pixel: u32,
    /// Factor from irradiance here to the pixel's radiance: throughput of the camera path times albedo over
    /// π. In a query for a reflection, that of the camera path times the correction of [`crate::ReflectionLobe::pack`].
    pub throughput: [f32; 3],
    /// The media in front of the surface: bits of a [`crate::MediumStack`]. Shadow and gather rays start in them. In a query
    /// for a reflection ([`crate::EstimateParams::reflection`]), from which no rays start, the first word of a
    /// [`crate::ReflectionLobe`].
    pub media: u32,
    /// Vector from the position to where shadow rays start, packed by [`crate::shadow_terminator::pack`]; 0 if they start at
    /// the position; read only in scenes with [`crate::Features::SHADING_NORMALS`]. In a query for a reflection, the unit
    /// vector towards the viewer, packed by [`crate::octahedral::pack`].
    pub offset_or_wo: u32,
    /// Index of the camera path within its pass: the key of the random numbers used here. In a query for a reflection with
    /// anisotropy ([`crate::EstimateParams::anisotropy`]), that: [`crate::anisotropy::pack`].
    pub path: u32,
    /// Unit shading normal on the visible side, packed by [`crate::octahedral::pack`]; read only in scenes with
    /// [`crate::Features::SHADING_NORMALS`], and in queries for a reflection.
    pub shading_normal: u32,
    /// The coat over the base of a glossy surface: bits of a [`crate::Coat`], which reduces the light that reaches the
    /// base; 0 without one. In a query for a reflection, the second word of a [`crate::ReflectionLobe`].
    pub coat: u32,
}

/// Result of a density estimate for one query.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Estimate {
    /// Σ W(d²/r²)·power over the photons that count, linear RGB: divided neither by area nor by the number
    /// of paths.
    pub flux: [f32; 3],
    /// Squared radius of the disc that the sum is over, normalised space, > 0; times the share of the disc
    /// that lies on the surface, if that is estimated: [`crate::AreaProbe`].
    pub radius_squared: f32,
    /// Number of photons within it.
    pub photons: u32,
    /// Bits: [`Estimate::SINGULAR`].
    pub flags: u32,
    /// Along segments, Σ power and Σ power² over these photons, mean of RGB, as scattered to the camera; otherwise zero.
    pub power_sums: [f32; 2],
}

impl Estimate {
    /// All k photons are at the query's position, so that the radius is a lower limit, not a measured
    /// distance.
    pub const SINGULAR: u32 = 1;

    /// Number of photons of equal power that would make as much noise: (Σ power)² / Σ power². 0 without
    /// [`Self::power_sums`], and where the squares are too small or too large for f32.
    #[must_use]
    pub fn effective_photons(&self) -> f64 {
        let [power, squared] = self.power_sums;
        if squared.is_normal() { f64::from(power) * f64::from(power) / f64::from(squared) } else { 0.0 }
    }

    /// Irradiance in units of total power per squared normalised length, if `paths` paths were emitted:
    /// `flux / (π r² paths)`.
    #[must_use]
    pub fn irradiance(&self, paths: u64) -> [f64; 3] {
        if self.photons == 0 || paths == 0 {
            return [0.0; 3];
        }
        let area = std::f64::consts::PI * f64::from(self.radius_squared) * paths as f64;
        self.flux.map(|flux| f64::from(flux) / area)
    }
}

/// Error statistics of an estimate with radius r; all sums are over the photons within √2 r.
///
/// Bias grows as r²: an estimate over twice the area has twice the bias, so that the difference of the two
/// estimates the bias of the first.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ErrorMoments {
    /// Σ W(d²/2r²)·power, linear RGB: like [`Estimate::flux`], for a disc of twice the area.
    pub wide: [f32; 3],
    /// Σ power, mean of RGB.
    pub power: f32,
    /// Σ W(2d²/r²)·power over the photons within r/√2: for a disc of half the area.
    pub narrow: [f32; 3],
    /// Σ of the squares of the same powers.
    pub power_squared: f32,
    /// Σ power·(x, y) with x and y the offsets from the query along [`crate::sampling::basis`] of its
    /// normal, over √2 r.
    pub slope: [f32; 2],
    /// Σ power·(x² − y², 2xy).
    pub quadrupole: [f32; 2],
    /// Σ power of photons that lie on another surface: their normals were rejected, or they are farther
    /// from the query's plane than a quarter of √2 r.
    pub stray: f32,
    /// Number of photons within √2 r, without strays.
    pub photons: u32,
    /// Zero.
    pub reserved: [u32; 2],
}

macro_rules! elements {
    ($($record:ident = $bytes:literal),+ $(,)?) => {$(
        impl Element for $record {
            const GLSL_NAME: &'static str = stringify!($record);
        }
        const _: () = assert!(size_of::<$record>() == $bytes);
    )+};
}

elements!(
    Photon = 32,
    PhotonRay = 48,
    Query = 64,
    Estimate = 32,
    ErrorMoments = 64,
    Primitive = 16,
    Material = 64,
    Medium = 80,
    Grid = 64,
    Light = 64,
    Camera = 64,
    TextureUse = 32,
    MaterialTextures = 64,
    Anisotropy = 16,
    DiffuseTransmission = 32,
    SheenLayer = 32,
    PartialTransmission = 16,
    ClearcoatNormal = 16,
    LightNode = 32,
);

impl Element for u32 {
    const GLSL_NAME: &'static str = "uint";
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    /// The offsets that the GLSL counterparts rely on: rows of a vector and a scalar.
    #[test]
    fn offsets_are_those_of_vector_and_scalar_rows() {
        let rows = [
            (offset_of!(Photon, position), offset_of!(Photon, normal)),
            (offset_of!(Photon, power), offset_of!(Photon, direction)),
            (offset_of!(PhotonRay, origin), offset_of!(PhotonRay, path)),
            (offset_of!(PhotonRay, direction), offset_of!(PhotonRay, light)),
            (offset_of!(PhotonRay, power), offset_of!(PhotonRay, media)),
            (offset_of!(Query, position), offset_of!(Query, radius)),
            (offset_of!(Query, normal), offset_of!(Query, pixel)),
            (offset_of!(Query, throughput), offset_of!(Query, media)),
            (offset_of!(Estimate, flux), offset_of!(Estimate, radius_squared)),
            (offset_of!(ErrorMoments, wide), offset_of!(ErrorMoments, power)),
            (offset_of!(ErrorMoments, narrow), offset_of!(ErrorMoments, power_squared)),
            (offset_of!(Primitive, normal), offset_of!(Primitive, material)),
            (offset_of!(Material, albedo), offset_of!(Material, kind)),
            (offset_of!(Material, emission), offset_of!(Material, flags)),
            (offset_of!(Medium, absorption), offset_of!(Medium, ior)),
            (offset_of!(Light, position), offset_of!(Light, kind)),
            (offset_of!(Light, direction), offset_of!(Light, primitive)),
            (offset_of!(Light, power), offset_of!(Light, versine_inner)),
            (offset_of!(Camera, origin), offset_of!(Camera, kind)),
            (offset_of!(Camera, forward), offset_of!(Camera, media)),
            (offset_of!(Camera, right), offset_of!(Camera, lens_radius)),
        ];
        for (vector, scalar) in rows {
            assert_eq!(vector % 16, 0);
            assert_eq!(scalar, vector + 12);
        }
        assert_eq!(offset_of!(Light, versine_outer), 48);
        assert_eq!(offset_of!(Query, offset_or_wo), 48);
        assert_eq!(offset_of!(Estimate, photons), 16);
        assert_eq!(offset_of!(ErrorMoments, slope), 32);
        assert_eq!(offset_of!(ErrorMoments, stray), 48);
    }

    #[test]
    fn irradiance_of_a_known_disc() {
        let estimate = Estimate { flux: [2.0; 3], radius_squared: 0.25, photons: 4, ..Estimate::default() };
        let expected = 2.0 / (std::f64::consts::PI * 0.25 * 10.0);
        assert!((estimate.irradiance(10)[0] - expected).abs() < 1e-15);
        assert_eq!(estimate.irradiance(0), [0.0; 3]);
        assert_eq!(Estimate::default().irradiance(10), [0.0; 3]);
    }

    #[test]
    fn photons_of_equal_power_are_all_effective() {
        let of = |powers: &[f32]| {
            let power_sums = [powers.iter().sum(), powers.iter().map(|power| power * power).sum()];
            Estimate { power_sums, ..Estimate::default() }.effective_photons()
        };
        assert_eq!([of(&[]), of(&[0.25; 8]), of(&[3.0, 1.0]), of(&[1e-30; 4])], [0.0, 8.0, 1.6, 0.0]);
        assert_eq!(of(&[f32::MAX; 2]), 0.0);
    }
}
