//! Confidence intervals of a film, checked against analytic fields and rendered scenes.

use photon_core::{
    Backend, Budget, ConfidenceInterval, ErrorMoments, EstimateParams, Flags, IndexKind, Kernel, Photon, Plan, Search,
    Settings, render,
};
use photon_scene::builtin;

use crate::fields::{BROKEN, EDGES, Field, SMOOTH, Trial, film_of, judge};
use crate::harness::{TestBackend, estimate, film, photon_at, query_at, renderer};
use crate::stats::SIGMAS;

fn field_film<T: TestBackend>(field: &Field, passes: u32, alpha: f64, seed: u64) -> photon_core::Film {
    film_of(&mut T::make(2), field, &Trial { passes, alpha, side: 16, seed }).unwrap()
}

/// Runs 256 trials each, which are independent since no photon is within reach of two of them. Of nominal 95 %
/// intervals, at least 93 % must contain the truth wherever an interval is claimed, and the intervals must not be
/// wider than three times the error.
pub fn e1_claims_hold_in_smooth_fields<T: TestBackend>() {
    for (passes, alpha) in [(24, 2.0 / 3.0), (16, 1.0)] {
        for (seed, field) in SMOOTH.iter().enumerate() {
            let verdict = judge(field, &[field_film::<T>(field, passes, alpha, 70 + seed as u64)]);
            let what = format!("{}, {passes} passes, alpha {alpha:.2}: {verdict:?}", field.name);
            // A proportion of 0.8 of 256 independent trials has a standard error of √(0.8·0.2/256) = 1/40.
            assert!(verdict.claimed >= 0.8 - SIGMAS / 40.0 && verdict.covered >= 0.93, "{what}");
            // The relative standard error of the root of a mean of 256 squares is 1/23.
            assert!(verdict.sharpness <= 3.0 * (1.0 + 4.5 / 23.0), "{what}");
        }
    }
}

/// At straight edges within the radius, where the estimate misses up to half of the light, at least two thirds of 256
/// independent trials have an interval, of which at least 93 % contain the truth; noise and twice the bias that a second radius
/// shows would not, and the intervals are not wider than three times the error. Folds, corners and the dark side of an edge
/// are flagged in at least 19 of 20 pixels.
pub fn e2_edges_have_intervals_and_folds_are_flagged<T: TestBackend>() {
    for (seed, field) in EDGES.iter().enumerate() {
        let film = field_film::<T>(field, 24, 2.0 / 3.0, 80 + seed as u64);
        let verdict = judge(field, std::slice::from_ref(&film));
        let what = format!("{}: {verdict:?}", field.name);
        // A proportion of 2/3 of 256 independent trials has a standard error of √(2/9/256) = 1/34.
        assert!(verdict.claimed >= 2.0 / 3.0 - SIGMAS / 34.0 && verdict.covered >= 0.93, "{what}");
        // The relative standard error of the root of a mean of 256 squares is 1/23.
        assert!(verdict.sharpness <= 3.0 * (1.0 + 4.5 / 23.0), "{what}");
        let truth = (field.at)(0.0, 0.0);
        let plain = film.confidence_intervals().unwrap().into_iter().filter(|interval| {
            let noise = photon_core::student_975(23.0) * interval.standard_error;
            (interval.value - truth).abs() <= noise + 2.0 * interval.bias.abs()
        });
        assert!(plain.count() < 230, "{what}");
    }
    for (seed, field) in BROKEN.iter().enumerate() {
        let verdict = judge(field, &[field_film::<T>(field, 24, 2.0 / 3.0, 85 + seed as u64)]);
        assert!(verdict.claimed <= 0.05, "{}: {verdict:?}", field.name);
    }
}

/// Negative control: the noise alone does not cover the error at a narrow bump with a fixed radius, nor at an edge.
pub fn e3_noise_alone_does_not_cover<T: TestBackend>() {
    for field in [&SMOOTH[3], &EDGES[1]] {
        let verdict = judge(field, &[field_film::<T>(field, 16, 1.0, 90)]);
        assert!(verdict.covered_by_noise <= 0.5, "{}: {verdict:?}", field.name);
    }
    // With seven passes, all pixels are flagged as having too few, and nearly all for no other reason. By chance, a
    // quadrupole exceeds 3 standard errors in exp(−9/2) of the pixels. For two biases to differ, one has to exceed
    // 3 of its own standard errors, each with probability 0.024 (Student's t, 6 degrees of freedom). With one more
    // pass, no pixel has too few.
    let intervals = |passes| field_film::<T>(&SMOOTH[0], passes, 1.0, 91).confidence_intervals().unwrap();
    let few = intervals(7);
    assert!(few.iter().all(|interval| interval.flags.contains(Flags::FEW_PASSES)));
    let never = [Flags::FEW_PHOTONS, Flags::OTHER_SURFACE];
    assert!(few.iter().all(|interval| !never.iter().any(|&flag| interval.reasons().contains(flag))));
    let others = few.iter().filter(|interval| interval.reasons() != Flags::FEW_PASSES).count() as f64;
    let chance = (-4.5_f64).exp() + 2.0 * 0.024;
    assert!(others <= 256.0 * chance + SIGMAS * (256.0 * chance * (1.0 - chance)).sqrt(), "{others} of 256");
    assert!(intervals(8).iter().all(|interval| !interval.flags.contains(Flags::FEW_PASSES)));
}

/// Error moments of photons that are counted by hand: two within the radius (one of them within half of it), one
/// outside; one photon on a wall, one on a step.
pub fn e4_spread_of_known_photons<T: TestBackend>() {
    let wall = photon_core::octahedral::pack(photon_core::glam::Vec3::X);
    let mut photons: Vec<Photon> =
        [[0.04, 0.0, 0.0], [0.0, 0.08, 0.0], [-0.12, 0.0, 0.0], [0.0, -0.05, 0.0], [0.02, 0.0, 0.06], [0.15, 0.0, 0.0]]
            .map(photon_at)
            .to_vec();
    photons[3].normal = wall;
    let queries = [query_at([0.0; 3], 0.1)];
    let gather =
        EstimateParams { kernel: Kernel::Epanechnikov, min_normal_cosine: 0.7, ..EstimateParams::new(Search::Radius) };
    let mut on = T::make(2);
    let mut stages = on.map_stages(IndexKind::Morton).unwrap();
    let there = on.upload("photons", &photons).unwrap();
    let asked = on.upload("queries", &queries).unwrap();
    let (mut estimates, mut error_moments) = (on.alloc("estimates", 1).unwrap(), on.alloc("spreads", 1).unwrap());
    let map = stages.builder.build(&mut on, there).unwrap();
    stages.estimator.estimate_with_moments(&mut on, &map, &asked, &gather, &mut estimates, &mut error_moments).unwrap();
    let (mut found, mut records): (Vec<_>, Vec<ErrorMoments>) = (Vec::new(), Vec::new());
    on.download(&estimates, &mut found).unwrap();
    on.download(&error_moments, &mut records).unwrap();
    assert_eq!(found, estimate::<T>(IndexKind::Morton, &photons, &queries, &gather));
    let near = |what: &str, found: f32, truth: f64| {
        assert!((f64::from(found) - truth).abs() <= 1e-5, "{what}: {found} instead of {truth}");
    };
    let record = records[0];
    // Squared distances over the squared radius are 0.16, 0.64, 1.44, 0.4, on the floor or near it.
    near("wide", record.wide[1], [0.16, 0.64, 1.44, 0.4].iter().map(|u| 2.0 - u).sum());
    near("narrow", record.narrow[1], [0.16, 0.4].iter().map(|u| 2.0 - 4.0 * u).sum());
    near("power", record.power, 4.0);
    near("squares", record.power_squared, 4.0);
    near("stray", record.stray, 2.0);
    assert_eq!(record.photons, 4);
    let reach = 0.1 * 2.0_f64.sqrt();
    // The tangent frame of an upward normal is x and y.
    near("slope", record.slope[0], (0.04 - 0.12 + 0.02) / reach);
    near("slope", record.slope[1], 0.08 / reach);
    near("stretch", record.quadrupole[0], (0.0016 + 0.0144 + 0.0004 - 0.0064) / (reach * reach));
    near("stretch", record.quadrupole[1], 0.0);
}

/// Error statistics leave the image unchanged, merge like it, and are absent unless requested.
pub fn e5_errors_leave_the_picture_alone<T: TestBackend>() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let plain = Settings { photons: 5_000, seed: 5, ..Settings::default() };
    let asked = Settings { errors: true, ..plain.clone() };
    let (without, with) = (film::<T>(&scene, &plain, 4, 16), film::<T>(&scene, &asked, 4, 16));
    assert!(without.errors.is_none() && without.confidence_intervals().is_none());
    let mean = without.beauty().iter().flatten().sum::<f32>() / (3 * 256) as f32;
    for (a, b) in without.beauty().iter().flatten().zip(with.beauty().iter().flatten()) {
        // The same photons, summed in another order.
        assert!((a - b).abs() <= 1e-5 * (a.abs() + mean), "{a} {b}");
    }
    let part = |first: u32| {
        let mut renderer = renderer::<T>(&scene, &asked, 16);
        for pass in first..first + 2 {
            photon_core::Render::pass(&mut renderer, pass, &mut ()).unwrap();
        }
        photon_core::Render::film(&mut renderer).unwrap()
    };
    let mut merged = part(0);
    merged.merge(&part(2)).unwrap();
    for (a, b) in with.confidence_intervals().unwrap().iter().zip(merged.confidence_intervals().unwrap()) {
        assert!((a.bias - b.bias).abs() <= 1e-6 * f64::from(mean), "{a:?} {b:?}");
        assert!((a.bias_error - b.bias_error).abs() <= 1e-6 * f64::from(mean), "{a:?} {b:?}");
        assert_eq!((a.flags, a.allowed), (b.flags, b.allowed));
    }
    assert!(with.confidence_intervals().unwrap().iter().any(|interval| interval.bias != 0.0));
}

/// Final gathering has the bias of the maps where the gather rays land. In a uniformly lit closed sphere there is
/// none and the confidence intervals hold; in a box with corners the bias is reported.
pub fn e6_gathered_light_is_claimed<T: TestBackend>() {
    let settings = Settings {
        photons: 4_000,
        indirect: photon_core::Indirect::Gather,
        gather_rays: 4,
        errors: true,
        seed: 3,
        ..Settings::default()
    };
    let scene = builtin("furnace").unwrap().build().unwrap();
    let intervals = film::<T>(&scene, &settings, 12, 12).confidence_intervals().unwrap();
    let standing: Vec<&ConfidenceInterval> = intervals.iter().filter(|interval| interval.flags.is_empty()).collect();
    let truth = 2.0 * std::f64::consts::FRAC_1_PI;
    let covered = standing.iter().filter(|interval| (interval.value - truth).abs() <= interval.half_width).count();
    assert!(standing.len() * 10 >= intervals.len() * 9, "{} of {}", standing.len(), intervals.len());
    assert!(covered * 100 >= standing.len() * 93, "{covered} of {}", standing.len());
    let mean = |of: &dyn Fn(&ConfidenceInterval) -> f64, intervals: &[ConfidenceInterval]| {
        intervals.iter().map(of).sum::<f64>() / intervals.len() as f64
    };
    let scene = builtin("cornell").unwrap().build().unwrap();
    let intervals = film::<T>(&scene, &settings, 12, 12).confidence_intervals().unwrap();
    // Beyond edges there are no photons, so larger radii collect less light and the image is too dark.
    let (bias, value) = (mean(&|interval| interval.bias, &intervals), mean(&|interval| interval.value, &intervals));
    assert!(bias < -0.002 * value && bias > -0.2 * value, "{bias} of {value}");
}

/// A render with an error target stops by itself, near the number of passes that the pilot predicted, and its
/// confidence intervals hold: a uniformly lit closed sphere with radiosity 2.
pub fn e8_an_error_asked_for_is_reached<T: TestBackend>() {
    let scene = builtin("furnace").unwrap().build().unwrap();
    let settings = Settings { photons: 2_000, errors: true, seed: 8, ..Settings::default() };
    let mut renderer = renderer::<T>(&scene, &settings, 8);
    let target = 0.06;
    let plan = Plan { most_passes: Some(1000), ..Budget::Error { target, share_of_pixels: 0.95 }.into() };
    let outcome = render(&mut renderer, plan, &mut ()).unwrap();
    let (predicted, reached) = (outcome.predicted.unwrap(), outcome.reached.unwrap());
    assert!(reached.is_reached() && reached.error <= target && outcome.passes < 1000, "{reached:?}");
    let ratio = f64::from(outcome.passes) / f64::from(predicted.passes_needed.unwrap());
    assert!(predicted.passes == 8 && outcome.passes > 8 && (0.33..=3.0).contains(&ratio), "{predicted:?} {reached:?}");
    let intervals = photon_core::Render::film(&mut renderer).unwrap().confidence_intervals().unwrap();
    let truth = 2.0 * std::f64::consts::FRAC_1_PI;
    let covered = intervals.iter().filter(|interval| (interval.value - truth).abs() <= interval.half_width).count();
    assert!(covered * 100 >= intervals.len() * 93, "{covered} of {}", intervals.len());
    // Without error statistics, an error target is refused.
    let mut deaf = crate::harness::renderer::<T>(&scene, &Settings { errors: false, ..settings }, 8);
    assert!(render(&mut deaf, plan, &mut ()).is_err());
}
