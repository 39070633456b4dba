//! The GGX distribution of microfacet normals (Walter et al. 2007), and sampling of reflections by its visible normals.
//!
//! Directions are unit vectors in a frame whose z axis is the surface normal. `alpha` is the width of the distribution,
//! in `[MIN_ALPHA, 1]`: the square of a perceptual roughness.

use glam::Vec3;

use crate::shading::math::sin_cos_turns;

/// The least width: reflections are then blurred by less than 0.06 degrees, and `f32` still resolves the distribution.
pub const MIN_ALPHA: f32 = 1e-3;

/// Density of microfacet normals at `h`, per solid angle and projected area (Walter et al. 2007, equation 33). The sine
/// comes from x and y, since 1 − z² consists of rounding errors for a narrow distribution.
#[inline]
#[must_use]
pub fn distribution(alpha: f32, h: Vec3) -> f32 {
    let squared = alpha * alpha;
    let root = h.x * h.x + h.y * h.y + squared * (h.z * h.z);
    squared / (std::f32::consts::PI * (root * root))
}

/// `√(α² + (1 − α²) cos²)`, which masking and the sampling density are computed from.
#[inline]
#[must_use]
pub fn spread(alpha: f32, cosine: f32) -> f32 {
    let squared = alpha * alpha;
    (squared + (1.0 - squared) * (cosine * cosine)).sqrt()
}

/// `G2 / (4 cos_o cos_i)` with the height-correlated masking and shadowing of Smith (Heitz 2014, equation 99); both
/// cosines above 0.
#[inline]
#[must_use]
pub fn visibility(alpha: f32, cos_o: f32, cos_i: f32) -> f32 {
    0.5 / (cos_o * spread(alpha, cos_i) + cos_i * spread(alpha, cos_o))
}

/// The factor k of a bounded spherical cap (Eto and Tokuyoshi 2023, equation 5).
#[inline]
fn bound(alpha: f32, o: Vec3) -> f32 {
    let squared = alpha * alpha;
    let s = 1.0 + (o.x * o.x + o.y * o.y).sqrt();
    let s = s * s;
    (1.0 - squared) * s / (s + squared * (o.z * o.z))
}

/// The reflection of `o` at a visible normal (Dupuy and Benyoub 2023, with the bound of Eto and Tokuyoshi 2023); it may
/// lie below the surface. `u` and `v` are uniform in `[0, 1)`; `o.z` > 0.
#[inline]
#[must_use]
pub fn sample(alpha: f32, o: Vec3, u: f32, v: f32) -> Vec3 {
    let h = normal_on_cap(alpha, o, bound(alpha, o), u, v);
    h * (2.0 * o.dot(h)) - o
}

/// A microfacet normal as seen from `o` (Dupuy and Benyoub 2023), of density `D max(o·h, 0) 2 / (o.z + spread(o.z))` per
/// solid angle. `u` and `v` are uniform in `[0, 1)`; `o.z` > 0.
#[inline]
#[must_use]
pub fn visible_normal(alpha: f32, o: Vec3, u: f32, v: f32) -> Vec3 {
    normal_on_cap(alpha, o, 1.0, u, v)
}

/// A microfacet normal from a point of a spherical cap, which reaches `bound` times as far down as that of all visible
/// normals.
#[inline]
fn normal_on_cap(alpha: f32, o: Vec3, bound: f32, u: f32, v: f32) -> Vec3 {
    let (x, y) = (alpha * o.x, alpha * o.y);
    let inverse = 1.0 / (x * x + y * y + o.z * o.z).sqrt();
    let top = o.z * inverse;
    let b = bound * top;
    // 1 − z, of which the sine is computed too: from z it would consist of rounding errors near the pole.
    let versine = u * (1.0 + b);
    let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
    let z = 1.0 - versine;
    let (sin, cos) = sin_cos_turns(v);
    let h = Vec3::new(alpha * (sine * cos + x * inverse), alpha * (sine * sin + y * inverse), z + top);
    h.normalize_or(Vec3::Z)
}

/// Density per solid angle of the directions of [`sample`] (Eto and Tokuyoshi 2023, equation 8); `h` is the half vector
/// of `o` and the direction.
#[inline]
#[must_use]
pub fn pdf(alpha: f32, o: Vec3, h: Vec3) -> f32 {
    distribution(alpha, h) / (2.0 * (bound(alpha, o) * o.z + spread(alpha, o.z)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards(cosine: f32) -> Vec3 {
        Vec3::new(0.6 * (1.0 - cosine * cosine).sqrt(), 0.8 * (1.0 - cosine * cosine).sqrt(), cosine)
    }

    /// The projected area of all microfacets is 1: ∫ D(h) (h·n) dω = 1.
    #[test]
    fn microfacets_cover_the_surface() {
        for alpha in [1e-3_f32, 0.1, 0.5, 1.0] {
            let n = 200_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    // The substitution tan θ = α tan ψ spreads the peak out.
                    let psi = (f64::from(i) + 0.5) / f64::from(n) * std::f64::consts::FRAC_PI_2;
                    let tan = f64::from(alpha) * psi.tan();
                    let cosine = 1.0 / (1.0 + tan * tan).sqrt();
                    let sine = tan * cosine;
                    let h = Vec3::new(sine as f32, 0.0, cosine as f32);
                    let step = f64::from(alpha) / (psi.cos().powi(2)) * cosine * cosine;
                    f64::from(distribution(alpha, h)) * cosine * sine * std::f64::consts::TAU * step
                })
                .sum();
            let whole = sum * std::f64::consts::FRAC_PI_2 / f64::from(n);
            assert!((whole - 1.0).abs() < 1e-4, "{alpha}: {whole}");
        }
    }

    /// The density of the samples is [`pdf`]: the mean of 1/pdf over samples above the surface is the solid angle of the
    /// hemisphere where the distribution is wide.
    #[test]
    fn densities_are_those_of_the_samples() {
        for (alpha, cosine) in [(0.3_f32, 0.9_f32), (0.5, 0.2), (1.0, 0.7), (1.0, 0.01)] {
            let o = towards(cosine);
            let n = 400;
            let (mut sum, mut above) = (0.0_f64, 0);
            for i in 0..n * n {
                let (u, v) = ((((i % n) as f32) + 0.5) / n as f32, (((i / n) as f32) + 0.5) / n as f32);
                let direction = sample(alpha, o, u, v);
                assert!((direction.length() - 1.0).abs() < 1e-5);
                if direction.z > 0.0 {
                    above += 1;
                    // Tested against cos³, so that directions that are hardly ever sampled do not count.
                    let h = (o + direction).normalize();
                    sum += f64::from(direction.z.powi(3) / pdf(alpha, o, h));
                }
            }
            let (expected, found) = (std::f64::consts::TAU / 4.0, sum / f64::from(n * n));
            assert!((found / expected - 1.0).abs() < 0.02, "{alpha} {cosine}: {found} for {expected}, {above} above");
        }
    }

    /// V2, V3: the narrowest distribution at the most grazing directions stays finite, and weights lie in [0, 1].
    #[test]
    fn weights_are_at_most_one() {
        for alpha in [MIN_ALPHA, 1.001e-3, 0.05, 0.4, 1.0] {
            assert!(distribution(alpha, Vec3::Z) <= 1.000_01 / (std::f32::consts::PI * alpha * alpha));
            for cosine in [1e-7_f32, 1e-3, 0.1, 0.5, 1.0] {
                let o = towards(cosine);
                for i in 0..1000 {
                    let direction = sample(alpha, o, (i as f32 + 0.5) / 1000.0, ((i * 379) % 1000) as f32 / 1000.0);
                    if direction.z > 0.0 {
                        let h = (o + direction).normalize();
                        let value = distribution(alpha, h) * visibility(alpha, o.z, direction.z) * direction.z;
                        let weight = value / pdf(alpha, o, h);
                        assert!((0.0..=1.001).contains(&weight), "{alpha} {cosine}: {weight}");
                    }
                }
            }
        }
    }
}
