//! Energy, reciprocity and sampling of surfaces with a clearcoat.

use std::f32::consts::TAU;

use super::*;
use crate::Lobe;
use crate::random::{SplitMix64, unit_f32};
use crate::shading::glossy::tests::white_share;
use crate::shading::glossy::{Coat, Glossy};
use crate::shading::{sampling, shading_normal};

fn material(metallic: f32, specular: f32, roughness: f32) -> Material {
    let (kind, ior) = (MaterialKind::Glossy as u32, 1.5);
    Material { kind, albedo: [1.0; 3], metallic, roughness, specular, ior, ..Material::default() }
}

fn towards(cosine: f32, turns: f32) -> Vec3 {
    sampling::about(Vec3::Z, 1.0 - cosine, turns)
}

/// A normal at this angle to +z; 0 for the angle 0.
fn tilted(angle: f32) -> Vec3 {
    if angle == 0.0 { Vec3::ZERO } else { Vec3::new(0.8 * angle.sin(), -0.6 * angle.sin(), angle.cos()) }
}

/// Under a clearcoat with a normal of its own, white metals still gain nothing; white diffuse surfaces gain or lose at most
/// what the albedos of the clearcoat for both normals differ by.
#[test]
fn tilted_coats_gain_little() {
    for angle in [0.1, 0.5] {
        for cosine in [1.0_f32, 0.6, 0.2] {
            let (coat, wo) = (tilted(angle), towards(cosine, 0.3));
            let layers = Layers::NONE.with_clearcoat(1.0, 0.3).with_coat_normal(coat);
            let through = |cosine: f32| f64::from(Clearcoat::of(&layers).through(cosine));
            let differs = through(cosine) - through(wo.dot(coat).max(shading_normal::MIN_COSINE));
            for (metallic, specular, gain) in [(1.0, 1.0, 0.0), (0.0, 0.0, differs.max(0.0))] {
                let glossy = Glossy::at(&material(metallic, specular, 0.5), &layers, cosine, wo, false);
                let (whole, error) = white_share(&glossy, cosine, 20_000);
                assert!(whole < 1.0 + gain + 4.5 * error + 3e-3, "{angle}, {cosine}, {metallic}: {whole}, {gain}");
            }
        }
    }
}

/// Light that photons carry from one direction to another is what camera paths see of it (Veach 1997, section 5.3).
#[test]
fn photons_and_camera_paths_agree_on_tilted_coats() {
    let geometric = Vec3::new(0.1, 0.2, 0.97).normalize_or(Vec3::Z);
    let layers = Layers::NONE.with_clearcoat(0.8, 0.4).with_coat_normal(tilted(0.4));
    let material = Material { albedo: [0.9, 0.5, 0.2], ..material(0.7, 1.0, 0.6) };
    for (light, eye) in [((0.9, 0.1), (0.5, 0.6)), ((0.3, 0.85), (0.8, 0.4)), ((0.6, 0.3), (0.6, 0.31))] {
        let ([light, eye], cosines) = ([light, eye].map(|(cosine, turns)| towards(cosine, turns)), [light.0, eye.0]);
        let seen = Glossy::at(&material, &layers, cosines[1], eye, false).evaluate(eye, light, Vec3::Z).value;
        let carried = Glossy::at(&material, &layers, cosines[0], light, true).evaluate(light, eye, Vec3::Z).value;
        let factor = shading_normal::photon_factor(Lobe::SpecularReflection, -light, eye, geometric, Vec3::Z);
        let carried = carried * factor * (light.dot(geometric) / eye.dot(geometric));
        assert!(((seen - carried) / seen).abs().max_element() < 1e-4, "{seen} {carried}");
        // Not so with the cosines of camera paths.
        let wrong = Glossy::at(&material, &layers, cosines[0], light, false).evaluate(light, eye, Vec3::Z).value;
        let wrong = wrong * factor * (light.dot(geometric) / eye.dot(geometric));
        assert!(((seen - wrong) / seen).abs().max_element() > 1e-3, "{seen} {wrong}");
    }
}

/// White diffuse surfaces lose nothing, white metals and all else at most 5.3 %, and nothing gains light.
#[test]
fn white_surfaces_gain_nothing_and_lose_little() {
    let surfaces = [
        (material(0.0, 0.0, 1.0), 1.0),
        (material(1.0, 1.0, 0.1), 0.947),
        (material(1.0, 1.0, 0.8), 0.947),
        (material(0.0, 1.0, 0.2), 0.96),
        (material(0.5, 1.0, 0.6), 0.947),
    ];
    for (material, least) in surfaces {
        for (weight, roughness) in [(1.0, 0.0), (1.0, 0.4), (0.5, 1.0)] {
            for cosine in [1.0_f32, 0.5, 0.15] {
                let layers = Layers::NONE.with_clearcoat(weight, roughness);
                let glossy = Glossy::new(&material, &layers, cosine);
                let (whole, error) = white_share(&glossy, cosine, 20_000);
                let allowed = 4.5 * error + 3e-3;
                let what = format!("{material:?}, weight {weight}, roughness {roughness}, cos {cosine}: {whole}");
                assert!(whole > least - allowed && whole < 1.0 + allowed, "{what}");
            }
        }
    }
}

#[test]
fn reflection_and_base_are_reciprocal() {
    for (metallic, roughness, above) in [(1.0, 0.5, 0.2), (0.0, 0.3, 0.6), (0.5, 1.0, 0.1)] {
        let material = Material { albedo: [0.9, 0.5, 0.2], ..material(metallic, 1.0, roughness) };
        let layers = Layers::NONE.with_clearcoat(0.8, above);
        for (a, b) in [(0.9_f32, 0.3_f32), (0.5, 0.05), (0.99, 0.98)] {
            let (wo, wi) = (towards(a, 0.1), towards(b, 0.63));
            let (one, other) = (Glossy::new(&material, &layers, a), Glossy::new(&material, &layers, b));
            let there = one.evaluate(wo, wi, Vec3::Z).value / b;
            let back = other.evaluate(wi, wo, Vec3::Z).value / a;
            assert!(((there - back) / there).abs().max_element() < 1e-4, "{there} {back}");
            let base = one.diffuse() * one.coat().entering(b);
            let base_back = other.diffuse() * other.coat().entering(a);
            // Steps of the packed parameters.
            assert!((base - base_back).abs().max_element() <= 1e-2 * base.max_element(), "{base} {base_back}");
        }
    }
}

/// χ² of sampled directions against the integral of the density, in cells of cosine and azimuth.
#[test]
fn directions_are_sampled_by_their_density() {
    const ROWS: usize = 8;
    const COLUMNS: usize = 8;
    for (metallic, roughness, above, tilt) in [(1.0, 0.7, 0.45, 0.0), (0.0, 0.5, 0.9, 0.0), (1.0, 0.7, 0.45, 0.4)] {
        let wo = towards(0.6, 0.2);
        let layers = Layers::NONE.with_clearcoat(1.0, above).with_coat_normal(tilted(tilt));
        let glossy = Glossy::at(&material(metallic, 1.0, roughness), &layers, 0.6, wo, false);
        let n = 200_000;
        let mut counts = [0.0_f64; ROWS * COLUMNS];
        let mut numbers = SplitMix64(11);
        let mut number = || unit_f32(numbers.word() as u32);
        for _ in 0..n {
            let (u, v) = (number(), number());
            let (wi, _) = glossy.sample(wo, Vec3::Z, u, v);
            if wi.z > 0.0 {
                let turns = (wi.y.atan2(wi.x) / TAU).rem_euclid(1.0);
                let cell = |x: f32, cells: usize| ((x * cells as f32) as usize).min(cells - 1);
                counts[cell(wi.z, ROWS) * COLUMNS + cell(turns, COLUMNS)] += 1.0;
            }
        }
        let statistic = |fault: f64| {
            let mut sum = 0.0;
            for (at, &count) in counts.iter().enumerate() {
                let fine = 24;
                let mut expected = 0.0;
                for k in 0..fine * fine {
                    let z = ((at / COLUMNS) as f32 + ((k % fine) as f32 + 0.5) / fine as f32) / ROWS as f32;
                    let phi = TAU * ((at % COLUMNS) as f32 + ((k / fine) as f32 + 0.5) / fine as f32) / COLUMNS as f32;
                    let across = (1.0 - z * z).sqrt();
                    let wi = Vec3::new(across * phi.cos(), across * phi.sin(), z);
                    expected += f64::from(glossy.evaluate(wo, wi, Vec3::Z).pdf);
                }
                expected *= f64::from(TAU) / (ROWS * COLUMNS * fine * fine) as f64 * f64::from(n) * fault;
                sum += (count - expected) * (count - expected) / expected;
            }
            sum
        };
        let degrees = (ROWS * COLUMNS) as f64;
        let most = degrees + 4.5 * (2.0 * degrees).sqrt();
        assert!(statistic(1.0) < most, "metallic {metallic}: {} of {most}", statistic(1.0));
        assert!(statistic(1.03) > most, "a density that is off is found");
    }
}

/// Light that enters has the mean 1 over the hemisphere; packed coats are distinguished from others.
#[test]
fn coats_are_packed() {
    for (f0, f90) in [(0.0, 0.0), (0.04, 1.0), (0.3, 0.6)] {
        let clearcoat = Clearcoat { weight: 0.9, roughness: 0.35 };
        let bits = pack(0.45, f0, f90, clearcoat);
        assert!(is_packed(bits));
        let coat = Coat::from_bits(bits);
        let n = 4000;
        // Uniform in the squared cosine.
        let at = |k: i32| ((k as f32 + 0.5) / n as f32).sqrt();
        let mean = (0..n).map(|k| f64::from(coat.entering(at(k)))).sum::<f64>() / f64::from(n);
        assert!((mean - 1.0).abs() < 2e-3, "{mean}");
        let table = AlbedoTable::get();
        let both = |cosine: f32| {
            let albedo = table.directional(cosine, 0.45);
            (1.0 - (f0 * albedo.x + f90 * albedo.y)) * clearcoat.through(cosine)
        };
        let exact = (0..n).map(|k| both(at(k))).sum::<f32>() / n as f32;
        for cosine in [1.0, 0.6, 0.2, 0.05] {
            let (found, expected) = (coat.entering(cosine), both(cosine) / exact);
            assert!((found - expected).abs() < 1e-2, "F0 {f0}, cosine {cosine}: {found} {expected}");
        }
    }
    for k in 0..=64 {
        for part in 0..=64 {
            let f90 = k as f32 / 64.0;
            assert!(!is_packed(Coat::new(0.7, f90 * part as f32 / 64.0, f90).bits()), "{f90} {part}");
        }
    }
}
