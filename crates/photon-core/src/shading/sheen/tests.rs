use glam::Vec3;

use super::*;
use crate::random::{SplitMix64, unit_f32};
use crate::scene::material::{Material, MaterialKind};
use crate::shading::glossy::{Coat, Glossy};

const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);

/// Estevez and Kulla 2017 in double precision, without the limit.
fn lobe(roughness: f64, o: f64, i: f64, turn: f64) -> f64 {
    let alpha = roughness * roughness;
    let t = (1.0 - alpha).powi(2);
    let mix = |one: f64, zero: f64| one * (1.0 - t) + zero * t;
    let exponent = |x: f64| {
        mix(21.5473, 25.3245) / (1.0 + mix(3.82987, 3.32435) * x.powf(mix(0.19823, 0.16801)))
            + mix(-1.97760, -1.27393) * x
            + mix(-4.32054, -4.85967)
    };
    let lambda = |x: f64| {
        if x < 0.5 { exponent(x).exp() } else { (2.0 * exponent(0.5) - exponent(1.0 - x)).exp() }
    };
    let across = ((1.0 - o * o) * (1.0 - i * i)).sqrt() * (std::f64::consts::TAU * turn).cos();
    let sine_squared = (1.0 - (o + i).powi(2) / (2.0 + 2.0 * (across + o * i))).max(0.0);
    let distribution = (2.0 + 1.0 / alpha) * sine_squared.powf(0.5 / alpha) / std::f64::consts::TAU;
    distribution / ((1.0 + lambda(o) + lambda(i)) * 4.0 * o * i)
}

fn number(numbers: &mut SplitMix64) -> f32 {
    unit_f32(numbers.word() as u32)
}

/// A direction in the frame of the normal.
fn direction(cosine: f32, turn: f32) -> Vec3 {
    sampling::about(Vec3::Z, 1.0 - cosine, turn)
}

fn cloth(color: [f32; 3]) -> Material {
    Material { kind: MaterialKind::Glossy as u32, albedo: color, ior: 1.5, roughness: 1.0, ..Material::default() }
}

/// The table against quadratures of other nodes than its own, where the albedo is below 1.
#[test]
fn albedos_are_those_of_the_lobe() {
    let table = SheenTable::get();
    let mut numbers = SplitMix64(5);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for _ in 0..400 {
        let roughness = f64::from(MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * number(&mut numbers).powi(2));
        let cosine = f64::from(number(&mut numbers).powi(3).max(2e-3));
        let (across, around) = (260, 36);
        let sum: f64 = (0..across * around)
            .map(|k| {
                let root = (f64::from(k % across) + 0.5) / f64::from(across);
                let turn = 0.5 * (f64::from(k / across) + 0.5) / f64::from(around);
                lobe(roughness, cosine, root * root, turn) * root * root * 2.0 * root
            })
            .sum();
        let expected = sum * std::f64::consts::TAU / f64::from(across * around);
        if expected < 1.0 {
            let found = f64::from(table.directional(cosine as f32, roughness as f32));
            worst = worst.max((found - expected).abs());
            compared += 1;
        }
    }
    assert!(compared > 300 && worst < 2.5e-3, "{worst} of {compared}");
}

/// Values are those in double precision, times the limit; the same with both directions exchanged.
#[test]
fn the_lobe_is_that_of_the_paper_and_reciprocal() {
    let mut numbers = SplitMix64(7);
    for _ in 0..2000 {
        let mut next = || number(&mut numbers);
        let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * next();
        let (o, i) = (direction(0.02 + 0.98 * next(), 0.0), direction(0.02 + 0.98 * next(), next()));
        let h = (o + i).normalize_or(Vec3::Z);
        let (there, back) = (Charlie::new(roughness, o.z), Charlie::new(roughness, i.z));
        let value = there.evaluate(o, i, h);
        let turn = f64::from(i.y.atan2(i.x)) / std::f64::consts::TAU;
        let expected = lobe(roughness.into(), o.z.into(), i.z.into(), turn);
        let greatest = there.albedo.max(back.albedo).max(1.0);
        let expected = expected / f64::from(greatest);
        // Rounding of 1 − h.z², up to 2⁻²³, times the exponent.
        let relative = 2e-3 * f64::from(1.0 + (1.0 - h.z * h.z).recip() * 1e-3);
        assert!((f64::from(value) - expected).abs() <= relative * expected + 1e-6, "{o} {i}: {value} for {expected}");
        assert!((value - back.evaluate(i, o, h)).abs() <= 1e-5 * value, "{o} {i}");
    }
}

/// The whole surface is reciprocal, with a clearcoat or without, but for the packed factor of the base.
#[test]
fn surfaces_are_reciprocal() {
    let mut numbers = SplitMix64(11);
    for _ in 0..500 {
        let mut above = || sampling::about(NORMAL, 0.97 * number(&mut numbers), number(&mut numbers));
        let (wo, wi) = (above(), above());
        let material = Material { metallic: 0.4, roughness: 0.6, specular: 1.0, ..cloth([0.8, 0.5, 0.1]) };
        for clearcoat in [0.0, 0.7] {
            let layers = Layers::NONE.with_sheen(Vec3::new(0.9, 0.4, 0.2), 0.4).with_clearcoat(clearcoat, 0.3);
            let of = |a: Vec3, b: Vec3| {
                let glossy = Glossy::new(&material, &layers, a.dot(NORMAL));
                glossy.evaluate(a, b, NORMAL).value / b.dot(NORMAL)
            };
            let (there, back) = (of(wo, wi), of(wi, wo));
            assert!((there - back).abs().max_element() <= 2e-4 * there.max_element(), "{there} {back}");
        }
    }
}

/// White diffuse surfaces send back what arrives; at grazing angles of narrow lobes, and where a reflection is below, less.
#[test]
fn white_surfaces_lose_nothing() {
    let white = cloth([1.0; 3]);
    let metal = Material { metallic: 1.0, roughness: 0.5, ..white };
    let plastic = Material { specular: 1.0, roughness: 0.5, ..white };
    for (material, roughness, cosine, least) in [
        (white, 0.5, 0.8, 1.0),
        (white, 0.25, 0.1, 1.0),
        (white, 1.0, 0.02, 1.0),
        (white, 0.1, 0.05, 0.9),
        (plastic, 0.6, 0.3, 0.99),
        (metal, 0.6, 0.6, 0.8),
    ] {
        let layers = Layers::NONE.with_sheen(Vec3::ONE, roughness);
        let wo = sampling::about(NORMAL, 1.0 - cosine, 0.3);
        let glossy = Glossy::new(&material, &layers, cosine);
        let n = 160;
        let (mut sum, mut entering) = (0.0_f64, 0.0_f64);
        for k in 0..n * n {
            // Cosines are dense where directions graze.
            let root = ((k % n) as f32 + 0.5) / n as f32;
            let height = root * root;
            let wi = sampling::about(NORMAL, 1.0 - height, ((k / n) as f32 + 0.5) / n as f32);
            let weight = f64::from(2.0 * root) / f64::from(n * n);
            sum += f64::from(glossy.evaluate(wo, wi, NORMAL).value.x) * weight * std::f64::consts::TAU;
            entering += f64::from(glossy.coat().entering(height) * 2.0 * height) * weight;
        }
        assert!((entering - 1.0).abs() < 2e-3, "{roughness}: {entering}");
        let total = sum + f64::from(glossy.diffuse().x) * entering;
        assert!(total > least - 4e-3 && total < 1.0 + 4e-3, "{roughness} {cosine}: {total}");
    }
}

/// The density of sampled directions: the mean of 1/pdf over samples is the solid angle that they cover.
#[test]
fn samples_have_their_density() {
    let layers = Layers::NONE.with_sheen(Vec3::new(1.0, 0.5, 0.5), 0.6).with_clearcoat(0.5, 0.8);
    let material = Material { metallic: 1.0, roughness: 0.9, ..cloth([0.9; 3]) };
    let wo = sampling::about(NORMAL, 0.4, 0.1);
    let glossy = Glossy::new(&material, &layers, wo.dot(NORMAL));
    assert!(glossy.sheen_probability() > 0.05 && glossy.sheen_probability() < 0.95);
    let mut numbers = SplitMix64(3);
    let n = 200_000;
    let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
    for _ in 0..n {
        let (wi, found) = glossy.sample(wo, NORMAL, number(&mut numbers), number(&mut numbers));
        let value = if found.pdf > 0.0 && wi.dot(NORMAL) > 0.0 { 1.0 / f64::from(found.pdf) } else { 0.0 };
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(n);
    let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
    assert!((mean - std::f64::consts::TAU).abs() < 4.5 * error && error < 0.05, "{mean} ± {error}");
}

/// No coat without a sheen is taken for one with a sheen, nor one layout for the other.
#[test]
fn packed_words_are_distinct() {
    let mut numbers = SplitMix64(9);
    for _ in 0..20_000 {
        let mut next = || number(&mut numbers);
        let f90 = next();
        let (roughness, f0) = (next(), f90 * next());
        assert!(!is_packed(Coat::new(roughness, f0, f90).bits()), "{f0} {f90}");
        let clearcoat = Clearcoat { weight: 0.01 + 0.99 * next(), roughness: next() };
        let coated = crate::clearcoat::pack(roughness, f0, f90, clearcoat);
        assert!(!is_packed(coated) && crate::clearcoat::is_packed(coated));
        let layers = Layers::NONE.with_sheen(Vec3::splat(0.05 + 0.95 * next()), next());
        let sheen = Sheen::of(&layers, 0.5).unwrap();
        for clearcoat in [clearcoat, Clearcoat::default()] {
            let bits = pack(roughness, f0, f90, &sheen, clearcoat);
            assert!(is_packed(bits) && !crate::clearcoat::is_packed(bits), "{bits:x}");
            assert_eq!(bits & MARKS[0][0] == MARKS[0][1], clearcoat.weight == 0.0);
        }
    }
}

/// Degenerate parameters and directions are finite.
#[test]
fn all_is_finite() {
    for roughness in [0.0, 1e-4, MIN_ROUGHNESS, 1.0] {
        for color in [0.0, 1e-8, 1.0] {
            let layers = Layers::NONE.with_sheen(Vec3::splat(color), roughness);
            for cosine in [1e-7_f32, 1e-3, 0.5, 1.0] {
                let wo = sampling::about(NORMAL, 1.0 - cosine, 0.2);
                let glossy = Glossy::new(&cloth([0.0; 3]), &layers, cosine);
                for wi in [NORMAL, wo, -wo, sampling::about(NORMAL, 1.0 - 1e-6, 0.7)] {
                    let found = glossy.evaluate(wo, wi, NORMAL);
                    assert!(found.value.is_finite() && found.value.min_element() >= 0.0, "{found:?}");
                    assert!(found.pdf.is_finite());
                }
                let (wi, found) = glossy.sample(wo, NORMAL, 0.999_999_94, 0.5);
                assert!(wi.is_finite() && found.weight(1.0).is_finite());
                assert!(glossy.coat().entering(cosine).is_finite());
            }
        }
    }
}
