//! What a film claims of its own error, against fields whose truth is known.
//!
//! Each pixel is one query amid a Poisson field of its own, far enough from its neighbours to be
//! independent of them, so that pixels are trials. Lengths are in radii of the first pass, in which 20
//! photons are expected where the field is 1; radii shrink with α = 2/3 or stay.

use photon_core::{
    Backend, Budget, Claim, Film, Flags, Gather, IndexKind, Kernel, Layer, MapStages, Photon, Plan, Query, RandomKind,
    Rule, Settings, Spread, TransportBackend, radius_squared_factor, render,
};
use photon_scene::{MaterialDesc, SceneBuilder, builtin};
use std::f64::consts::PI;

use crate::harness::{TestBackend, Uniform, estimate, film, per_pass, photon_at, query_at, renderer};
use crate::stats::{assert_agrees, moments};

/// Light about the origin, where the truth is asked for; both coordinates within ±1.5.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// For messages.
    pub name: &'static str,
    /// Its value.
    pub at: fn(f64, f64) -> f64,
    /// At least the largest of its values.
    pub most: f64,
}

fn bump(x: f64, y: f64, sigma: f64) -> f64 {
    (-(x * x + y * y) / (2.0 * sigma * sigma)).exp()
}

fn lit(yes: bool) -> f64 {
    f64::from(u8::from(yes))
}

/// `x^(−1/2)` beyond a fold at distance `d`, 1 at the origin; cut off where it is 12.
fn fold(x: f64, d: f64) -> f64 {
    if x <= -d { 0.0 } else { (d / (x + d)).sqrt().min(12.0) }
}

/// Where claims must be made and hold.
pub const SMOOTH: [Field; 5] = [
    Field { name: "uniform", at: |_, _| 1.0, most: 1.0 },
    Field { name: "slope", at: |x, _| (1.0 + 0.5 * x).max(0.0), most: 1.75 },
    Field { name: "bump of 1.5", at: |x, y| bump(x, y, 1.5), most: 1.0 },
    Field { name: "bump of 0.7", at: |x, y| bump(x, y, 0.7), most: 1.0 },
    Field { name: "side of a bump", at: |x, y| bump(x + 1.5, y, 1.5) / bump(1.5, 0.0, 1.5), most: 1.65 },
];

/// Where none may be made.
pub const BROKEN: [Field; 7] = [
    Field { name: "edge at 0.05", at: |x, _| lit(x > -0.05), most: 1.0 },
    Field { name: "edge at 0.3", at: |x, _| lit(x > -0.3), most: 1.0 },
    Field { name: "dark, edge at 0.05", at: |x, _| lit(x > 0.05), most: 1.0 },
    Field { name: "dark, edge at 0.3", at: |x, _| lit(x > 0.3), most: 1.0 },
    Field { name: "fold at 0.2", at: |x, _| fold(x, 0.2), most: 12.0 },
    Field { name: "fold at 0.5", at: |x, _| fold(x, 0.5), most: 12.0 },
    Field { name: "corner of light", at: |x, y| lit(x > -0.2 && y > -0.2), most: 1.0 },
];

/// Pixels along a side, the distance between them, and the first radius.
const SIDE: u32 = 16;
const STEP: f64 = 0.06;
const RADIUS: f64 = 0.018;
const EXPECTED: f64 = 20.0;

/// Photons of one pass: a Poisson process of the field's density about each pixel.
fn photons(field: &Field, uniform: &mut Uniform) -> Vec<Photon> {
    let half = 1.5;
    let mean = EXPECTED / PI * 4.0 * half * half * field.most;
    let mut photons = Vec::new();
    for pixel in 0..SIDE * SIDE {
        let [cx, cy] = place(pixel);
        // Arrivals at unit rate until `mean`.
        let mut time = -(1.0 - uniform.draw()).ln();
        while time < mean {
            let (x, y) = (half * (2.0 * uniform.draw() - 1.0), half * (2.0 * uniform.draw() - 1.0));
            if uniform.draw() * field.most < (field.at)(x, y) {
                photons.push(photon_at([(cx + x * RADIUS) as f32, (cy + y * RADIUS) as f32, 0.0]));
            }
            time -= (1.0 - uniform.draw()).ln();
        }
    }
    photons
}

fn place(pixel: u32) -> [f64; 2] {
    [pixel % SIDE, pixel / SIDE].map(|i| (f64::from(i) - 7.5) * STEP)
}

/// The film of so many passes over a field, in units of the field's density.
pub fn field_film<T: TestBackend>(field: &Field, passes: u32, alpha: f64, seed: u64) -> Film {
    let mut on = T::make(2);
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [1.0; 3]));
    builder.quad("floor", [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]], white);
    let scene = builder.build().unwrap();
    let mut there = on.film(&scene.view(), SIDE, SIDE).unwrap();
    on.keep_errors(&mut there).unwrap();
    let queries: Vec<Query> = (0..SIDE * SIDE)
        .map(|pixel| {
            let [x, y] = place(pixel);
            Query { pixel, ..query_at([x as f32, y as f32, 0.0], RADIUS as f32) }
        })
        .collect();
    let queries = on.upload("queries", &queries).unwrap();
    let mut estimates = on.alloc("estimates", u64::from(SIDE * SIDE)).unwrap();
    let mut spreads = on.alloc("spreads", u64::from(SIDE * SIDE)).unwrap();
    let MapStages { mut builder, mut estimator } = on.map_stages(IndexKind::Morton).unwrap();
    let mut uniform = Uniform::new(seed);
    for pass in 0..passes {
        let shrink = radius_squared_factor(pass, alpha).sqrt() as f32;
        let gather =
            Gather { rule: Rule::Radius, kernel: Kernel::Epanechnikov, radius_scale: shrink, min_normal_cosine: 0.7 };
        let photons = on.upload("photons", &photons(field, &mut uniform)).unwrap();
        let map = builder.build(&mut on, photons).unwrap();
        estimator.estimate_spread(&mut on, &map, &queries, &gather, &mut estimates, &mut spreads).unwrap();
        on.fold(&mut there, Layer::Indirect, &queries, &estimates, 1).unwrap();
        on.fold_errors(&mut there, Layer::Indirect, &queries, &estimates, &spreads, 1).unwrap();
        on.end_pass(&mut there).unwrap();
    }
    let mut film = on.read_film(&there).unwrap();
    film.units = photon_core::Units { power: PI * RADIUS * RADIUS / EXPECTED, ..photon_core::Units::default() };
    film
}

/// What came of the claims about one field.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Share of the pixels of which something is claimed.
    pub claimed: f64,
    /// Share of these whose truth is within the claim.
    pub covered: f64,
    /// Share whose truth is within what noise alone would claim, of all pixels.
    pub covered_by_noise: f64,
    /// Median claim over the root of the mean squared error.
    pub sharpness: f64,
}

/// Judges films of the same field.
#[must_use]
pub fn judge(field: &Field, films: &[Film]) -> Verdict {
    let truth = (field.at)(0.0, 0.0);
    let all: Vec<Claim> = films.iter().flat_map(|film| film.claims().unwrap()).collect();
    let quantile = photon_core::student_975(f64::from(films[0].passes) - 1.0);
    let error = |claim: &Claim| (claim.value - truth).abs();
    let claimed: Vec<&Claim> = all.iter().filter(|claim| claim.flags.is_empty()).collect();
    let squares: Vec<f64> = claimed.iter().map(|claim| error(claim).powi(2)).collect();
    let mut widths: Vec<f64> = claimed.iter().map(|claim| claim.half_width).collect();
    widths.sort_by(f64::total_cmp);
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    Verdict {
        claimed: share(claimed.len(), all.len()),
        covered: share(claimed.iter().filter(|claim| error(claim) <= claim.half_width).count(), claimed.len()),
        covered_by_noise: share(
            all.iter().filter(|claim| error(claim) <= quantile * claim.standard_error).count(),
            all.len(),
        ),
        sharpness: widths.get(widths.len() / 2).map_or(f64::NAN, |&width| width / moments(&squares).0.sqrt()),
    }
}

/// 256 trials each: of a nominal 0.95, no fewer than 0.93 hold, wherever anything is claimed; and the
/// claims are no wider than three times the error.
pub fn e1_claims_hold_in_smooth_fields<T: TestBackend>() {
    for (passes, alpha) in [(24, 2.0 / 3.0), (16, 1.0)] {
        for (seed, field) in SMOOTH.iter().enumerate() {
            let verdict = judge(field, &[field_film::<T>(field, passes, alpha, 70 + seed as u64)]);
            let what = format!("{}, {passes} passes, alpha {alpha:.2}: {verdict:?}", field.name);
            assert!(verdict.claimed >= 0.8 && verdict.covered >= 0.93, "{what}");
            // The standard error of a root of 256 squares is a 23rd of it.
            assert!(verdict.sharpness <= 3.0 * (1.0 + 4.5 / 23.0), "{what}");
        }
    }
}

/// Edges and folds within the support are flagged, at least 19 of 20 pixels; what is claimed holds.
pub fn e2_edges_and_folds_are_flagged<T: TestBackend>() {
    for (seed, field) in BROKEN.iter().enumerate() {
        let verdict = judge(field, &[field_film::<T>(field, 24, 2.0 / 3.0, 80 + seed as u64)]);
        assert!(verdict.claimed <= 0.05, "{}: {verdict:?}", field.name);
    }
}

/// What must fail does: noise alone does not cover a narrow bump under a fixed radius, nor an edge.
pub fn e3_noise_alone_does_not_cover<T: TestBackend>() {
    for field in [&SMOOTH[3], &BROKEN[0]] {
        let verdict = judge(field, &[field_film::<T>(field, 16, 1.0, 90)]);
        assert!(verdict.covered_by_noise <= 0.5, "{}: {verdict:?}", field.name);
    }
    let few = field_film::<T>(&SMOOTH[0], 7, 1.0, 91);
    assert!(few.claims().unwrap().iter().all(|claim| claim.flags == Flags::FEW_PASSES));
}

/// The second sums on photons that are counted by hand: two within the radius, one of them within the
/// half, one without; one photon on a wall, one on a step.
pub fn e4_spread_of_known_photons<T: TestBackend>() {
    let wall = photon_core::octahedral::pack(photon_core::glam::Vec3::X);
    let mut photons: Vec<Photon> =
        [[0.04, 0.0, 0.0], [0.0, 0.08, 0.0], [-0.12, 0.0, 0.0], [0.0, -0.05, 0.0], [0.02, 0.0, 0.06], [0.15, 0.0, 0.0]]
            .map(photon_at)
            .to_vec();
    photons[3].normal = wall;
    let queries = [query_at([0.0; 3], 0.1)];
    let gather = Gather { rule: Rule::Radius, kernel: Kernel::Epanechnikov, radius_scale: 1.0, min_normal_cosine: 0.7 };
    let mut on = T::make(2);
    let mut stages = on.map_stages(IndexKind::Morton).unwrap();
    let there = on.upload("photons", &photons).unwrap();
    let asked = on.upload("queries", &queries).unwrap();
    let (mut estimates, mut spreads) = (on.alloc("estimates", 1).unwrap(), on.alloc("spreads", 1).unwrap());
    let map = stages.builder.build(&mut on, there).unwrap();
    stages.estimator.estimate_spread(&mut on, &map, &asked, &gather, &mut estimates, &mut spreads).unwrap();
    let (mut found, mut told): (Vec<_>, Vec<Spread>) = (Vec::new(), Vec::new());
    on.download(&estimates, &mut found).unwrap();
    on.download(&spreads, &mut told).unwrap();
    assert_eq!(found, estimate::<T>(IndexKind::Morton, &photons, &queries, &gather));
    let near = |what: &str, found: f32, truth: f64| {
        assert!((f64::from(found) - truth).abs() <= 1e-5, "{what}: {found} instead of {truth}");
    };
    let spread = told[0];
    // Squared distances over the squared radius: 0.16, 0.64, 1.44, 0.4 on the floor or near it.
    near("wide", spread.wide[1], [0.16, 0.64, 1.44, 0.4].iter().map(|u| 2.0 - u).sum());
    near("narrow", spread.narrow[1], [0.16, 0.4].iter().map(|u| 2.0 - 4.0 * u).sum());
    near("power", spread.power, 4.0);
    near("squares", spread.power_squared, 4.0);
    near("stray", spread.stray, 2.0);
    assert_eq!(spread.photons, 4);
    let reach = 0.1 * 2.0_f64.sqrt();
    // The frame of a floor's normal is x and y.
    near("slope", spread.slope[0], (0.04 - 0.12 + 0.02) / reach);
    near("slope", spread.slope[1], 0.08 / reach);
    near("stretch", spread.stretch[0], (0.0016 + 0.0144 + 0.0004 - 0.0064) / (reach * reach));
    near("stretch", spread.stretch[1], 0.0);
}

/// Errors come with the same picture, merge as it does, and are not there unless they are asked for.
pub fn e5_errors_leave_the_picture_alone<T: TestBackend>() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let plain = Settings { photons: 5_000, seed: 5, ..Settings::default() };
    let asked = Settings { errors: true, ..plain.clone() };
    let (without, with) = (film::<T>(&scene, &plain, 4, 16), film::<T>(&scene, &asked, 4, 16));
    assert!(without.errors.is_none() && without.claims().is_none());
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
    for (a, b) in with.claims().unwrap().iter().zip(merged.claims().unwrap()) {
        assert!((a.bias - b.bias).abs() <= 1e-6 * f64::from(mean), "{a:?} {b:?}");
        assert!((a.bias_error - b.bias_error).abs() <= 1e-6 * f64::from(mean), "{a:?} {b:?}");
        assert_eq!(a.flags, b.flags);
    }
    assert!(with.claims().unwrap().iter().any(|claim| claim.bias != 0.0));
}

/// Light that is gathered has the bias of the maps where its rays land: in a ball that glows alike
/// everywhere there is none, and claims hold; in a box with corners it is told.
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
    let claims = film::<T>(&scene, &settings, 12, 12).claims().unwrap();
    let standing: Vec<&Claim> = claims.iter().filter(|claim| claim.flags.is_empty()).collect();
    let truth = 2.0 * std::f64::consts::FRAC_1_PI;
    let covered = standing.iter().filter(|claim| (claim.value - truth).abs() <= claim.half_width).count();
    assert!(standing.len() * 10 >= claims.len() * 9, "{} of {}", standing.len(), claims.len());
    assert!(covered * 100 >= standing.len() * 93, "{covered} of {}", standing.len());
    let mean = |of: &dyn Fn(&Claim) -> f64, claims: &[Claim]| claims.iter().map(of).sum::<f64>() / claims.len() as f64;
    let scene = builtin("cornell").unwrap().build().unwrap();
    let claims = film::<T>(&scene, &settings, 12, 12).claims().unwrap();
    // Beyond edges there are no photons, so that larger radii see less light: the picture is too dark.
    let (bias, value) = (mean(&|claim| claim.bias, &claims), mean(&|claim| claim.value, &claims));
    assert!(bias < -0.002 * value && bias > -0.2 * value, "{bias} of {value}");
}

/// Photons that leave by Sobol's sequence give the same light with less noise: the mean over the picture,
/// pass by pass, of a ball around a lamp. A ratio of two variances of 24 passes is beyond 2.7 in
/// one of a hundred cases by chance.
pub fn e7_sobol_is_the_same_light_with_less_noise<T: TestBackend>() {
    let scene = builtin("integrating-sphere").unwrap().build().unwrap();
    let passes = |random| {
        let settings = Settings {
            photons: 4_000,
            direct: photon_core::Direct::Photons,
            indirect: photon_core::Indirect::None,
            estimator: photon_core::Estimator::Radius { radius: Some(0.1) },
            alpha: 1.0,
            random,
            ..Settings::default()
        };
        per_pass::<T>(&scene, &settings, 24, 8)
    };
    let (counter, sobol) = (passes(RandomKind::Counter), passes(RandomKind::Sobol));
    let ((a, va), (b, vb)) = (moments(&counter), moments(&sobol));
    assert_agrees("mean", b, a, ((va + vb) / 24.0).sqrt(), 0.0);
    assert!(vb * 2.7 < va, "variance {vb:e} instead of {va:e}");
}

/// An error that is asked for ends the render by itself, near where the pilot foretold, and its claims
/// hold: in a ball that glows alike everywhere, radiosity 2.
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
    let claims = photon_core::Render::film(&mut renderer).unwrap().claims().unwrap();
    let truth = 2.0 * std::f64::consts::FRAC_1_PI;
    let covered = claims.iter().filter(|claim| (claim.value - truth).abs() <= claim.half_width).count();
    assert!(covered * 100 >= claims.len() * 93, "{covered} of {}", claims.len());
    // Errors that nobody keeps cannot be asked for.
    let mut deaf = crate::harness::renderer::<T>(&scene, &Settings { errors: false, ..settings }, 8);
    assert!(render(&mut deaf, plan, &mut ()).is_err());
}
