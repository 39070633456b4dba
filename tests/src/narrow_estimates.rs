//! G7: the variance of what a reflection reads from photons.

use std::f64::consts::{PI, TAU};

use photon_core::glam::{DVec3, Vec3};
use photon_core::{
    EstimateParams, IndexKind, Layers, Material, MaterialKind, Photon, Query, ReflectionLobe, Search, octahedral,
};

use crate::gloss_reference::{Reference, half_vectors};
use crate::harness::{TestBackend, Uniform, estimate, photon_at, query_at};
use crate::stats::{SIGMAS, assert_agrees, moments, standard_error};

/// Queries, each of which reads photons of its own.
const SIDE: u32 = 64;
const RADIUS: f64 = 0.3 / SIDE as f64;

/// From the reference's frame, whose normal is +y, to that of queries, +z.
fn upright(w: DVec3) -> DVec3 {
    DVec3::new(w.z, w.x, w.y)
}

/// Of one photon in light from all directions, whose directions have the density cos/π: mean and mean square of the BSDF,
/// by a quadrature over half vectors.
fn of_one_photon(reference: &Reference, alpha: f64, o: DVec3) -> [f64; 2] {
    let grid = (1200, 192);
    let mut sums = [0.0; 2];
    for h in half_vectors(alpha, grid) {
        let (across, i) = (o.dot(h), h * (2.0 * o.dot(h)) - o);
        if across > 0.0 && i.y > 0.0 {
            let density = alpha * alpha / (PI * (h.x * h.x + h.z * h.z + alpha * alpha * h.y * h.y).powi(2)) * h.y;
            let (f, solid) = (reference.f(o, i), 4.0 * across / density);
            sums = [sums[0] + f * i.y * solid, sums[1] + f * f * i.y * solid];
        }
    }
    sums.map(|sum| sum / PI / f64::from(grid.0 * grid.1))
}

/// `k` photons in the disc around each query, in light from all directions.
fn photons(k: u32, uniform: &mut Uniform) -> (Vec<Photon>, Vec<[f32; 2]>) {
    let (mut photons, mut centres) = (Vec::new(), Vec::new());
    for query in 0..SIDE * SIDE {
        let centre = [query % SIDE, query / SIDE].map(|at| (f64::from(at) + 0.5) / f64::from(SIDE) - 0.5);
        centres.push(centre.map(|at| at as f32));
        for _ in 0..k {
            let (distance, turns) = (0.99 * RADIUS * uniform.draw().sqrt(), TAU * uniform.draw());
            let at = [centre[0] + distance * turns.cos(), centre[1] + distance * turns.sin()].map(|at| at as f32);
            let (square, turns) = (uniform.draw(), TAU * uniform.draw());
            let (cosine, sine) = ((1.0 - square).sqrt(), square.sqrt());
            let from = DVec3::new(sine * turns.cos(), sine * turns.sin(), cosine).as_vec3();
            photons.push(Photon { direction: octahedral::pack(from), ..photon_at([at[0], at[1], 0.0]) });
        }
    }
    (photons, centres)
}

/// G7: a reflection of the BSDF f that reads k photons of an even light has the relative variance `(1/κ − 1)/k`, where
/// `κ = (∫ f cos)²/(π ∫ f² cos)`: that of the mean of k independent values of f. The standard error of a variance is
/// `√((m₄ − m₂²)/n)`, of the fourth and second moments of n queries.
pub fn g7_variance_of_narrow_reflections<T: TestBackend>() {
    let mut uniform = Uniform::new(7);
    for (alpha, cosine, k) in [(0.1_f64, 0.8, 256), (0.4, 0.6, 48)] {
        let color = 0.8;
        let reference = Reference::new(alpha, 1.0, color);
        let o = DVec3::new((1.0_f64 - cosine * cosine).sqrt(), cosine, 0.0);
        let [mean, square] = of_one_photon(&reference, alpha, o);
        let kappa = mean * mean / square;
        let (kind, roughness) = (MaterialKind::Glossy as u32, alpha.sqrt() as f32);
        let albedo = [color as f32; 3];
        let material =
            Material { kind, albedo, metallic: 1.0, roughness, specular: 1.0, ior: 1.5, ..Material::default() };
        let (words, factor) = ReflectionLobe::pack(&material, &Layers::default());
        let (photons, centres) = photons(k, &mut uniform);
        let queries: Vec<Query> = centres
            .iter()
            .map(|&[x, y]| Query {
                media: words[0],
                coat: words[1],
                offset_or_wo: octahedral::pack(upright(o).as_vec3()),
                shading_normal: octahedral::pack(Vec3::Z),
                ..query_at([x, y, 0.0], RADIUS as f32)
            })
            .collect();
        let params = EstimateParams { reflection: true, ..EstimateParams::new(Search::Radius) };
        let found: Vec<f64> = estimate::<T>(IndexKind::Morton, &photons, &queries, &params)
            .iter()
            .map(|estimate| {
                assert_eq!(estimate.photons, k);
                f64::from(estimate.flux[0] * factor.x) / f64::from(k)
            })
            .collect();
        let what = format!("width {alpha}, kappa {kappa:.4}");
        // The tables of what single scattering loses.
        assert_agrees(&what, moments(&found).0, mean, standard_error(&found), 2.5e-3 * mean);
        let (average, variance) = moments(&found);
        let fourth = found.iter().map(|value| (value - average).powi(4)).sum::<f64>() / found.len() as f64;
        let error = ((fourth - variance * variance) / found.len() as f64).sqrt();
        let truth = mean * mean * (1.0 / kappa - 1.0) / f64::from(k);
        // Twice that of the mean, squared.
        assert_agrees(&format!("{what}, variance"), variance, truth, error, 5e-3 * truth);
        for wrong in [1.3 * truth, mean * mean / f64::from(k)] {
            assert!((variance - wrong).abs() > SIGMAS * error + 5e-3 * wrong, "{what}: {variance} {wrong} {error}");
        }
    }
}
