//! Two backends with the same seeds: where they must agree to the bit, where they must agree path by path, and
//! where their means must be equivalent.
//!
//! Arithmetic differs between devices in the last bits (division, square roots, contraction), so that occasionally
//! a path diverges. From there on it is another path of the same distribution: the proportion of such paths is
//! counted, and means are compared.

use photon_core::glam::Vec3;
use photon_core::{
    Area, Backend, Batch, Direct, EstimateParams, Estimator, IndexKind, Indirect, Kernel, Pass, Photon, PhotonRay,
    ProjectionMap, RandomKind, Requirements, Search, Settings, TransportBackend,
};
use photon_scene::{Scene, builtin};

use crate::harness::{TestBackend, Uniform, estimate, estimates, film, per_pass, photon_at, query_at, trace};
use crate::shadow_terminator::coarse_balls;
use crate::stats::{moments, standard_error};

/// Scenes that together contain every kind of light, and every lobe but those of rough glass.
pub const SCENES: [&str; 6] = ["cornell", "cornell-glass", "ring", "pool", "textures", "gloss"];

/// Proportion of the elements of `a` that have a counterpart at the same index of `b`.
#[must_use]
pub fn share<T>(a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> f64 {
    if a.is_empty() && b.is_empty() {
        return 1.0;
    }
    let matched = a.iter().zip(b).filter(|(a, b)| same(a, b)).count();
    matched as f64 / a.len().max(b.len()) as f64
}

fn near(a: [f32; 3], b: [f32; 3], bound: f32) -> bool {
    Vec3::from(a).distance(Vec3::from(b)) <= bound
}

/// Whether two photons are the same up to rounding: 1e-4 of the scene's size, 1e-3 of the power.
#[must_use]
pub fn same_photon(a: &Photon, b: &Photon) -> bool {
    near(a.position, b.position, 1e-4) && near(a.power, b.power, 1e-3 * Vec3::from(a.power).length())
}

/// The first photons of a pass as they leave the lights, aimed or not.
pub(crate) fn rays<T: TestBackend>(
    scene: &Scene,
    settings: &Settings,
    projection: Option<&ProjectionMap>,
    count: u32,
) -> Vec<PhotonRay> {
    let mut on = T::make(2);
    let view = scene.view();
    let required = Requirements::of(&view, settings);
    let prepared = on.prepare(&view, &required).unwrap();
    let mut emitter = match projection {
        None => on.stages(&required, settings).unwrap().emitter,
        Some(projection) => on.aimed(&required, settings, projection).unwrap().unwrap().0,
    };
    let mut rays = on.alloc("rays", u64::from(count)).unwrap();
    let pass = Pass { seed: settings.seed, index: 3, random: settings.random, sample: 0, samples: 1 };
    emitter.emit(&mut on, &prepared, &Batch { pass, paths: 5..5 + count }, &mut rays).unwrap();
    let mut out = Vec::new();
    on.download(&rays, &mut out).unwrap();
    out
}

/// Emitted photons have the same light, the same path number, and the same origin and direction up to rounding, in
/// every path.
pub fn photons_leave_alike<A: TestBackend, B: TestBackend>() {
    for name in SCENES.into_iter().chain(["two-rooms"]) {
        let scene = builtin(name).unwrap().build().unwrap();
        let projection = ProjectionMap::of(&scene.view());
        assert_eq!(projection.is_empty(), name == "cornell", "{name}");
        for (random, projection) in [
            (RandomKind::Counter, None),
            (RandomKind::Counter, Some(&projection)),
            (RandomKind::Lcg, Some(&projection)),
        ] {
            if projection.is_some_and(ProjectionMap::is_empty) {
                continue;
            }
            let settings = Settings { seed: 11, random, ..Settings::default() };
            assert_start_alike::<A, B>(&scene, &settings, projection, name);
        }
    }
}

/// Photons of both backends start alike, in all but one of 10 000 paths.
pub(crate) fn assert_start_alike<A: TestBackend, B: TestBackend>(
    scene: &Scene,
    settings: &Settings,
    projection: Option<&ProjectionMap>,
    name: &str,
) {
    let (a, b) = (rays::<A>(scene, settings, projection, 20_000), rays::<B>(scene, settings, projection, 20_000));
    let same = |a: &PhotonRay, b: &PhotonRay| {
        (a.path, a.light) == (b.path, b.light)
            && near(a.origin, b.origin, 1e-5)
            && near(a.direction, b.direction, 1e-5)
            && near(a.power, b.power, 1e-5 * Vec3::from(a.power).length())
    };
    let share = share(&a, &b, same);
    assert!(a.len() == 20_000 && share >= 0.9999, "{name}, {}: {share}", projection.is_some());
}

/// Photons of bounce `depth` alone, in order of path: those that a limit of `depth` stores and a limit of `depth −
/// 1` does not.
fn of_bounce<T: TestBackend>(scene: &Scene, depth: u32) -> Vec<Photon> {
    let all = |max_bounces: u32| {
        let settings = Settings { max_bounces, seed: 5, direct: Direct::Photons, ..Settings::default() };
        let (photons, _) = trace::<T>(2, scene, &settings, &[20_000]);
        photons.into_array().concat()
    };
    let before = if depth > 1 { all(depth - 1) } else { Vec::new() };
    let mut before = before.iter().peekable();
    // Both are in the same order, map by map, and one is a subset of the other.
    all(depth).into_iter().filter(|photon| before.next_if(|known| *known == photon).is_none()).collect()
}

/// Proportion of the photons of one bounce that both backends have, found by position: those of `a` for which `b`
/// has one at the same position with the same power.
pub(crate) fn matched(a: &[Photon], b: &[Photon]) -> f64 {
    let positions: Vec<_> = b.iter().map(|photon| photon.position).collect();
    let index = backend_cpu::index::PointIndex::build(&positions, IndexKind::Morton).unwrap();
    let mut hits = 0;
    for photon in a {
        let mut found = false;
        index.within(photon.position, 1e-8, |slot, _| {
            found |= same_photon(photon, &b[index.order()[slot as usize] as usize]);
        });
        hits += usize::from(found);
    }
    hits as f64 / a.len().max(1) as f64
}

/// Common random numbers: nearly all paths are the same, fewer with each bounce. The bounds are measured
/// proportions, rounded down.
pub fn paths_are_the_same_paths<A: TestBackend, B: TestBackend>() {
    for name in SCENES.into_iter().chain(["frosted-glass"]) {
        let scene = builtin(name).unwrap().build().unwrap();
        for (depth, least) in [(1, 0.999), (5, 0.99)] {
            let (a, b) = (of_bounce::<A>(&scene, depth), of_bounce::<B>(&scene, depth));
            let share = matched(&a, &b);
            eprintln!("{name}, bounce {depth}: {share:.5} of {} match", a.len());
            // In the ring, every path ends at its second surface.
            if (a.len(), b.len()) == (0, 0) && depth == 5 {
                continue;
            }
            assert!(a.len() > 100 && share >= least, "{name}, bounce {depth}: {share} of {}", a.len());
        }
    }
}

/// Counters that follow from the same decisions are equal; all others balance.
pub fn tallies_agree<A: TestBackend, B: TestBackend>() {
    for name in SCENES {
        let scene = builtin(name).unwrap().build().unwrap();
        let settings = Settings { seed: 6, ..Settings::default() };
        let (_, a) = trace::<A>(2, &scene, &settings, &[30_000]);
        let (_, b) = trace::<B>(2, &scene, &settings, &[30_000]);
        assert_eq!(a.emitted, b.emitted);
        assert!(a.balances() && b.balances(), "{name}: {a:?} {b:?}");
    }
}

/// One backend's photons in the other: the same neighbours, and the same sums up to rounding.
pub fn replayed_photons_give_the_same_estimates<A: TestBackend, B: TestBackend>() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let (maps, _) = trace::<A>(2, &scene, &Settings::default(), &[30_000]);
    for (_, photons) in maps {
        let queries: Vec<_> = photons
            .iter()
            .step_by(photons.len() / 300 + 1)
            .map(|photon| {
                let normal = photon_core::octahedral::unpack(photon.normal).to_array();
                photon_core::Query { normal, ..query_at(photon.position, 0.05) }
            })
            .collect();
        let mut gathers = Vec::new();
        for search in [
            Search::Radius,
            Search::KNearest { k: 50 },
            Search::KNearest { k: 500 },
            Search::Paper { max: 100, threshold: 8, factor: 1.0 },
        ] {
            gathers.extend(Kernel::ALL.map(|kernel| EstimateParams {
                kernel,
                min_normal_cosine: 0.9,
                ..EstimateParams::new(search)
            }));
        }
        for kind in [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton] {
            let a = estimates::<A>(kind, &photons, &queries, &gathers);
            let b = estimates::<B>(kind, &photons, &queries, &gathers);
            for ((a, b), EstimateParams { search, kernel, .. }) in a.iter().zip(&b).zip(&gathers) {
                assert!(a.len() == queries.len() && b.len() == queries.len());
                for (i, (a, b)) in a.iter().zip(b).enumerate() {
                    assert_eq!((a.photons, a.flags), (b.photons, b.flags), "{kind:?} {search:?} {kernel:?} {i}");
                    assert_eq!(a.radius_squared.to_bits(), b.radius_squared.to_bits(), "{kind:?} {search:?} {i}");
                    let bound = 1e-5 * Vec3::from(a.flux).length() + 1e-12;
                    assert!(near(a.flux, b.flux, bound), "{kind:?} {search:?} {kernel:?} {i}: {a:?} {b:?}");
                }
            }
        }
    }
}

/// Surfaces with alpha: the same paths, and pictures alike, as in the other scenes.
pub fn alpha_is_the_same<A: TestBackend, B: TestBackend>() {
    let scene = crate::alpha_surfaces::leaves();
    for (depth, least) in [(1, 0.999), (5, 0.99)] {
        let (a, b) = (of_bounce::<A>(&scene, depth), of_bounce::<B>(&scene, depth));
        let share = matched(&a, &b);
        eprintln!("leaves, bounce {depth}: {share:.5} of {} match", a.len());
        assert!(a.len() > 100 && share >= least, "bounce {depth}: {share} of {}", a.len());
    }
    for (way, settings) in [
        ("map", Settings { photons: 50_000, seed: 4, ..Settings::default() }),
        (
            "gather",
            Settings {
                photons: 10_000,
                indirect: Indirect::Gather,
                gather_rays: 2,
                area: Area::Surface,
                // Without points of irradiance: a path more or less, of different rounding, has others at every fourth photon.
                errors: true,
                ..Settings::default()
            },
        ),
    ] {
        let (a, b) = (film::<A>(&scene, &settings, 2, 48).beauty(), film::<B>(&scene, &settings, 2, 48).beauty());
        let mean = a.iter().flatten().sum::<f32>() / (3 * a.len()) as f32;
        let alike = share(&a, &b, |a, b| near(*a, *b, 0.01 * mean));
        eprintln!("leaves, {way}: {alike:.4} of the pixels");
        assert!(alike >= 0.99, "{way}: {alike}");
    }
}

/// Two one-sided tests (Schuirmann 1987): with 95 % confidence the means differ by less than
/// `margin` of their value. One-sided 95 % quantile of the normal distribution: 1.645.
#[must_use]
pub fn equivalent(differences: &[f64], level: f64, margin: f64) -> bool {
    let (mean, _) = moments(differences);
    mean.abs() + 1.645 * standard_error(differences) < margin * level
}

/// Images with the same seeds, pass by pass: means are equivalent within 0.2 %.
pub fn means_are_equivalent<A: TestBackend, B: TestBackend>() {
    for name in SCENES {
        let scene = builtin(name).unwrap().build().unwrap();
        for (way, settings) in [
            ("map", Settings { photons: 20_000, ..Settings::default() }),
            ("gather", Settings { photons: 5000, indirect: Indirect::Gather, gather_rays: 2, ..Settings::default() }),
            (
                "debiased",
                Settings {
                    photons: 5000,
                    indirect: Indirect::Gather,
                    gather_rays: 2,
                    irradiance_every: Some(4),
                    area: Area::Surface,
                    ..Settings::default()
                },
            ),
            ("samples", Settings { photons: 5000, camera_samples: 4, ..Settings::default() }),
            (
                "knn",
                Settings {
                    photons: 20_000,
                    estimator: Estimator::Knn { k: 40, max_radius: None },
                    ..Settings::default()
                },
            ),
        ] {
            if ["debiased", "samples"].contains(&way) && name != "cornell-glass" {
                continue;
            }
            let (a, b) = (per_pass::<A>(&scene, &settings, 5, 24), per_pass::<B>(&scene, &settings, 5, 24));
            let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
            let level = moments(&a).0;
            eprintln!("{name}, {way}: {:+.2e} of the mean", moments(&differences).0 / level);
            assert!(equivalent(&differences, level, 0.002), "{name}, {way}: {a:?} {b:?}");
        }
    }
}

/// Images, pixel by pixel: at most 1 % of the pixels differ by more than 1 % of the image's mean.
pub fn pictures_are_alike<A: TestBackend, B: TestBackend>() {
    // The furnace tests nearby area lights.
    let built_in = |name| (name, builtin(name).unwrap().build().unwrap());
    let scenes = SCENES.into_iter().chain(["furnace"]).map(built_in);
    for (name, scene) in scenes.chain([("coarse balls", coarse_balls())]) {
        let settings = Settings { photons: 50_000, seed: 4, ..Settings::default() };
        let (a, b) = (film::<A>(&scene, &settings, 2, 48).beauty(), film::<B>(&scene, &settings, 2, 48).beauty());
        let mean = a.iter().flatten().sum::<f32>() / (3 * a.len()) as f32;
        let alike = share(&a, &b, |a, b| near(*a, *b, 0.01 * mean));
        eprintln!("{name}: {alike:.4} of the pixels");
        assert!(alike >= 0.99, "{name}: {alike}");
    }
}

/// Estimates over photons drawn in each backend's own memory: the simplest form of replay.
pub fn uniform_plane_replays<A: TestBackend, B: TestBackend>() {
    let mut uniform = Uniform::new(77);
    let mut draw = || (uniform.draw() * 2.0 - 1.0) as f32;
    let photons: Vec<_> = (0..20_000).map(|_| photon_at([draw(), draw(), 0.0])).collect();
    let queries: Vec<_> = (0..500).map(|_| query_at([draw(), draw(), 0.0], 0.1)).collect();
    let gather = EstimateParams::new(Search::Radius);
    let a = estimate::<A>(IndexKind::Morton, &photons, &queries, &gather);
    let b = estimate::<B>(IndexKind::Morton, &photons, &queries, &gather);
    // Powers are 1, so the sums are integers and exact.
    assert_eq!(a, b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_photon_does_not_match() {
        let a = Photon { power: [1.0; 3], ..Photon::default() };
        let moved = Photon { position: [2e-4, 0.0, 0.0], ..a };
        let dimmed = Photon { power: [0.99; 3], ..a };
        assert!(same_photon(&a, &a) && !same_photon(&a, &moved) && !same_photon(&a, &dimmed));
        assert!((matched(&[a, a, a], &[a, moved]) - 1.0).abs() < 1e-12);
        assert!(matched(&[a, moved], &[dimmed, a]) < 0.6);
    }

    #[test]
    fn a_missing_element_is_no_match() {
        assert!((share(&[1, 2, 3], &[1, 2], |a, b| a == b) - 2.0 / 3.0).abs() < 1e-12);
        assert!((share::<u32>(&[], &[], |a, b| a == b) - 1.0).abs() < 1e-12);
    }

    /// A bias of 0.3 % is not equivalence, however small the variance; nor is a variance that hides it.
    #[test]
    fn equivalence_fails_where_it_must() {
        assert!(equivalent(&[0.0, 1e-4, -1e-4, 0.0], 1.0, 0.002));
        assert!(!equivalent(&[0.003; 4], 1.0, 0.002));
        assert!(!equivalent(&[0.05, -0.05, 0.05, -0.05], 1.0, 0.002));
    }
}
