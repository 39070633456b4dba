//! Twins of `photon_core::{fresnel, sampling}`, written from the formulas rather than from the code.

use photon_core::glam::DVec3;
use std::f64::consts::TAU;

/// Reflectance and cosine of the refracted ray, by Fresnel and Snell; `eta` is the ratio of the transmitted to the
/// incident index.
#[must_use]
pub fn fresnel(cosine: f64, eta: f64) -> (f64, f64) {
    if eta == 1.0 {
        return (0.0, cosine);
    }
    let c = cosine.clamp(0.0, 1.0);
    let discriminant = (eta - 1.0) * (eta + 1.0) + c * c;
    if discriminant <= 0.0 {
        return (1.0, 0.0);
    }
    let t = discriminant.sqrt() / eta;
    let s = (c - eta * t) / (c + eta * t);
    let p = (eta * c - t) / (eta * c + t);
    (0.5 * (s * s + p * p), t.min(1.0))
}

/// Reflectance of a thin sheet, with all reflections between its faces.
#[must_use]
pub fn sheet(single: f64) -> f64 {
    2.0 * single / (1.0 + single)
}

/// The direction of mirror reflection.
#[must_use]
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    (direction - normal * (2.0 * direction.dot(normal))).normalize_or_zero()
}

/// The refracted direction; `normal` points to the side that the ray comes from.
#[must_use]
pub fn refract(direction: DVec3, normal: DVec3, eta: f64, cos_transmitted: f64) -> DVec3 {
    if eta == 1.0 {
        return direction;
    }
    let cosine = -direction.dot(normal);
    (direction / eta + normal * (cosine / eta - cos_transmitted)).normalize_or_zero()
}

/// The same tangent basis as in f32: it determines how random numbers map to directions.
#[must_use]
pub fn basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// The direction with `sine` and `cosine` relative to the axis, `turns` around it.
#[must_use]
pub fn around(axis: DVec3, sine: f64, cosine: f64, turns: f64) -> DVec3 {
    let (s, c) = (turns * TAU).sin_cos();
    let (tangent, bitangent) = basis(axis);
    (tangent * (sine * c) + bitangent * (sine * s) + axis * cosine).normalize_or_zero()
}

/// A sample of the hemisphere with density cos θ/π.
#[must_use]
pub fn cosine_hemisphere(n: DVec3, u: f64, v: f64) -> DVec3 {
    around(n, u.sqrt(), (1.0 - u).sqrt(), v)
}

/// A sample of the sphere with density 1/4π.
#[must_use]
pub fn uniform_sphere(u: f64, v: f64) -> DVec3 {
    around(DVec3::Z, 2.0 * (u * (1.0 - u)).sqrt(), 1.0 - 2.0 * u, v)
}

/// The direction at `u` of `versine`, and `v` of a turn, from an axis.
#[must_use]
pub fn within_cone(axis: DVec3, versine: f64, u: f64, v: f64) -> DVec3 {
    let within = u * versine;
    around(axis, (within * (2.0 - within)).sqrt(), 1.0 - within, v)
}

/// The angle between two unit vectors, accurate for very small angles.
#[must_use]
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_core::glam::Vec3;
    use photon_core::{fresnel as narrow_fresnel, sampling};

    /// Both implement the same functions: f32 differs by rounding only.
    #[test]
    fn twins_of_the_shipped_functions() {
        for i in 0..1000_u32 {
            let (u, v) = ((i * 37 % 1000) as f32 / 1000.0, i as f32 / 1000.0);
            let n = sampling::uniform_sphere(v, u);
            let axis = n.as_dvec3().normalize_or_zero();
            let wide = cosine_hemisphere(axis, u.into(), v.into());
            assert!(angle(sampling::cosine_hemisphere(n, u, v).as_dvec3(), wide) < 2e-6);
            assert!(angle(sampling::uniform_sphere(u, v).as_dvec3(), uniform_sphere(u.into(), v.into())) < 2e-6);
            for eta in [1.5_f32, 1.0 / 1.5, 1.0] {
                let (r, t) = fresnel(u.into(), eta.into());
                let narrow = narrow_fresnel::fresnel(u, eta);
                assert!((f64::from(narrow.reflectance) - r).abs() < 1e-5, "{u} {eta}");
                assert!((f64::from(narrow.cos_transmitted) - t).abs() < 1e-3, "{u} {eta}");
            }
            let down = Vec3::new(0.6 * u, 0.0, -1.0).normalize_or_zero();
            let mirrored = narrow_fresnel::reflect(down, Vec3::Z).as_dvec3();
            assert!(angle(mirrored, reflect(down.as_dvec3().normalize_or_zero(), DVec3::Z)) < 1e-6);
        }
        assert!((sheet(0.04) - 0.076_923_077).abs() < 1e-9);
    }

    /// Negative control: an index that differs by a thousandth is detected.
    #[test]
    fn another_index_is_not_the_same() {
        let down = DVec3::new(0.6, 0.0, -0.8);
        let of = |eta: f64| refract(down, DVec3::Z, eta, fresnel(0.8, eta).1);
        assert!(angle(of(1.5), of(1.5015)) > 2e-4);
    }
}
