//! Metals as `conductor` and `roughconductor`.

use photon_core::{Material, ggx};

use super::rgb;

/// Width above which multiple scattering, which Mitsuba leaves out, is more than 1 % of the light.
const NOTABLE: f32 = 0.1;
/// Brightest reflectance at normal incidence; 1 has no finite index.
const BRIGHTEST: f64 = 0.9999;

/// The BSDF of a glossy material that is all metal, and what differs from this renderer.
pub(super) fn rough_metal(name: &str, material: &Material, warnings: &mut Vec<String>) -> String {
    let alpha = (material.roughness * material.roughness).max(ggx::MIN_ALPHA);
    let indices = indices(name, material, warnings);
    if alpha > NOTABLE {
        warnings.push(format!(
            "material '{name}' has no multiple scattering in Mitsuba, and is darker there: its distribution has the width \
             {alpha}"
        ));
    }
    format!(
        "<bsdf type=\"twosided\"><bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"ggx\"/><float \
         name=\"alpha\" value=\"{alpha}\"/>{indices}</bsdf></bsdf>"
    )
}

/// The BSDF of a mirror that reflects as a metal.
pub(super) fn smooth_metal(name: &str, material: &Material, warnings: &mut Vec<String>) -> String {
    let indices = indices(name, material, warnings);
    format!("<bsdf type=\"twosided\"><bsdf type=\"conductor\">{indices}</bsdf></bsdf>")
}

/// Refractive indices of a metal of this colour, and how Mitsuba's reflectance differs.
fn indices(name: &str, material: &Material, warnings: &mut Vec<String>) -> String {
    warnings.push(format!(
        "material '{name}' reflects by the Fresnel equations in Mitsuba, here by Schlick's approximation; they differ by up \
         to 0.06 at grazing angles"
    ));
    let indices = material.albedo.map(|reflectance| index(f64::from(reflectance)));
    rgb("eta", indices.map(|(eta, _)| eta)) + &rgb("k", indices.map(|(_, k)| k))
}

/// Complex refractive index η + ik of a metal with this reflectance r at normal incidence, after Gulbrandsen (2014). The
/// edge tint is chosen such that the reflectance is near `r + (1 − r)(1 − cos θ)⁵` at other angles: weighted by the
/// cosine, within 0.025 root mean square.
fn index(reflectance: f64) -> (f64, f64) {
    let r = reflectance.clamp(0.0, BRIGHTEST);
    let tint = 1.0 - (1.0 - r).powf(2.75);
    let root = r.sqrt();
    let eta = tint * (1.0 - r) / (1.0 + r) + (1.0 - tint) * (1.0 + root) / (1.0 - root);
    let squared = (r * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - r);
    (eta, squared.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unpolarised reflectance of a conductor (Born and Wolf 1999, section 14.2).
    fn fresnel((eta, k): (f64, f64), cosine: f64) -> f64 {
        let sine2 = 1.0 - cosine * cosine;
        let t0 = eta * eta - k * k - sine2;
        let sum = (t0 * t0 + 4.0 * eta * eta * k * k).sqrt();
        let a = (0.5 * (sum + t0)).max(0.0).sqrt();
        let (t1, t2) = (sum + cosine * cosine, 2.0 * a * cosine);
        let s = (t1 - t2) / (t1 + t2);
        let (t3, t4) = (cosine * cosine * sum + sine2 * sine2, t2 * sine2);
        0.5 * s * (1.0 + (t3 - t4) / (t3 + t4))
    }

    #[test]
    fn indices_give_the_reflectance() {
        for r in [0.0, 0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0] {
            let index = index(r);
            assert!(index.0 > 0.0 && index.0.is_finite() && index.1.is_finite(), "{r}: {index:?}");
            assert!((fresnel(index, 1.0) - r).abs() < 2e-4, "{r}: {index:?}");
            if r == 0.0 {
                continue;
            }
            let n = 200;
            let error = |k: i32| {
                let cosine = (f64::from(k) + 0.5) / f64::from(n);
                let schlick = r + (1.0 - r) * (1.0 - cosine).powi(5);
                (fresnel(index, cosine) - schlick).powi(2) * 2.0 * cosine
            };
            let error = ((0..n).map(error).sum::<f64>() / f64::from(n)).sqrt();
            assert!(error < 0.025, "{r}: {index:?}, {error}");
        }
    }
}
