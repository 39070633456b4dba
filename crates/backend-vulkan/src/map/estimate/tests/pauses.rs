//! Searches that pause give the same results as those that do not.

use photon_core::random::SplitMix64;
use photon_core::{Backend, Estimate, EstimateParams, IndexKind, Kernel, Query, RadianceEstimator, Search};

use super::inputs::{photons, places, point_sets, queries, walls};
use super::maps::map;
use crate::map::estimate::VulkanEstimator;
use crate::map::estimate::search::MapSearch;
use crate::{Vulkan, VulkanBuffer, VulkanMap};

/// At every iteration, within leaves and runs of equal points, and occasionally.
const TURNS: [u32; 3] = [1, 60, 3000];

fn pausing(turns: u32) -> MapSearch {
    MapSearch { turns, ..MapSearch::default() }
}

fn estimates(
    on: &mut Vulkan,
    map: &VulkanMap,
    queries: &VulkanBuffer<Query>,
    search: Search,
    map_search: MapSearch,
) -> Vec<Estimate> {
    let gather = EstimateParams { kernel: Kernel::Epanechnikov, min_normal_cosine: 0.3, ..EstimateParams::new(search) };
    let mut estimates = on.alloc("estimates", queries.capacity()).unwrap();
    VulkanEstimator { search: map_search, ..VulkanEstimator::default() }
        .estimate(on, map, queries, &gather, &mut estimates)
        .unwrap();
    let mut found = Vec::new();
    on.download(&estimates, &mut found).unwrap();
    found
}

#[test]
fn estimates_are_the_same() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let photons = photons(&walls(1500));
    let map = map(&mut on, &photons, IndexKind::Morton);
    let queries = on.upload("queries", &queries(&places(&walls(300))[..9], 0.4)).unwrap();
    for search in [Search::Radius, Search::KNearest { k: 70 }, Search::Paper { max: 70, threshold: 5, factor: 1.0 }] {
        let expected = estimates(&mut on, &map, &queries, search, pausing(u32::MAX / 2));
        for turns in TURNS {
            assert_eq!(estimates(&mut on, &map, &queries, search, pausing(turns)), expected, "{search:?}, {turns}");
        }
    }
}

#[test]
fn rows_and_counts_are_the_same() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for (name, points) in point_sets() {
        let points = &points[..points.len().min(1000)];
        let map = map(&mut on, &photons(points), IndexKind::Median);
        let mut random = SplitMix64(5);
        let mut asked: Vec<_> = points.iter().copied().step_by(1 + points.len() / 20).collect();
        asked.extend((0..10).map(|_| random.point()));
        let queries = on.queries_at(&asked).unwrap();
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        let rows = on.nearest_sorted(&map, &queries, 40, 0.7, pausing(u32::MAX / 2)).unwrap();
        on.download(&rows, &mut expected).unwrap();
        for turns in TURNS {
            let rows = on.nearest_sorted(&map, &queries, 40, 0.7, pausing(turns)).unwrap();
            on.download(&rows, &mut found).unwrap();
            assert_eq!(found, expected, "rows of {name}, {turns}");
        }
        let counts = on.count_within(&map, &queries, 0.3).unwrap();
        on.download(&counts, &mut expected).unwrap();
        for turns in TURNS {
            let counts = on.count_paused(&map, &queries, 0.3, pausing(turns)).unwrap();
            on.download(&counts, &mut found).unwrap();
            assert_eq!(found, expected, "counts of {name}, {turns}");
        }
    }
}
