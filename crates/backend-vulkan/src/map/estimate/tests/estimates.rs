//! Estimates compared with backend-cpu's, which sums in f64.

use backend_cpu::Cpu;
use photon_core::random::SplitMix64;
use photon_core::{Backend, Estimate, EstimateParams, IndexKind, Kernel, Photon, Query, RadianceEstimator, Search};

use super::inputs::{caustic, photon, photons, places, point_sets, queries, walls};
use super::maps::map;
use crate::Vulkan;
use crate::map::estimate::VulkanEstimator;
use crate::map::estimate::search::MapSearch;

/// Relative to the largest possible sum of weights times powers for a kernel: rounding of each weight, of the
/// sums within a leaf, and of the differences of moments, which are up to 12 times as large as the result.
const TOLERANCE: f64 = 4e-6;

fn on_cpu(photons: &[Photon], queries: &[Query], gather: &EstimateParams, kind: IndexKind) -> Vec<Estimate> {
    let mut cpu = Cpu::with_threads(1).unwrap();
    let mut stages = cpu.map_stages(kind).unwrap();
    let photons = cpu.upload("photons: global", photons).unwrap();
    let map = stages.builder.build(&mut cpu, photons).unwrap();
    let queries = cpu.upload("queries", queries).unwrap();
    let mut estimates = cpu.alloc("estimates", queries.as_slice().len() as u64).unwrap();
    stages.estimator.estimate(&mut cpu, &map, &queries, gather, &mut estimates).unwrap();
    estimates.as_slice().to_vec()
}

fn on_device(
    on: &mut Vulkan,
    photons: &[Photon],
    queries: &[Query],
    gather: &EstimateParams,
    kind: IndexKind,
) -> Vec<Estimate> {
    let map = map(on, photons, kind);
    let queries = on.upload("queries", queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.capacity()).unwrap();
    VulkanEstimator::default().estimate(on, &map, &queries, gather, &mut estimates).unwrap();
    let mut found = Vec::new();
    on.download(&estimates, &mut found).unwrap();
    found
}

/// Describes the difference, if any: counts, flags and radii must be equal, fluxes within the tolerance.
fn compare(found: &[Estimate], expected: &[Estimate], largest: f64) -> Result<(), String> {
    if found.len() != expected.len() {
        return Err(format!("{} estimates instead of {}", found.len(), expected.len()));
    }
    for (at, (a, b)) in found.iter().zip(expected).enumerate() {
        let same = a.photons == b.photons
            && a.flags == b.flags
            && a.radius_squared.to_bits() == b.radius_squared.to_bits()
            && a.power_sums == [0.0; 2];
        let scale = largest * f64::from(b.photons);
        let near = |(x, y): (&f32, &f32)| (f64::from(*x) - f64::from(*y)).abs() <= TOLERANCE * scale;
        if !same || !a.flux.iter().zip(&b.flux).all(near) {
            return Err(format!("estimate {at}: {a:?}, expected {b:?}"));
        }
    }
    Ok(())
}

fn check(
    on: &mut Vulkan,
    name: &str,
    points: &[[f32; 3]],
    places: &[[f32; 3]],
    radius: f32,
    searches: &[Search],
    cosines: &[f32],
) {
    let photons = photons(points);
    let queries = queries(places, radius);
    for &search in searches {
        for kernel in Kernel::ALL {
            for &min_normal_cosine in cosines {
                // A `max_plane_distance` below 1 is tested only for radius searches.
                let shares: &[f32] = if search == Search::Radius { &[1.0, 0.2] } else { &[1.0] };
                for &max_plane_distance in shares {
                    let gather = EstimateParams {
                        kernel,
                        radius_scale: 0.9,
                        min_normal_cosine,
                        max_plane_distance,
                        ..EstimateParams::new(search)
                    };
                    let expected = on_cpu(&photons, &queries, &gather, IndexKind::Morton);
                    let found = on_device(on, &photons, &queries, &gather, IndexKind::Morton);
                    // The largest kernel weight is 3.
                    if let Err(difference) = compare(&found, &expected, 3.0) {
                        panic!("{name}, {} points, radius {radius}, {gather:?}: {difference}", points.len());
                    }
                }
            }
        }
    }
}

#[test]
fn estimates_agree_with_the_processor() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let points = walls(4000);
    let searches = [
        Search::Radius,
        Search::KNearest { k: 2 },
        Search::NearestPhoton,
        Search::KNearest { k: 50 },
        Search::KNearest { k: 512 },
        Search::Paper { max: 40, threshold: 5, factor: 0.7 },
        Search::Paper { max: 1, threshold: 1, factor: 2.0 },
        Search::Paper { max: 30, threshold: 31, factor: 2.0 },
    ];
    let mut places = places(&points);
    // A row of an image, which ends within a tile.
    places.extend((0..101).map(|i| [i as f32 / 100.0, 0.0, 0.4]));
    for radius in [0.12, 1e-6, 50.0] {
        check(&mut on, "walls", &points, &places, radius, &searches, &[-1.0, 0.5]);
    }
}

#[test]
fn estimates_of_degenerate_sets() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let searches = [Search::Radius, Search::KNearest { k: 50 }, Search::NearestPhoton];
    for (name, points) in point_sets() {
        // Squared distances that overflow are infinite on both backends; NaN radii are not tested.
        let places: Vec<_> = places(&points).into_iter().filter(|p| p.iter().all(|c| c.abs() < 1e30)).collect();
        check(&mut on, name, &points, &places, 0.3, &searches, &[0.5]);
    }
}

/// Sums over a million photons are accurate.
#[test]
fn many_photons_add_up() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for search in [Search::Radius, Search::KNearest { k: 0 }] {
        let count = if search == Search::Radius || on.limits().loop_turns == 0 { 1_000_000 } else { 131_072 };
        let mut random = SplitMix64(8);
        let photons: Vec<Photon> = (0..count)
            .map(|i| {
                let mut photon = photon(&mut random, [0.0, height(i), 0.0]);
                photon.power = [1.0, 0.1, 1e-3 * (1 + i % 7) as f32];
                photon
            })
            .collect();
        let queries = queries(&[[0.0; 3]], 3.0);
        let search = if search == Search::Radius { search } else { Search::KNearest { k: count } };
        let gather = EstimateParams::new(search);
        let expected = on_cpu(&photons, &queries, &gather, IndexKind::Morton);
        let found = on_device(&mut on, &photons, &queries, &gather, IndexKind::Morton);
        assert_eq!(found[0].photons, count);
        for (a, b) in found[0].flux.iter().zip(&expected[0].flux) {
            let error = (f64::from(*a) / f64::from(*b) - 1.0).abs();
            assert!(error < 2e-7, "{search:?}: {a} instead of {b}");
        }
    }
}

/// Sorting queries does not change the results, and unused elements of a buffer get none.
#[test]
fn sorted_queries_find_the_same() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let photons = photons(&walls(4000));
    let map = map(&mut on, &photons, IndexKind::Morton);
    let mut random = SplitMix64(12);
    let mut places: Vec<_> = (0..500).map(|_| random.point()).collect();
    places.extend(super::inputs::places(&walls(300)));
    let queries = queries(&places, 0.3);
    let mut there = on.upload("queries", &[queries.clone(), vec![Query::default(); 90]].concat()).unwrap();
    on.set_length(&mut there, queries.len() as u64).unwrap();
    for search in [Search::Radius, Search::KNearest { k: 30 }] {
        let gather = EstimateParams {
            kernel: Kernel::Epanechnikov,
            radius_scale: 0.5,
            min_normal_cosine: 0.5,
            ..EstimateParams::new(search)
        };
        let mut estimates = on.alloc("estimates", there.capacity()).unwrap();
        let mut estimator = VulkanEstimator {
            search: MapSearch { worth_order: 0, ..MapSearch::default() },
            ..VulkanEstimator::default()
        };
        for _ in 0..2 {
            estimator.estimate(&mut on, &map, &there, &gather, &mut estimates).unwrap();
            let mut found = Vec::new();
            on.download(&estimates, &mut found).unwrap();
            assert_eq!(compare(&found, &on_cpu(&photons, &queries, &gather, IndexKind::Morton), 3.0), Ok(()));
        }
    }
}

/// Bins of 32 bits, which only very large k need.
#[test]
fn wide_bins_find_the_same() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let photons = photons(&walls(3000));
    let map = map(&mut on, &photons, IndexKind::Morton);
    let queries = queries(&places(&walls(300))[..12], 0.5);
    let there = on.upload("queries", &queries).unwrap();
    for k in [20, 500] {
        let gather = EstimateParams {
            kernel: Kernel::Epanechnikov,
            min_normal_cosine: 0.5,
            ..EstimateParams::new(Search::KNearest { k })
        };
        let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
        let mut estimator = VulkanEstimator {
            search: MapSearch { narrow_bins: 10, ..MapSearch::default() },
            ..VulkanEstimator::default()
        };
        estimator.estimate(&mut on, &map, &there, &gather, &mut estimates).unwrap();
        let mut found = Vec::new();
        on.download(&estimates, &mut found).unwrap();
        assert_eq!(compare(&found, &on_cpu(&photons, &queries, &gather, IndexKind::Morton), 3.0), Ok(()));
    }
}

fn height(i: u32) -> f32 {
    i.wrapping_mul(2_654_435_769) as f32 / 4_294_967_296.0
}

#[test]
fn the_same_twice() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let photons = photons(&caustic(10_000, 0.05));
    let queries = queries(&places(&walls(3000)), 0.2);
    let gather = EstimateParams {
        kernel: Kernel::Epanechnikov,
        min_normal_cosine: 0.5,
        ..EstimateParams::new(Search::KNearest { k: 60 })
    };
    let first = on_device(&mut on, &photons, &queries, &gather, IndexKind::Median);
    assert_eq!(first, on_device(&mut on, &photons, &queries, &gather, IndexKind::Median));
}

#[test]
fn typical_radii_agree_with_the_processor() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for (points, neighbours) in [(walls(5000), 20), (caustic(3000, 0.01), 50), (walls(30), 40), (walls(30), 25)] {
        let photons = photons(&points);
        let mut cpu = Cpu::with_threads(1).unwrap();
        let mut stages = cpu.map_stages(IndexKind::Median).unwrap();
        let uploaded = cpu.upload("photons: global", &photons).unwrap();
        let cpu_map = stages.builder.build(&mut cpu, uploaded).unwrap();
        let expected = stages.estimator.neighbour_radius(&mut cpu, &cpu_map, neighbours, 0.5).unwrap();
        let map = map(&mut on, &photons, IndexKind::Median);
        let found = VulkanEstimator::default().neighbour_radius(&mut on, &map, neighbours, 0.5).unwrap();
        assert_eq!(found, expected, "{} points", points.len());
    }
}

/// An estimate from one more photon, of another power or with another kernel: the comparison must detect it.
#[test]
fn the_comparison_can_fail() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut photons = photons(&walls(300));
    let queries = queries(&[[0.5, 0.0, 0.5]], 0.4);
    let gather = EstimateParams { kernel: Kernel::Epanechnikov, ..EstimateParams::new(Search::Radius) };
    let expected = on_cpu(&photons, &queries, &gather, IndexKind::Morton);
    let mut same = |photons: &[Photon], gather: &EstimateParams| {
        compare(&on_device(&mut on, photons, &queries, gather, IndexKind::Morton), &expected, 3.0)
    };
    assert_eq!(same(&photons, &gather), Ok(()));
    assert!(same(&photons, &EstimateParams { kernel: Kernel::Constant, ..gather }).is_err());
    assert!(same(&photons, &EstimateParams { min_normal_cosine: 0.5, ..gather }).is_err());
    let near = photons.iter().position(|p| p.position[1] == 0.0 && (p.position[0] - 0.5).abs() < 0.1).unwrap();
    photons[near].power[1] += 1e-2;
    assert!(same(&photons, &gather).is_err());
    photons[near].position[1] = 9.0;
    assert!(same(&photons, &gather).is_err());
}
