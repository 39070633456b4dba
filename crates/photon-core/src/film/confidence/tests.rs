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
    let skew = skew(2.0, noise, [2.0, 2.0 * interval.bias_error]);
    assert!((interval.half_width - noise_width(student_975(15.0), noise, skew) - 0.04).abs() < 1e-12);
    assert!(film(16, [0.0; 2], EVEN).confidence_intervals().unwrap()[0].half_width < interval.half_width);
}

fn bent(slope: f64, quadrupole: f64) -> PhotonMoments {
    PhotonMoments { slope: [0.0, slope], quadrupole: [-quadrupole, 0.0], ..EVEN }
}

#[test]
fn each_reason_is_found() {
    let reasons = |film: Film| film.confidence_intervals().unwrap()[0].reasons();
    assert!(reasons(film(8, [0.02, 0.01], EVEN)).is_empty());
    assert_eq!(reasons(film(7, [0.02, 0.01], EVEN)), Flags::FEW_PASSES);
    assert_eq!(
        reasons(film(8, [0.0; 2], PhotonMoments { power: 3.0, power_squared: 3.0, ..EVEN })),
        Flags::FEW_PHOTONS
    );
    assert_eq!(reasons(film(8, [0.0; 2], PhotonMoments { stray: 1.0, ..EVEN })), Flags::OTHER_SURFACE);
    assert_eq!(reasons(film(8, [0.0; 2], bent(2.6, 0.0))), Flags::UNEVEN);
    assert!(reasons(film(8, [0.0; 2], bent(2.4, 0.0))).is_empty());
    assert_eq!(reasons(film(64, [0.0; 2], bent(0.0, 0.8))), Flags::UNEVEN);
    assert!(reasons(film(8, [0.0; 2], bent(0.0, 0.8))).is_empty());
    assert_eq!(reasons(film(8, [0.02, 0.03], EVEN)), Flags::CURVED);
    assert_eq!(reasons(film(8, [0.02, 0.001], EVEN)), Flags::CURVED);
}

/// At a straight edge the interval is as wide as the light that may be missing or too much; at a fold there is none.
#[test]
fn edges_have_wider_intervals_and_folds_have_none() {
    let of = |map_moments| film(64, [0.02, 0.01], map_moments).confidence_intervals().unwrap()[0];
    let even = of(EVEN);
    assert!((even.allowed, even.bounded) == (Flags::default(), 0.0));
    // Mean offset and the bound over the value, 2: 1.15 times the cube of the ratio to 4/3π, at most 3.
    let edge = 4.0 / (3.0 * std::f64::consts::PI);
    for (offset, bound) in [(edge, 1.15), (0.3, 1.15 * (0.3 / edge).powi(3)), (0.9, 3.0)] {
        let at = of(bent(10.0 * offset, 0.0));
        assert_eq!((at.flags, at.allowed), (Flags::default(), Flags::UNEVEN));
        assert!((at.half_width - even.half_width - (2.0 * bound - 0.04)).abs() < 1e-9, "{offset}: {at:?}");
    }
    // Light on another surface alone, with the same bias by both radii, needs nothing beyond it.
    let beside = of(PhotonMoments { stray: 1.0, ..EVEN });
    assert!(beside.flags.is_empty() && beside.allowed == Flags::OTHER_SURFACE && beside.half_width == even.half_width);
    // Of two biases the larger, less twice the noise of the second, which jitters by 1 %.
    let curved = film(64, [0.02, 0.04], EVEN).confidence_intervals().unwrap()[0];
    let spread = 4.0 * 0.04 * 0.01 / 63.0_f64.sqrt();
    assert_eq!((curved.flags, curved.allowed), (Flags::default(), Flags::CURVED));
    assert!((curved.half_width - even.half_width - (2.0 * (0.08 - spread) - 0.04)).abs() < 1e-9, "{curved:?}");
    // A quadrupole without a mean offset, or beside a mean offset like that at an edge.
    for fold in [bent(0.0, 1.5), bent(3.6, 0.8), bent(2.6, 1.2)] {
        let none = of(fold);
        assert_eq!((none.flags, none.allowed, none.half_width), (Flags::UNEVEN, Flags::default(), f64::INFINITY));
    }
    assert!(of(bent(3.6, 0.5)).flags.is_empty());
}

/// Where no photon was found, light of as many as may have been missed is allowed for, if it is at most a tenth.
#[test]
fn light_of_photons_that_were_not_found_is_bounded() {
    // A pixel with 160 photons that gives light 2 in each of 16 passes, and one without, of light `direct`.
    let of = |direct: f64, albedo: f64| {
        let mut film = Film { width: 2, ..film(16, [0.0; 2], EVEN) };
        film.pixels[0].albedo = [16.0; 3];
        film.pixels[0].hits = 16;
        let dark =
            FilmPixel { albedo: [16.0 * albedo; 3], hits: 16, square: 16.0 * direct * direct, ..FilmPixel::default() };
        film.pixels.push(dark);
        film.pixels[1].layers[0] = [16.0 * direct; 3];
        film.errors.as_mut().unwrap().push(ErrorPixel::default());
        film.confidence_intervals().unwrap()[1]
    };
    // 3.7 photons that each give 2/160 in a pass, with half the albedo.
    let missed = 3.7 * 2.0 / 160.0 * 0.5;
    let bright = of(1.0, 0.5);
    assert_eq!((bright.flags, bright.allowed), (Flags::default(), Flags::FEW_PHOTONS));
    assert!((bright.bounded - missed).abs() < 1e-12 && (bright.half_width - missed).abs() < 1e-7, "{bright:?}");
    assert!(of(10.1 * missed, 0.5).flags.is_empty());
    assert_eq!(of(9.9 * missed, 0.5).flags, Flags::FEW_PHOTONS);
}

/// Third moments of photons and of all other noise add.
#[test]
fn noise_of_photons_is_less_skewed() {
    assert!((skew(2.0, 0.2, [0.0, 0.1]) - 4.0 * 0.1).abs() < 1e-12);
    assert!((skew(2.0, 0.2, [2.0, 0.2]) - 9.0 / 8.0 * 0.1).abs() < 1e-12);
    assert_eq!(skew(2.0, 0.2, [2.0, 9.0]), skew(2.0, 0.2, [2.0, 0.2]));
    let [photons, rest] = [0.12_f64, 0.16];
    let third = 9.0 / 8.0 * photons.powi(4) / 0.5 + 4.0 * rest.powi(4) / 2.0;
    assert!((skew(2.0, 0.2, [0.5, photons]) - third / 0.008).abs() < 1e-12);
    assert_eq!((skew(0.0, 0.0, [0.0; 2]), skew(1.0, f64::INFINITY, [1.0; 2])), (0.0, 0.0));
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
        covered += u32::from(off <= noise_width(student_975(n - 1.0), error, skew(sum / n, error, [0.0; 2])));
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
    let skew = skew(minor.value, minor.standard_error, [2.0, 2.0 * minor.bias_error]);
    let noise = noise_width(student_975(15.0), minor.standard_error, skew);
    let bias = 2.0 * minor.bias.abs();
    assert!((minor.half_width - noise - bias - minor.bounded).abs() < 1e-12, "{minor:?}");
    assert_eq!(minor.allowed, Flags::default());
    let major = of(37.0, stray);
    assert_eq!((major.flags, major.allowed, major.bounded), (Flags::default(), Flags::OTHER_SURFACE, 0.0));
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
