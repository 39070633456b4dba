//! Confidence intervals of known sums.

use super::*;
use crate::scene::units::Units;

#[test]
fn quantiles_of_the_tables() {
    for (freedom, t) in [(5.0, 2.5706), (7.0, 2.3646), (15.0, 2.1314), (63.0, 1.9983), (1e9, 1.959_964)] {
        assert!((student_975(freedom) - t).abs() < 1e-3, "{freedom}: {}", student_975(freedom));
    }
    assert_eq!(student_975(0.0), f64::INFINITY);
}

/// A film of one pixel after `passes` passes with known statistics.
fn film(passes: u32, biases: [f64; 2], map_moments: PhotonMoments) -> Film {
    let mut film = Film::new(1, 1, Units::default()).unwrap();
    let mut error = ErrorPixel::default();
    for pass in 0..passes {
        let sign = if pass % 2 == 0 { 1.0 } else { -1.0 };
        let radiance = 2.0 + 0.1 * sign;
        film.pixels[0].layers[3] = film.pixels[0].layers[3].map(|sum| sum + radiance);
        film.pixels[0].square += radiance * radiance;
        let jitter = 1.0 + 0.01 * sign;
        let (bias, narrow) = (biases[0] * jitter, biases[1] * jitter);
        error.end_pass(&ErrorPixel {
            bias,
            narrow,
            photon_moments: PerMap::from_fn(|kind| {
                if kind == MapKind::Global { map_moments } else { PhotonMoments::default() }
            }),
            ..ErrorPixel::default()
        });
    }
    film.passes = passes;
    film.errors = Some(vec![error]);
    film
}

const EVEN: PhotonMoments =
    PhotonMoments { power: 10.0, power_squared: 10.0, slope: [0.0; 2], quadrupole: [0.0; 2], stray: 0.0 };

#[test]
fn a_claim_is_noise_and_twice_the_bias() {
    let interval = film(16, [0.02, 0.01], EVEN).confidence_intervals().unwrap()[0];
    let noise = (0.01 * 16.0 / 15.0 / 16.0_f64).sqrt();
    assert!((interval.standard_error - noise).abs() < 1e-12 && (interval.value - 2.0).abs() < 1e-12, "{interval:?}");
    assert!((interval.bias - 0.02).abs() < 1e-12);
    assert!((interval.half_width - noise_width(student_975(15.0), noise, 2.0) - 0.04).abs() < 1e-12);
    assert!(film(16, [0.0; 2], EVEN).confidence_intervals().unwrap()[0].half_width < interval.half_width);
}

#[test]
fn each_reason_takes_the_claim_away() {
    let flags = |film: Film| {
        let interval = film.confidence_intervals().unwrap()[0];
        assert_eq!(interval.flags.is_empty(), interval.half_width.is_finite());
        interval.flags
    };
    let bent =
        |slope: f64, quadrupole: f64| PhotonMoments { slope: [0.0, slope], quadrupole: [-quadrupole, 0.0], ..EVEN };
    assert!(flags(film(8, [0.02, 0.01], EVEN)).is_empty());
    assert_eq!(flags(film(7, [0.02, 0.01], EVEN)), Flags::FEW_PASSES);
    assert_eq!(flags(film(8, [0.0; 2], PhotonMoments { power: 3.0, power_squared: 3.0, ..EVEN })), Flags::FEW_PHOTONS);
    assert_eq!(flags(film(8, [0.0; 2], PhotonMoments { stray: 1.0, ..EVEN })), Flags::OTHER_SURFACE);
    assert_eq!(flags(film(8, [0.0; 2], bent(2.6, 0.0))), Flags::UNEVEN);
    assert!(flags(film(8, [0.0; 2], bent(2.4, 0.0))).is_empty());
    assert_eq!(flags(film(64, [0.0; 2], bent(0.0, 0.8))), Flags::UNEVEN);
    assert!(flags(film(8, [0.0; 2], bent(0.0, 0.8))).is_empty());
    assert_eq!(flags(film(8, [0.02, 0.03], EVEN)), Flags::CURVED);
    assert_eq!(flags(film(8, [0.02, 0.001], EVEN)), Flags::CURVED);
}

/// Of an exponential distribution, σ = μ and γ = 2, the mean of 16 draws is within the interval in 95 % of the cases, or
/// more; with Student's t alone in fewer. Binomial: standard error √(.95·.05/4000) = .0034.
#[test]
fn skewed_noise_is_within_its_interval() {
    let mut random = crate::random::SplitMix64(7);
    let (mut covered, mut plain, trials, draws) = (0, 0, 4000, 16);
    for _ in 0..trials {
        let (mut sum, mut square) = (0.0, 0.0);
        for _ in 0..draws {
            let x = -libm::log(1.0 - random.unit_f64());
            sum += x;
            square += x * x;
        }
        let n = f64::from(draws);
        let error = ((square - sum * sum / n) / (n * (n - 1.0))).sqrt();
        let off = (sum / n - 1.0_f64).abs();
        covered += u32::from(off <= noise_width(student_975(n - 1.0), error, sum / n));
        plain += u32::from(off <= student_975(n - 1.0) * error);
    }
    let share = |count: u32| f64::from(count) / f64::from(trials);
    assert!(share(covered) > 0.95 - 4.5 * 0.0034, "{}", share(covered));
    assert!(share(plain) < 0.95 - 4.5 * 0.0034, "{}", share(plain));
}

/// Light at an edge: a part of the interval if there is little of it, else a reason not to have one.
#[test]
fn little_light_at_an_edge_is_bounded() {
    let of = |other: f64, map_moments: PhotonMoments| {
        let mut film = film(16, [0.0; 2], map_moments);
        film.pixels[0].layers[0] = [16.0 * other; 3];
        film.confidence_intervals().unwrap()[0]
    };
    let stray = PhotonMoments { stray: 1.0, ..EVEN };
    let minor = of(39.0, stray);
    assert!(minor.flags.is_empty() && (minor.bounded - 3.0 * 2.0).abs() < 1e-12, "{minor:?}");
    let noise = noise_width(student_975(15.0), minor.standard_error, minor.value);
    let bias = 2.0 * minor.bias.abs();
    assert!((minor.half_width - noise - bias - minor.bounded).abs() < 1e-12, "{minor:?}");
    let major = of(37.0, stray);
    assert_eq!((major.flags, major.bounded), (Flags::OTHER_SURFACE, 0.0));
    // Even light needs no bound; hardly any photons have none.
    assert_eq!(of(39.0, EVEN).bounded, 0.0);
    assert_eq!(of(39.0, PhotonMoments { power: 9.0, power_squared: 9.0, ..EVEN }).bounded, 0.0);
    // Direct light by shadow rays is no light of a map.
    let few = PhotonMoments { power: 0.6, power_squared: 0.6, ..EVEN };
    let mut film = film(16, [0.0; 2], few);
    film.pixels[0].layers[1] = [16.0 * 39.0; 3];
    assert!((film.confidence_intervals().unwrap()[0].bounded - 3.0 * 2.0).abs() < 1e-12);
    let hardly = PhotonMoments { power: 0.4, power_squared: 0.4, ..EVEN };
    assert_eq!(of(39.0, hardly).flags, Flags::FEW_PHOTONS);
}

/// A film of one pixel that is lit by shadow rays, with these values of its passes.
fn lit(values: &[f64]) -> Film {
    let mut film = Film::new(1, 1, Units { power: 3.0, scale: 2.0, ..Units::default() }).unwrap();
    let pixel = &mut film.pixels[0];
    pixel.layers[1] = [values.iter().sum(); 3];
    pixel.square = values.iter().map(|x| x * x).sum();
    film.passes = values.len() as u32;
    film.errors = Some(vec![ErrorPixel::default()]);
    film
}

/// The flags of such a pixel; without an interval if and only if there are any.
fn flags_of(film: &Film) -> Flags {
    let interval = film.confidence_intervals().unwrap()[0];
    assert_eq!(interval.flags.is_empty(), interval.half_width.is_finite());
    interval.flags
}

#[test]
fn a_value_of_few_bright_passes_is_rare() {
    // `bright` passes of 1, and otherwise `dark` ones.
    let of = |passes: usize, bright: usize, dark: f64| {
        let values: Vec<f64> = (0..passes).map(|pass| if pass < bright { 1.0 } else { dark }).collect();
        flags_of(&lit(&values))
    };
    for passes in [8, 64, 1000] {
        assert_eq!((of(passes, 1, 0.0), of(passes, 3, 0.0)), (Flags::RARE, Flags::RARE));
        // Exactly 4 bright passes are enough, and so are equal ones.
        assert!(of(passes, 4, 0.0).is_empty() && of(passes, passes, 0.0).is_empty());
    }
    // One pass that is 100 times as bright as 63 others gives (163/100)² effective passes, one that is 10 times as bright 33.
    assert_eq!((of(64, 1, 0.01), of(64, 1, 0.1)), (Flags::RARE, Flags::default()));
    // The scale of the values does not matter; nor do their signs, if they are equal.
    for (factor, dark) in [(1e-9, 0.01), (1e9, 0.01), (-1.0, 0.01), (1e-9, 0.1), (1e9, 0.1), (-1.0, 0.1)] {
        let values: Vec<f64> = (0..64).map(|pass| factor * if pass == 0 { 1.0 } else { dark }).collect();
        assert_eq!(flags_of(&lit(&values)), of(64, 1, dark), "{factor}");
    }
    // Signs that cancel leave nothing to rely on.
    assert_eq!(flags_of(&lit(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.5])), Flags::RARE);
    // No light at all is no rare light, and too few passes are only that.
    assert!(of(64, 0, 0.0).is_empty());
    for bright in 0..8 {
        assert_eq!(of(7, bright, 0.0), Flags::FEW_PASSES);
    }
}

#[test]
fn rare_light_stays_rare_until_enough_of_it_was_merged() {
    let part = || lit(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let mut film = part();
    for bright in 2..=6 {
        film.merge(&part()).unwrap();
        assert_eq!(flags_of(&film) == Flags::RARE, bright < 4, "{bright}");
        assert!((flags_of(&film) - Flags::RARE).is_empty());
    }
}

#[test]
fn errors_merge_with_their_films() {
    let (mut a, b) = (film(8, [0.02, 0.01], EVEN), film(8, [0.02, 0.01], EVEN));
    a.merge(&b).unwrap();
    let (merged, whole) =
        (a.confidence_intervals().unwrap()[0], film(16, [0.02, 0.01], EVEN).confidence_intervals().unwrap()[0]);
    assert!((merged.half_width - whole.half_width).abs() < 1e-12, "{merged:?} {whole:?}");
    let without = Film::new(1, 1, Units::default()).unwrap();
    assert!(
        a.merge(&without).is_err() && without.clone().merge(&a).is_err() && without.confidence_intervals().is_none()
    );
}
