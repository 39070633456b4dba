use std::f64::consts::PI;

use super::*;
use crate::random::{SplitMix64, unit_f32};

/// Density in double precision by the cosine, from the definitions.
fn exact(phase: Phase, cosine: f64) -> f64 {
    let hg = |g: f64| (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
    match phase {
        Phase::HenyeyGreenstein(g) => hg(f64::from(g)),
        Phase::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
        Phase::Mie(mie) => {
            let [forward, g, alpha, share] = [mie.forward, mie.draine, mie.alpha, mie.share].map(f64::from);
            let factor = (1.0 + alpha * cosine * cosine) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
            (1.0 - share) * hg(forward) + share * hg(g) * factor
        }
    }
}

/// Integral of the density times a function of the cosine, by the midpoint rule with steps that are fine at the poles.
fn integral(phase: Phase, of: impl Fn(f64) -> f64) -> f64 {
    let (steps, side) = (200_000, if phase.mean_cosine() < 0.0 { -1.0 } else { 1.0 });
    let term = |step: u32| {
        let t = (f64::from(step) + 0.5) / f64::from(steps);
        // cos = ±(1 − 2t⁴): versine 2t⁴ has the measure 8t³ dt.
        let cosine = side * (1.0 - 2.0 * t.powi(4));
        2.0 * PI * exact(phase, cosine) * of(cosine) * 8.0 * t.powi(3) / f64::from(steps)
    };
    (0..steps).map(term).sum()
}

fn all() -> Vec<Phase> {
    let hg = [0.0, 1e-8, -1e-8, 0.3, -0.6, 0.9, 0.99, -0.999].map(Phase::HenyeyGreenstein);
    let mie = [5.0, 10.0, 20.0, 50.0].map(|d| Phase::Mie(Mie::droplets(d)));
    hg.into_iter().chain([Phase::Rayleigh]).chain(mie).collect()
}

/// Values are those of the definitions, which integrate to 1 and have the mean cosine that is claimed.
#[test]
fn densities_integrate_to_one() {
    for phase in all() {
        assert!((integral(phase, |_| 1.0) - 1.0).abs() < 1e-6, "{phase:?}");
        assert!((integral(phase, |cosine| cosine) - f64::from(phase.mean_cosine())).abs() < 1e-6, "{phase:?}");
        for degrees in [0.0_f64, 1e-3, 0.1, 1.0, 30.0, 90.0, 139.0, 180.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let to = Vec3::new(sine as f32, cosine as f32, 0.0);
            let (found, expected) = (f64::from(phase.value(Vec3::Y, to)), exact(phase, cosine));
            assert!((found / expected - 1.0).abs() < 1e-5, "{phase:?} {degrees}: {found} {expected}");
            assert_eq!(phase.value(to, Vec3::Y).to_bits(), phase.value(Vec3::Y, to).to_bits());
        }
    }
    for versine in [0.0, 0.1, 1.0, 1.7, 2.0] {
        let even = Phase::HenyeyGreenstein(0.0).value(Vec3::X, Vec3::Y);
        assert_eq!(henyey_greenstein(0.0, versine).to_bits(), even.to_bits());
    }
    // Jendersie and d'Eon's parameters, evaluated by an independent program.
    for (diameter, mean) in [(5.0, 0.843_424_1), (10.0, 0.864_163_7), (20.0, 0.879_310_4), (50.0, 0.891_193_6)] {
        let found = Phase::Mie(Mie::droplets(diameter)).mean_cosine();
        assert!((found - mean).abs() < 2e-7, "{diameter}: {found}");
    }
    let square = integral(Phase::Rayleigh, |cosine| cosine * cosine);
    assert!((square - 0.4).abs() < 1e-9, "{square}");
}

#[test]
fn several_values_are_those_of_each() {
    let from = [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, -0.8), Vec3::NEG_Y].map(|v| v.to_array());
    for phase in all() {
        let values = phase.values(&[0, 1, 2].map(|c| from.map(|v| v[c])), Vec3::Y);
        assert_eq!(values, from.map(|from| phase.value(from.into(), Vec3::Y)), "{phase:?}");
    }
}

/// Largest deviation of sampled directions from the density, in standard errors: of ⟨cos⟩, ⟨cos²⟩, and of the shares beyond
/// several angles.
fn deviation(phase: Phase, sampled: Phase) -> f64 {
    const N: u32 = 200_000;
    let mut numbers = SplitMix64(5);
    let mut next = || [0; 2].map(|_: i32| unit_f32(numbers.word() as u32));
    let cosines: Vec<f64> = (0..N).map(|_| f64::from(sampled.sample(Vec3::Y, next()).dot(Vec3::Y))).collect();
    let beyond = |bound: f64| move |cosine: f64| f64::from(u8::from(cosine < bound));
    let shares =
        [0.999, 0.99, 0.9, 0.5, 0.0, -0.5, -0.9].map(|bound| Box::new(beyond(bound)) as Box<dyn Fn(f64) -> f64>);
    let moments: [Box<dyn Fn(f64) -> f64>; 2] = [Box::new(|cosine| cosine), Box::new(|cosine| cosine * cosine)];
    let z = |of: &dyn Fn(f64) -> f64| {
        let sum = |power: i32| cosines.iter().map(|&cosine| of(cosine).powi(power)).sum::<f64>() / f64::from(N);
        let expected = integral(phase, of);
        // Of the expected distribution, so that an empty sample counts; rounded cosines move a few samples over a bound.
        let variance = (integral(phase, |cosine| of(cosine).powi(2)) - expected * expected).max(0.0);
        (sum(1) - expected).abs() / ((variance / f64::from(N)).sqrt() + 1e-6)
    };
    moments.iter().chain(&shares).map(|of| z(of)).fold(0.0, f64::max)
}

/// |z| ≤ 4.5; and samples of another function are found out.
#[test]
fn samples_follow_the_density() {
    for phase in all() {
        let z = deviation(phase, phase);
        assert!(z <= 4.5, "{phase:?}: {z}");
    }
    let [five, six] = [5.0, 6.0].map(|d| Phase::Mie(Mie::droplets(d)));
    for (phase, other) in [(Phase::Rayleigh, Phase::HenyeyGreenstein(0.0)), (five, six)] {
        assert!(deviation(phase, other) > 4.5, "{phase:?} {other:?}");
    }
}

/// The distribution function is inverted to single precision, and directions are finite, for all numbers.
#[test]
fn samples_invert_the_distribution() {
    // c³ + 3c = 8u − 4.
    assert!((rayleigh_versine(0.9) - (1.0 - 0.856_918_7)).abs() < 1e-6);
    let last = 1.0 - f32::EPSILON / 2.0;
    for phase in all() {
        for u in [0.0, 1e-9, 0.25, 0.5, 0.75, last] {
            assert!(phase.sample(Vec3::X, [u, 0.3]).is_normalized(), "{phase:?} {u}");
        }
    }
    for diameter in [5.0, 7.0, 10.0, 20.0, 50.0] {
        let mie = Mie::droplets(diameter);
        let [g, alpha] = [mie.draine, mie.alpha].map(f64::from);
        let middle = 1.0 + g * g;
        // ∫ (1 + α c²)/s² ds, c = (1 + g² − s²)/2g.
        let antiderivative = |s: f64| {
            let quarter = alpha / (4.0 * g * g);
            -(1.0 + quarter * middle * middle) / s - 2.0 * quarter * middle * s + quarter * s.powi(3) / 3.0
        };
        let (first, end) = (1.0 - g, 1.0 + g);
        let share =
            |s: f64| (antiderivative(s) - antiderivative(first)) / (antiderivative(end) - antiderivative(first));
        for step in 0..=4000 {
            let u = step as f32 / 4000.0;
            let versine = f64::from(mie::draine_versine(mie.draine, mie.alpha, u));
            let s = (first * first + 2.0 * g * versine).sqrt();
            assert!((share(s) - f64::from(u)).abs() < 1e-6, "{diameter} {u}: {versine}");
        }
    }
}
