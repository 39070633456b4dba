//! Glossy surfaces in double precision, for the tests of `gloss.rs`.

use std::f64::consts::{PI, TAU};

use photon_core::glam::DVec3;
use photon_scene::{MaterialDesc, Surface};

/// The model in double precision, with albedos by quadrature instead of tables: normal +y.
#[derive(Debug)]
pub(crate) struct Reference {
    alpha: f64,
    metallic: f64,
    color: f64,
    /// E over the cosine, in steps of 1/256; once for the metal's factor of 1, once for the coat's F0 = .04.
    albedos: [Vec<f64>; 2],
    means: [f64; 2],
}

pub(crate) fn schlick(f0: f64, cosine: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cosine).max(0.0).powi(5)
}

/// Walter et al. 2007, equations 33 and 34, with Heitz 2014, equation 99: `D G2 / (4 cos_o cos_i)`.
pub(crate) fn single(alpha: f64, o: DVec3, i: DVec3) -> f64 {
    let h = (o + i).normalize_or_zero();
    let d = alpha * alpha / (PI * (h.x * h.x + h.z * h.z + alpha * alpha * h.y * h.y).powi(2));
    let lambda = |c: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
    d / (1.0 + lambda(o.y) + lambda(i.y)) / (4.0 * o.y * i.y)
}

/// Half vectors with the density D cos, normal +y: Walter et al. 2007, equation 35, on a grid.
pub(crate) fn half_vectors(alpha: f64, (across, around): (u32, u32)) -> impl Iterator<Item = DVec3> {
    (0..across * around).map(move |k| {
        let u = (f64::from(k % across) + 0.5) / f64::from(across);
        let phi = TAU * (f64::from(k / across) + 0.5) / f64::from(around);
        let tangent = alpha * (u / (1.0 - u)).sqrt();
        let up = 1.0 / (1.0 + tangent * tangent).sqrt();
        DVec3::new(up * tangent * phi.cos(), up, up * tangent * phi.sin())
    })
}

/// ∫ single scattering cos dω over half vectors: finer where the distribution is.
pub(crate) fn albedo(alpha: f64, cosine: f64, f0: f64) -> f64 {
    let o = DVec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
    let grid = (400, 96);
    let mut sum = 0.0;
    for h in half_vectors(alpha, grid) {
        let across = o.dot(h);
        let i = h * (2.0 * across) - o;
        if across > 0.0 && i.y > 0.0 {
            let d = alpha * alpha / (PI * (h.x * h.x + h.z * h.z + alpha * alpha * h.y * h.y).powi(2));
            sum += single(alpha, o, i) * i.y * schlick(f0, across) * 4.0 * across / (d * h.y);
        }
    }
    sum / f64::from(grid.0 * grid.1)
}

impl Reference {
    pub(crate) fn new(alpha: f64, metallic: f64, color: f64) -> Self {
        let albedos =
            [1.0, 0.04].map(|f0| (0..=256).map(|k| albedo(alpha, (f64::from(k) / 256.0).max(1e-3), f0)).collect());
        let mean = |e: &Vec<f64>| (0..256).map(|k| (e[k] + e[k + 1]) * ((k as f64 + 0.5) / 256.0)).sum::<f64>() / 256.0;
        let means = [mean(&albedos[0]), mean(&albedos[1])];
        Self { alpha, metallic, color, albedos, means }
    }

    fn albedo(&self, which: usize, cosine: f64) -> f64 {
        let at = cosine * 256.0;
        let first = (at as usize).min(255);
        let e = &self.albedos[which];
        e[first] + (e[first + 1] - e[first]) * (at - first as f64)
    }

    /// The BSDF of module `photon_core::glossy`, coat of index 1.5.
    pub(crate) fn f(&self, o: DVec3, i: DVec3) -> f64 {
        if o.y <= 0.0 || i.y <= 0.0 {
            return 0.0;
        }
        let m = self.metallic;
        let h = (o + i).normalize_or_zero();
        let fresnel = m * schlick(self.color, o.dot(h)) + (1.0 - m) * schlick(0.04, o.dot(h));
        let lost = |c: f64| 1.0 - self.albedo(0, c);
        let average = self.color + (1.0 - self.color) / 21.0;
        let mean = self.means[0];
        let repeated = average * average * mean / (1.0 - average * (1.0 - mean));
        let multiple = m * repeated * lost(o.y) * lost(i.y) / (PI * (1.0 - mean));
        let through = |c: f64| 1.0 - self.albedo(1, c);
        let base = (1.0 - m) * self.color / PI * through(o.y) * through(i.y) / (1.0 - self.means[1]);
        fresnel * single(self.alpha, o, i) + multiple + base
    }

    pub(crate) fn material(&self) -> MaterialDesc {
        let surface = Surface::Glossy {
            base_color: [self.color; 3],
            metallic: self.metallic,
            roughness: self.alpha.sqrt(),
            specular: 1.0,
            ior: 1.5,
        };
        MaterialDesc::new("glossy", surface)
    }
}
