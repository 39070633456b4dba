//! The model against its own albedo, reciprocity, and extremes.

use super::*;
use crate::random::{SplitMix64, unit_f32};
use crate::scene::material::MaterialKind;

fn material(metallic: f32, roughness: f32, color: [f32; 3]) -> Material {
    Material {
        kind: MaterialKind::Glossy as u32,
        albedo: color,
        metallic,
        roughness,
        specular: 1.0,
        ior: 1.5,
        ..Material::default()
    }
}

fn towards(cosine: f32, turns: f32) -> Vec3 {
    sampling::about(Vec3::Z, 1.0 - cosine, turns)
}

/// What all parts together reflect of an even white surrounding, red, by sampling the reflection, and the base with the
/// coat's factor on each direction; and its standard error √((⟨x²⟩ − ⟨x⟩²)/n).
pub(in crate::shading) fn white_share(glossy: &Glossy, cosine: f32, n: u32) -> (f64, f64) {
    let wo = towards(cosine, 0.3);
    let (mut sum, mut squares) = (0.0_f64, 0.0);
    let mut numbers = SplitMix64(5);
    let mut number = || unit_f32(numbers.word() as u32);
    for _ in 0..n {
        let (u, v) = (number(), number());
        let (wi, found) = glossy.sample(wo, Vec3::Z, u, v);
        let base = sampling::cosine_hemisphere(Vec3::Z, u, v);
        let whole = found.weight(limited(wi, Vec3::Z, Vec3::Z)).x + glossy.diffuse().x * glossy.coat().entering(base.z);
        sum += f64::from(whole);
        squares += f64::from(whole * whole);
    }
    let whole = sum / f64::from(n);
    (whole, ((squares / f64::from(n) - whole * whole) / f64::from(n)).max(0.0).sqrt())
}

/// G4: white surfaces reflect all of an even surrounding.
#[test]
fn white_surfaces_lose_nothing() {
    for roughness in [0.0_f32, 0.2, 0.5, 0.77, 1.0] {
        for metallic in [0.0, 0.4, 1.0] {
            for cosine in [1.0_f32, 0.5, 0.1] {
                let glossy = Glossy::new(&material(metallic, roughness, [1.0; 3]), &Layers::NONE, cosine);
                let (whole, error) = white_share(&glossy, cosine, 40_000);
                // Beside the standard error that of the tables.
                let allowed = 4.5 * error + 2.5e-3;
                assert!((whole - 1.0).abs() < allowed, "m {metallic}, r {roughness}, cos {cosine}: {whole}");
            }
        }
    }
}

/// G6: the reflection does not change if the two directions are exchanged.
#[test]
fn reflection_is_reciprocal() {
    for (metallic, roughness) in [(1.0, 0.1), (1.0, 0.6), (0.0, 0.3), (0.5, 1.0)] {
        let material = material(metallic, roughness, [0.9, 0.5, 0.2]);
        for (a, b) in [(0.9_f32, 0.3_f32), (0.5, 0.05), (0.99, 0.98)] {
            let (wo, wi) = (towards(a, 0.1), towards(b, 0.63));
            let one = Glossy::new(&material, &Layers::NONE, a);
            let other = Glossy::new(&material, &Layers::NONE, b);
            let there = one.evaluate(wo, wi, Vec3::Z).value / b;
            let back = other.evaluate(wi, wo, Vec3::Z).value / a;
            // Half vectors are rounded to 1e-7, which is 1e-5 of a width of .01, to the fourth power.
            assert!(((there - back) / there).abs().max_element() < 1e-4, "{there} {back}");
            let base = one.diffuse() * one.coat().entering(b);
            let base_back = other.diffuse() * other.coat().entering(a);
            assert!((base - base_back).abs().max_element() <= 2e-3 * base.max_element(), "{base} {base_back}");
        }
    }
}

#[test]
fn coats_are_packed_within_half_a_step() {
    let (roughness, f0, f90) = Coat::new(0.37, 0.04, 0.8).unpack();
    assert!((roughness - 0.37).abs() < 5e-4 && (f0 - 0.04).abs() < 1.3e-4 && (f90 - 0.8).abs() < 5e-4);
    assert_eq!(Coat::default().entering(0.3), 1.0);
    assert_eq!(Coat::new(0.4, 0.0, 0.0).entering(0.3), 1.0);
    // A coat that reflects everything leaves nothing for the base.
    let mirror = Coat::new(0.0, 1.0, 1.0).entering(0.5);
    assert!(mirror.is_finite() && mirror >= 0.0);
}

/// V3: grazing directions, the narrowest distributions and black surfaces are finite.
#[test]
fn extremes_are_finite() {
    for roughness in [0.0, 1e-4, 0.0316, 0.5, 1.0] {
        for (metallic, color) in [(1.0, [1.0; 3]), (0.0, [0.0; 3]), (1.0, [0.0; 3]), (0.3, [1e-20, 1.0, 0.5])] {
            for cosine in [1e-7_f32, 1e-3, 0.5, 1.0] {
                let glossy = Glossy::new(&material(metallic, roughness, color), &Layers::NONE, cosine);
                for k in 0..64 {
                    let (u, v) = (k as f32 / 64.0, ((k * 29) % 64) as f32 / 64.0);
                    let (wi, found) = glossy.sample(towards(cosine, 0.2), Vec3::Z, u, v);
                    let weight = found.weight(limited(wi, Vec3::Z, Vec3::Z));
                    assert!(
                        weight.is_finite() && weight.min_element() >= 0.0 && weight.max_element() < 4.0,
                        "{weight}"
                    );
                }
                assert!(glossy.diffuse().is_finite() && (0.0..=1.0).contains(&glossy.specular_probability()));
            }
        }
    }
}

#[test]
fn what_is_left_of_a_choice_is_uniform() {
    let n = 1000;
    let below: usize = (0..n).filter(|&k| rest_of((k as f32 + 0.5) / n as f32, 0.3) < 0.5).count();
    assert!(below.abs_diff(n / 2) <= 2, "{below}");
    assert!(rest_of(0.999_999_94, 0.3) < 1.0 && rest_of(0.0, 0.0) == 0.0);
}
