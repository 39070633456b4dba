//! Reflection and refraction at smooth boundaries.

use glam::Vec3;

/// Reflectance of a smooth boundary seen from one side, and the cosine of the refracted ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fresnel {
    /// Reflected share of unpolarised power, in `[0, 1]`.
    pub reflectance: f32,
    /// Cosine between the refracted ray and the normal; 0 at total internal reflection.
    pub cos_transmitted: f32,
}

/// Fresnel's equations for cosine `cos_incident` ≥ 0 and `eta` > 0, the refractive index behind the
/// boundary divided by that before it (Born and Wolf 1999, section 1.5).
#[inline]
#[must_use]
pub fn fresnel(cos_incident: f32, eta: f32) -> Fresnel {
    let c = cos_incident.clamp(0.0, 1.0);
    if eta == 1.0 {
        // No boundary. Also avoids 0/0 at grazing angles.
        return Fresnel { reflectance: 0.0, cos_transmitted: c };
    }
    // eta² − sin² in a form without cancellation for almost equal indices, for grazing angles, and for
    // normal incidence on a medium whose index is close to 0.
    let discriminant = if eta < 0.5 { eta * eta - (1.0 - c) * (1.0 + c) } else { (eta - 1.0) * (eta + 1.0) + c * c };
    if discriminant <= 0.0 {
        return Fresnel { reflectance: 1.0, cos_transmitted: 0.0 };
    }
    let eta_cos_t = discriminant.sqrt();
    let cos_t = eta_cos_t / eta;
    let s = (c - eta_cos_t) / (c + eta_cos_t);
    let p = (eta * c - cos_t) / (eta * c + cos_t);
    Fresnel { reflectance: (0.5 * (s * s + p * p)).clamp(0.0, 1.0), cos_transmitted: cos_t.min(1.0) }
}

/// Reflectance of a thin sheet including all interreflections between its two faces, `2R/(1+R)`, for the
/// reflectance `R` of one face.
#[inline]
#[must_use]
pub fn sheet_reflectance(single: f32) -> f32 {
    2.0 * single / (1.0 + single)
}

/// `(1 − cos θ)⁵`, by which the reflectance of a metal rises from that at normal incidence to 1 (Schlick 1994,
/// equation 15).
#[inline]
#[must_use]
pub fn schlick_rise(cosine: f32) -> f32 {
    let across = 1.0 - cosine.clamp(0.0, 1.0);
    let square = across * across;
    square * square * across
}

/// The mirror direction of `direction` at `normal`; both unit vectors.
#[inline]
#[must_use]
pub fn reflect(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * (2.0 * direction.dot(normal))).normalize_or(normal)
}

/// The refracted direction (Snell). `normal` points to the side that the ray comes from; `cos_transmitted`
/// is that of [`fresnel`].
#[inline]
#[must_use]
pub fn refract(direction: Vec3, normal: Vec3, eta: f32, cos_transmitted: f32) -> Vec3 {
    if eta == 1.0 {
        return direction;
    }
    let c = -direction.dot(normal);
    (direction / eta + normal * (c / eta - cos_transmitted)).normalize_or(direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn reflectance(degrees: f64, eta: f32) -> f64 {
        f64::from(fresnel(degrees.to_radians().cos() as f32, eta).reflectance)
    }

    /// T1, T2, N3, S12, S13.
    #[test]
    fn closed_forms() {
        for (n, r) in [(1.33, 0.020_059_3), (1.5, 0.04), (2.4, 0.169_550_2), (1000.0, 0.996_008_0), (1.0, 0.0)] {
            assert_abs_diff_eq!(reflectance(0.0, n), r, epsilon = 1e-6);
        }
        for (angle, r) in [(45.0, 0.050_239_9), (85.0, 0.612_799_6), (56.309_932, 0.073_964_5)] {
            assert_abs_diff_eq!(reflectance(angle, 1.5), r, epsilon = 2e-6);
        }
        assert_abs_diff_eq!(reflectance(89.99, 1.5), 0.998_986, epsilon = 1e-5);
        assert!(reflectance(41.80, 1.0 / 1.5) < 1.0 && reflectance(41.82, 1.0 / 1.5) == 1.0);
        assert_eq!(fresnel(0.0, 1.0).reflectance, 0.0);
    }

    #[test]
    fn snell() {
        let d = Vec3::new(1.0, 0.0, -1.0).normalize();
        let f = fresnel(-d.dot(Vec3::Z), 1.5);
        let t = refract(d, Vec3::Z, 1.5, f.cos_transmitted);
        assert_abs_diff_eq!(f64::from(t.x).asin().to_degrees(), 28.125_506, epsilon = 1e-4);
        assert_eq!(refract(d, Vec3::Z, 1.0, 0.3), d);
    }

    #[test]
    fn extremes_stay_in_range() {
        for eta in [1e-6_f32, 1e-3, 0.999_999_9, 1.000_000_1, 1e3, 1e6, 1e18] {
            for c in [0.0_f32, 1e-30, 1e-4, 0.5, 1.0] {
                let f = fresnel(c, eta);
                assert!((0.0..=1.0).contains(&f.reflectance), "{eta} {c} {f:?}");
                assert!((0.0..=1.0).contains(&f.cos_transmitted), "{eta} {c} {f:?}");
            }
        }
    }

    /// T4, without absorption.
    #[test]
    fn sheet_of_glass() {
        assert_abs_diff_eq!(sheet_reflectance(0.04), 0.076_923_1, epsilon = 1e-6);
    }
}
