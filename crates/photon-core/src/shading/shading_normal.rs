//! Shading normals: cosines, and the factors by which they differ for light and for importance.
//!
//! A surface with shading normal n_s and geometric normal n_g scatters light from direction i with the cosine
//! `c(i) = min(max(i·n_s, 0), 32 i·n_g)`, 0 below the triangle's plane. All techniques use it: shadow rays and gather
//! rays by [`cosine`], photons, which arrive with a density in proportion to i·n_g, by [`cosine_ratio`] (Veach 1997,
//! section 5.3). The limit keeps the weight of a photon finite.

use glam::Vec3;

use crate::shading::bsdf::Lobe;

/// Largest ratio of the cosines to the shading normal and to the geometric one.
pub const MAX_RATIO: f32 = 32.0;

/// Lower limit of the cosines of a shading normal to the geometric normal and, at mirrors and glass, to the ray.
pub const MIN_COSINE: f32 = 1e-3;

/// The cosine of light from `direction` (unit vector away from the surface); both normals are on the same side.
#[inline]
#[must_use]
pub fn cosine(direction: Vec3, geometric: Vec3, shading: Vec3) -> f32 {
    direction.dot(shading).max(0.0).min(MAX_RATIO * direction.dot(geometric).max(0.0))
}

/// [`cosine`] over `direction · geometric`, in `[0, 32]`; 0 below the triangle's plane.
#[inline]
#[must_use]
pub fn cosine_ratio(direction: Vec3, geometric: Vec3, shading: Vec3) -> f32 {
    let below = direction.dot(geometric);
    let above = direction.dot(shading);
    if below > 0.0 && above > 0.0 { (above / below).min(MAX_RATIO) } else { 0.0 }
}

/// `normal`, bent as far as necessary towards `axis` for a cosine of at least 0.001 with it. Unit vectors.
#[inline]
#[must_use]
pub fn bend(normal: Vec3, axis: Vec3) -> Vec3 {
    let cosine = normal.dot(axis);
    if cosine >= MIN_COSINE { normal } else { (normal + axis * (MIN_COSINE - cosine)).normalize_or(axis) }
}

/// `direction`, reflected in the triangle's plane if it is on the other side than `lobe` requires. At mirrors and glass a
/// shading normal can send light through the surface, or back.
#[inline]
#[must_use]
pub fn on_side_of(lobe: Lobe, direction: Vec3, geometric: Vec3) -> Vec3 {
    let height = direction.dot(geometric);
    let wrong = match lobe {
        Lobe::Diffuse | Lobe::SpecularReflection => height < 0.0,
        Lobe::SpecularTransmission => height > 0.0,
    };
    if wrong { direction - geometric * (2.0 * height) } else { direction }
}

/// Factor on the power of a photon that arrives along `incoming` and leaves along `outgoing` (Veach 1997, equation
/// 5.19), in `[0, 32]`. Diffuse lobes are sampled about the geometric normal, specular ones leave by the shading normal.
#[inline]
#[must_use]
pub fn photon_factor(lobe: Lobe, incoming: Vec3, outgoing: Vec3, geometric: Vec3, shading: Vec3) -> f32 {
    if lobe == Lobe::Diffuse {
        return cosine_ratio(-incoming, geometric, shading);
    }
    let leaves = (outgoing.dot(geometric) * incoming.dot(shading)).abs();
    let arrives = (incoming.dot(geometric) * outgoing.dot(shading)).abs();
    if leaves < MAX_RATIO * arrives { leaves / arrives } else { MAX_RATIO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::sampling;

    fn tilted(degrees: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(sin, 0.0, cos)
    }

    /// G9: a uniform sky above a triangle with a tilted shading normal: π (1 + cos t)/2 less the share that the limit takes,
    /// which is .055, .215, .468 and .794 % at 15, 30, 45 and 60 degrees.
    #[test]
    fn even_sky_over_a_tilted_normal() {
        for (degrees, lost) in [(15.0, 0.000_549), (30.0, 0.002_151), (45.0, 0.004_679), (60.0, 0.007_935)] {
            let (geometric, shading) = (Vec3::Z, tilted(degrees));
            let n = 2000;
            let mut sum = 0.0_f64;
            for i in 0..n * n {
                // Heights are dense near the horizon, where the limit matters.
                let height = (f64::from(i % n) + 0.5) / f64::from(n);
                let turn = (f64::from(i / n) + 0.5) / f64::from(n);
                let direction = sampling::about(geometric, (1.0 - height * height * height) as f32, turn as f32);
                let found = cosine(direction, geometric, shading);
                let by_ratio = cosine_ratio(direction, geometric, shading) * direction.dot(geometric);
                assert!((found - by_ratio).abs() < 1e-6, "{direction}");
                sum += f64::from(found) * 3.0 * height * height;
            }
            let mean = sum / f64::from(n * n) * std::f64::consts::TAU;
            let tilt = f64::from(degrees).to_radians();
            let expected = std::f64::consts::PI * (1.0 + tilt.cos()) / 2.0 * (1.0 - lost);
            assert!((mean / expected - 1.0).abs() < 6e-5, "{degrees}: {mean} for {expected}");
        }
    }

    #[test]
    fn without_a_tilt_nothing_changes() {
        for z in [1e-6, 0.1, 0.7, 1.0_f32] {
            let direction = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            assert_eq!(cosine(direction, Vec3::Z, Vec3::Z), z);
            assert_eq!(cosine_ratio(direction, Vec3::Z, Vec3::Z), 1.0);
            assert_eq!(cosine_ratio(-direction, Vec3::Z, Vec3::Z), 0.0);
            let mirrored = Vec3::new(direction.x, 0.0, -z);
            let factor = photon_factor(Lobe::SpecularReflection, -direction, mirrored, Vec3::Z, Vec3::Z);
            assert_eq!(factor, 1.0);
        }
    }

    /// V12: a normal may point anywhere; the bent one is a unit vector on the side of the axis.
    #[test]
    fn bent_normals_are_on_the_side_of_the_axis() {
        for normal in [-Vec3::Z, Vec3::X, -Vec3::X, tilted(30.0), tilted(91.0), tilted(179.9)] {
            let bent = bend(normal, Vec3::Z);
            assert!((bent.length() - 1.0).abs() < 1e-6 && bent.z >= 0.9e-3, "{normal} {bent}");
        }
        assert_eq!(bend(tilted(30.0), Vec3::Z), tilted(30.0));
    }

    #[test]
    fn directions_stay_on_their_side() {
        let below = Vec3::new(0.6, 0.0, -0.8);
        let above = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(on_side_of(Lobe::SpecularReflection, below, Vec3::Z), above);
        assert_eq!(on_side_of(Lobe::SpecularReflection, above, Vec3::Z), above);
        assert_eq!(on_side_of(Lobe::SpecularTransmission, above, Vec3::Z), below);
        assert_eq!(on_side_of(Lobe::SpecularTransmission, below, Vec3::Z), below);
    }
}
