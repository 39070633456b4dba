use std::f64::consts::PI;

use glam::DVec3;

use super::*;
use crate::random::{SplitMix64, unit_f32};
use crate::scene::material::{Material, MaterialKind};
use crate::shading::albedo_table::AlbedoTable;
use crate::shading::glossy::{Glossy, limited};
use crate::shading::reflection_lobe::ReflectionLobe;

const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);
const WIDTHS: [Vec2; 6] = [
    Vec2::new(0.6, 0.1),
    Vec2::new(0.1, 0.6),
    Vec2::new(1.0, 0.02),
    Vec2::new(1.0, ggx::MIN_ALPHA),
    Vec2::splat(0.3),
    Vec2::splat(ggx::MIN_ALPHA),
];

fn towards(cosine: f32, turns: f32) -> Vec3 {
    let (sin, cos) = sin_cos_turns(turns);
    let sine = (1.0 - cosine * cosine).sqrt();
    Vec3::new(sine * cos, sine * sin, cosine)
}

/// Microfacet density, and density of sampled directions, in double precision.
fn exact(widths: Vec2, o: DVec3, h: DVec3) -> [f64; 2] {
    let (x, y) = (f64::from(widths.x), f64::from(widths.y));
    let d = 1.0 / (PI * x * y * ((h.x / x).powi(2) + (h.y / y).powi(2) + h.z * h.z).powi(2));
    let (least, s) = (x.min(y), 1.0 + o.x.hypot(o.y));
    let k = (1.0 - least * least) * s * s / (s * s + least * least * o.z * o.z);
    [d, d / (2.0 * (k * o.z + DVec3::new(x * o.x, y * o.y, o.z).length()))]
}

fn metal(roughness: f32) -> Material {
    let kind = MaterialKind::Glossy as u32;
    Material { kind, albedo: [1.0; 3], metallic: 1.0, roughness, specular: 1.0, ior: 1.5, ..Material::default() }
}

/// V2, V3: values against double precision, finite up to the narrowest widths; weights are at most 1.
#[test]
fn densities_are_those_of_double_precision() {
    let mut numbers = SplitMix64(1);
    let mut number = || unit_f32(numbers.word() as u32);
    for widths in WIDTHS {
        for cosine in [1e-7_f32, 1e-3, 0.1, 0.5, 0.9, 1.0] {
            for _ in 0..28_000 {
                let o = towards(cosine, number());
                let i = sample(widths, o, number(), number());
                assert!((i.length() - 1.0).abs() < 1e-5);
                if i.z <= 0.0 {
                    continue;
                }
                let h = (o + i).normalize_or(Vec3::Z);
                let (value, density) = (distribution(widths, h), pdf(widths, o, h));
                let [d, p] = exact(widths, o.as_dvec3(), h.as_dvec3());
                assert!((f64::from(value) / d - 1.0).abs() < 1e-5, "{widths}: {value} {d}");
                assert!((f64::from(density) / p - 1.0).abs() < 1e-5, "{widths}: {density} {p}");
                let weight = value * visibility(widths, o, i) * i.z / density;
                assert!((0.0..=1.001).contains(&weight), "{widths} {cosine}: {weight}");
            }
        }
    }
}

/// Equal widths: the isotropic functions.
#[test]
fn equal_widths_are_isotropic() {
    for alpha in [ggx::MIN_ALPHA, 0.25, 1.0] {
        let widths = Vec2::splat(alpha);
        for k in 0..100 {
            let (u, v) = ((k as f32 + 0.5) / 100.0, ((k * 37) % 100) as f32 / 100.0);
            let o = towards(u, v);
            let (i, other) = (sample(widths, o, v, u), ggx::sample(alpha, o, v, u));
            assert!((i - other).length() < 1e-5, "{i} {other}");
            let h = (o + other).normalize_or(Vec3::Z);
            let close = |a: f32, b: f32| assert!((a / b - 1.0).abs() < 1e-4, "{alpha}: {a} {b}");
            close(distribution(widths, h), ggx::distribution(alpha, h));
            close(pdf(widths, o, h), ggx::pdf(alpha, o, h));
            let i = towards(v.max(0.01), u);
            close(visibility(widths, o, i), ggx::visibility(alpha, o.z, i.z));
        }
        assert!((equivalent_roughness(widths) - alpha.sqrt()).abs() < 1e-6);
    }
}

/// χ² per degree of freedom, less 1, in standard deviations, of directions sampled with `drawn` against the density for
/// `widths`, over bins of equal solid angle above the surface; and the integral of the density there less their share.
fn chi_square(drawn: Vec2, widths: Vec2, o: Vec3) -> (f64, f64) {
    const HEIGHTS: usize = 12;
    const TURNS: usize = 24;
    const FINE: usize = 24;
    let count = 100_000;
    let mut numbers = SplitMix64(7);
    let mut number = || unit_f32(numbers.word() as u32);
    let mut found = [[0_u32; TURNS]; HEIGHTS];
    for _ in 0..count {
        let i = sample(drawn, o, number(), number());
        if i.z > 0.0 {
            let turns = i.y.atan2(i.x) / std::f32::consts::TAU;
            let column = ((turns + 1.0).fract() * TURNS as f32) as usize;
            found[((i.z * HEIGHTS as f32) as usize).min(HEIGHTS - 1)][column.min(TURNS - 1)] += 1;
        }
    }
    let (mut sum, mut bins, mut whole) = (0.0, 0, 0.0);
    for (row, counts) in found.iter().enumerate() {
        for (column, &bin) in counts.iter().enumerate() {
            let mut density = 0.0;
            for k in 0..FINE * FINE {
                let part = |k: usize| (k as f32 + 0.5) / FINE as f32;
                let height = (row as f32 + part(k / FINE)) / HEIGHTS as f32;
                let i = towards(height, (column as f32 + part(k % FINE)) / TURNS as f32);
                density += f64::from(pdf(widths, o, (o + i).normalize_or(Vec3::Z)));
            }
            let share = density * 2.0 * PI / (HEIGHTS * TURNS * FINE * FINE) as f64;
            whole += share;
            let expected = share * f64::from(count);
            if expected > 10.0 {
                sum += (f64::from(bin) - expected).powi(2) / expected;
                bins += 1;
            }
        }
    }
    let above = f64::from(found.as_flattened().iter().sum::<u32>()) / f64::from(count);
    ((sum - f64::from(bins)) / (2.0 * f64::from(bins)).sqrt(), whole - above)
}

#[test]
fn sampled_directions_have_their_density() {
    for (widths, cosine) in [(WIDTHS[0], 0.9_f32), (WIDTHS[0], 0.3), (WIDTHS[1], 0.5), (Vec2::new(1.0, 0.15), 0.7)] {
        let o = towards(cosine, 0.15);
        let (deviations, whole) = chi_square(widths, widths, o);
        assert!(deviations.abs() < 4.5 && whole.abs() < 6e-3, "{widths} {cosine}: {deviations} {whole}");
        // Exchanged widths are found.
        assert!(chi_square(Vec2::new(widths.y, widths.x), widths, o).0 > 100.0);
    }
}

/// Single-scattering albedo of a perfect reflector.
fn albedo(widths: Vec2, o: Vec3) -> f64 {
    let n = 24;
    let at = |k: u32| (k as f32 + 0.5) / n as f32;
    let weight = |k: u32| {
        let i = sample(widths, o, at(k / n), at(k % n));
        let h = (o + i).normalize_or(Vec3::Z);
        if i.z > 0.0 {
            f64::from(distribution(widths, h) * visibility(widths, o, i) * i.z / pdf(widths, o, h))
        } else {
            0.0
        }
    };
    (0..n * n).map(weight).sum::<f64>() / f64::from(n * n)
}

/// What the equivalent roughness costs: a white metal reflects 1 plus these differences of albedos. In the mean over the
/// hemisphere they are small; at grazing directions, they are not.
#[test]
fn albedos_are_near_those_of_the_equivalent_roughness() {
    let table = AlbedoTable::get();
    let (mut worst_mean, mut worst_geometric, mut low, mut high) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let (mut low_above, mut high_above) = (0.0_f64, 0.0_f64);
    for roughness in [0.1_f32, 0.2, 0.32, 0.45, 0.63, 0.8] {
        for strength in [0.3_f32, 0.6, 0.8, 1.0] {
            let widths = widths(roughness, strength);
            let equivalent = equivalent_roughness(widths);
            let mut mean = 0.0;
            for k in 0..64 {
                let cosine = ((k / 8) as f32 + 0.5) / 8.0;
                let found = albedo(widths, towards(cosine, ((k % 8) as f32 + 0.5) / 32.0));
                mean += found * 2.0 * f64::from(cosine) / 64.0;
                let off = found - f64::from(table.directional(cosine, equivalent).element_sum());
                (low, high) = (low.min(off), high.max(off));
                if cosine > 0.3 {
                    (low_above, high_above) = (low_above.min(off), high_above.max(off));
                }
            }
            let mean_of = |roughness: f32| f64::from(table.mean(roughness).element_sum());
            worst_mean = worst_mean.max((mean - mean_of(equivalent)).abs());
            let geometric = (widths.x * widths.y).sqrt().sqrt();
            worst_geometric = worst_geometric.max((mean - mean_of(geometric)).abs());
        }
    }
    eprintln!("mean {worst_mean:.3}, geometric {worst_geometric:.3}; {low:.3} to {high:.3}");
    eprintln!("cosines above .3: {low_above:.3} to {high_above:.3}");
    assert!(worst_mean < 0.025, "{worst_mean}");
    assert!(low > -0.4 && high < 0.1, "{low} {high}");
    assert!(low_above > -0.15 && high_above < 0.1, "{low_above} {high_above}");
    // The usual geometric mean of the widths is much worse.
    assert!(worst_geometric > 0.2, "{worst_geometric}");
}

/// G6: photons and camera paths see the same BSDF, also with a base and a clearcoat.
#[test]
fn the_bsdf_is_reciprocal() {
    let mut numbers = SplitMix64(3);
    let mut number = || unit_f32(numbers.word() as u32);
    let (tangent, bitangent) = sampling::basis(NORMAL);
    for (metallic, clearcoat) in [(1.0, 0.0), (0.3, 0.0), (1.0, 0.8)] {
        let layers = Layers::NONE.with_anisotropy(0.7, tangent * 0.6 + bitangent * 0.8).with_clearcoat(clearcoat, 0.3);
        let material = Material { metallic, albedo: [0.9, 0.5, 0.2], ..metal(0.4) };
        for _ in 0..500 {
            let [a, b] = [(); 2].map(|()| sampling::about(NORMAL, 0.95 * number(), number()));
            let (to_a, to_b) = (a.dot(NORMAL), b.dot(NORMAL));
            let one = Glossy::new(&material, &layers, to_a).evaluate(a, b, NORMAL).value / to_b;
            let other = Glossy::new(&material, &layers, to_b).evaluate(b, a, NORMAL).value / to_a;
            assert!(((one - other).abs() / one.max(Vec3::splat(1e-3))).max_element() < 5e-5, "{one} {other}");
        }
    }
}

/// A white metal loses and gains what the test of albedos says, and the weights of sampled directions say the same.
#[test]
fn white_metal_reflects_nearly_all_light() {
    let (roughness, strength) = (0.4, 0.7);
    let layers = Layers::NONE.with_anisotropy(strength, Vec3::X);
    for (cosine, turns) in [(0.9_f32, 0.0_f32), (0.9, 0.25), (0.4, 0.0), (0.4, 0.25), (0.1, 0.1)] {
        let o = towards(cosine, turns);
        let glossy = Glossy::new(&metal(roughness), &layers, cosine);
        let n = 200;
        let part = |k: u32| (k as f32 + 0.5) / n as f32;
        let sum: f64 = (0..n * n)
            .map(|k| f64::from(glossy.sample(o, Vec3::Z, part(k / n), part(k % n)).1.weight(1.0).x))
            .sum::<f64>()
            / f64::from(n * n);
        let widths = widths(roughness, strength);
        let table = AlbedoTable::get().directional(cosine, equivalent_roughness(widths)).element_sum();
        let expected = 1.0 + albedo(widths, o) - f64::from(table);
        assert!((sum - expected).abs() < 4e-3, "{cosine} {turns}: {sum} for {expected}");
    }
}

/// The reflection is wider along the tangent: half vectors tilted that way are brighter.
#[test]
fn reflections_are_wider_along_the_tangent() {
    let layers = Layers::NONE.with_anisotropy(0.8, Vec3::new(3.0, 4.0, 0.0));
    let glossy = Glossy::new(&metal(0.3), &layers, 1.0);
    let at = |x: f32, y: f32| glossy.evaluate(Vec3::Z, Vec3::new(x, y, 1.0).normalize_or_zero(), Vec3::Z).value.x;
    assert!(at(0.3, 0.4) > 3.0 * at(-0.4, 0.3), "{} {}", at(0.3, 0.4), at(-0.4, 0.3));
    assert!((at(0.3, 0.4) / at(-0.3, -0.4) - 1.0).abs() < 1e-5);
}

/// V4: any tangent gives a frame.
#[test]
fn frames_are_orthonormal() {
    let infinite = Vec3::splat(f32::INFINITY);
    for tangent in [Vec3::X, NORMAL, -NORMAL, Vec3::ZERO, NORMAL + Vec3::X * 1e-4, Vec3::splat(f32::NAN), infinite] {
        let (x, y) = frame(tangent, NORMAL);
        for length in [x.length(), y.length(), x.cross(y).dot(NORMAL)] {
            assert!((length - 1.0).abs() < 1e-5, "{tangent}: {x} {y}");
        }
        assert!(x.dot(NORMAL).abs() < 1e-5 && y.dot(NORMAL).abs() < 1e-5, "{tangent}: {x} {y}");
    }
}

/// What queries carry: the lobe of a query is the surface's.
#[test]
fn packed_words_have_the_anisotropy() {
    let mut numbers = SplitMix64(5);
    let mut number = || unit_f32(numbers.word() as u32);
    let (x, y) = sampling::basis(NORMAL);
    for _ in 0..200 {
        let (sin, cos) = sin_cos_turns(number());
        let layers = Layers::NONE.with_anisotropy(number(), x * cos + y * sin);
        let word = pack(&layers, NORMAL);
        let (strength, tangent) = unpack(word, NORMAL).unwrap();
        assert!((strength - layers.anisotropy).abs() < 2e-5);
        assert!(tangent.dot(layers.tangent).abs() > 1.0 - 1e-6, "{tangent} for {}", layers.tangent);
        assert_eq!(path_word(17, word), word);
        let material = metal(0.3);
        let [wo, wi] = [(); 2].map(|()| sampling::about(NORMAL, 0.9 * number(), number()));
        let (words, factor) = ReflectionLobe::pack(&material, &layers);
        let weigh = |word: u32| {
            ReflectionLobe::with_anisotropy(words, word, wo, NORMAL).weight(wi, NORMAL) * factor * wi.dot(NORMAL)
        };
        let exact = Glossy::new(&material, &layers, wo.dot(NORMAL)).evaluate(wo, wi, NORMAL).value;
        let exact = exact * limited(wi, NORMAL, NORMAL);
        assert!((weigh(word) - exact).abs().max_element() < 2e-3 * exact.max_element().max(1e-2), "{exact}");
        // Another direction, or none, is not the same.
        if layers.anisotropy > 0.3 && exact.x > 0.02 {
            assert!((weigh(word ^ 0x8000) - exact).abs().max_element() > 1e-4 * exact.max_element(), "{exact}");
            assert!((weigh(17) - exact).abs().max_element() > 1e-4 * exact.max_element(), "{exact}");
        }
    }
    assert_eq!(pack(&Layers::NONE, NORMAL), 0);
    assert!(unpack(path_word(u32::MAX, 0), NORMAL).is_none());
}
