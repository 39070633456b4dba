//! Rows of ids and counts are equal to backend-cpu's, word for word.

use backend_cpu::index::PointIndex;
use photon_core::random::SplitMix64;
use photon_core::{Backend, Error, IndexKind};

use super::inputs::{caustic, photons, places, point_sets, walls};
use super::maps::map;
use crate::Vulkan;
use crate::map::estimate::search::MapSearch;

const KINDS: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

/// Describes the first difference, if any.
fn compare(what: &str, found: &[u32], expected: &[u32], width: usize) -> Result<(), String> {
    if found.len() != expected.len() {
        return Err(format!("{what}: {} words instead of {}", found.len(), expected.len()));
    }
    match found.iter().zip(expected).position(|(a, b)| a != b) {
        None => Ok(()),
        Some(at) => {
            let (query, rank) = (at / width, at % width);
            Err(format!("{what}, query {query}, rank {rank}: {}, expected {}", found[at], expected[at]))
        }
    }
}

/// Compares searches around `places` with those of backend-cpu on `expected_points`.
fn check(
    on: &mut Vulkan,
    points: &[[f32; 3]],
    expected_points: &[[f32; 3]],
    places: &[[f32; 3]],
    kind: IndexKind,
    ks: &[u32],
    radii: &[f32],
) -> Result<(), String> {
    let index = PointIndex::build(expected_points, kind).unwrap();
    let map = map(on, &photons(points), kind);
    let queries = on.queries_at(places).unwrap();
    let mut found = Vec::new();
    for &radius in radii {
        for &k in ks {
            let rows = on.nearest(&map, &queries, k, radius).unwrap();
            on.download(&rows, &mut found).unwrap();
            let mut expected = vec![0; places.len() * k as usize];
            index.nearest_many(places, k as usize, radius * radius, &mut expected).unwrap();
            compare(&format!("{k} nearest within {radius}"), &found, &expected, k as usize)?;
        }
        let counts = on.count_within(&map, &queries, radius).unwrap();
        on.download(&counts, &mut found).unwrap();
        let mut expected = vec![0; places.len()];
        index.count_within_many(places, radius * radius, &mut expected);
        compare(&format!("count within {radius}"), &found, &expected, 1)?;
    }
    Ok(())
}

#[test]
fn searches_agree_with_the_processor() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    for (name, points) in point_sets() {
        for kind in KINDS {
            let places = places(&points);
            let result = check(&mut on, &points, &points, &places, kind, &[1, 7, 50, 300], &[f32::INFINITY, 0.3, 0.0]);
            if let Err(difference) = result {
                panic!("{name}, {} points, {kind:?}: {difference}", points.len());
            }
        }
    }
}

/// All k up to 512 and some larger ones, and more queries than a workgroup processes at a time.
#[test]
fn any_k_is_exact() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let count = 20_000;
    let points = caustic(count, 0.02);
    let mut random = SplitMix64(6);
    let places: Vec<_> =
        (0..300).map(|i| if i % 20 == 19 { random.point() } else { [0.25 + i as f32 / 3000.0, 0.0, 0.7] }).collect();
    let all = count as u32;
    let ks: Vec<u32> = (1..=16).chain((17..512).step_by(55)).chain([512, 513, 2048, 2049, all, all + 1]).collect();
    check(&mut on, &points, &points, &places[..40], IndexKind::Morton, &ks, &[f32::INFINITY]).unwrap();
    check(&mut on, &points, &points, &places, IndexKind::Median, &[3, 50], &[f32::INFINITY, 0.01]).unwrap();
}

/// Sorting the queries does not change the position of the rows.
#[test]
fn sorted_queries_find_the_same() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let points = walls(3000);
    let mut random = SplitMix64(7);
    let places: Vec<_> = (0..400).map(|_| random.point()).collect();
    let map = map(&mut on, &photons(&points), IndexKind::Morton);
    let queries = on.queries_at(&places).unwrap();
    let search = MapSearch { worth_order: 0, ..MapSearch::default() };
    let rows = on.nearest_sorted(&map, &queries, 20, 0.4, search).unwrap();
    let mut found = Vec::new();
    on.download(&rows, &mut found).unwrap();
    let mut expected = vec![0; places.len() * 20];
    let index = PointIndex::build(&points, IndexKind::Morton).unwrap();
    index.nearest_many(&places, 20, 0.4 * 0.4, &mut expected).unwrap();
    assert_eq!(compare("20 nearest", &found, &expected, 20), Ok(()));
}

/// A set on which naive searches take minutes.
#[test]
fn a_million_equal_points() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut points = vec![[0.25, 0.5, 0.125]; 1_000_000];
    points[777_777] = [0.5; 3];
    let places = [[0.25, 0.5, 0.125], [0.25, 0.5, 0.2], [0.5; 3], [3.0, 0.0, 0.0]];
    check(&mut on, &points, &points, &places, IndexKind::Morton, &[50, 200], &[f32::INFINITY]).unwrap();
}

/// One point moved, two swapped, one missing: the comparison must detect it.
#[test]
fn the_comparison_can_fail() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let points = walls(500);
    let places = [[0.5, 0.0, 0.5]];
    let mut same = |expected_points: &[[f32; 3]]| {
        check(&mut on, &points, expected_points, &places, IndexKind::Median, &[499], &[f32::INFINITY, 0.4])
    };
    assert_eq!(same(&points), Ok(()));
    let mut moved = points.clone();
    moved[123] = [0.5, 0.0, 0.5];
    assert!(same(&moved).is_err());
    let mut swapped = points.clone();
    swapped.swap(7, 8);
    assert!(same(&swapped).is_err());
    assert!(same(&points[..498]).is_err());
}

#[test]
fn nonsense_is_refused_or_finds_nothing() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let map = map(&mut on, &photons(&walls(100)), IndexKind::Morton);
    let queries = on.queries_at(&[[f32::NAN, 0.0, 0.0], [0.5, 0.0, 0.5]]).unwrap();
    for radius in [f32::NAN, -1.0] {
        assert!(matches!(on.nearest(&map, &queries, 3, radius), Err(Error::InvalidSetting { name: "max_radius", .. })));
        assert!(matches!(on.count_within(&map, &queries, radius), Err(Error::InvalidSetting { name: "radius", .. })));
    }
    let mut found = Vec::new();
    let rows = on.nearest(&map, &queries, 2, 10.0).unwrap();
    on.download(&rows, &mut found).unwrap();
    assert_eq!(found[..2], [u32::MAX; 2]);
    assert!(found[2..].iter().all(|&id| id < 100));
    let counts = on.count_within(&map, &queries, 10.0).unwrap();
    on.download(&counts, &mut found).unwrap();
    assert_eq!(found, [0, 100]);
    let rows = on.nearest(&map, &queries, 0, 10.0).unwrap();
    on.download(&rows, &mut found).unwrap();
    assert!(found.is_empty());
    let none = on.queries_at(&[]).unwrap();
    let rows = on.nearest(&map, &none, 5, 10.0).unwrap();
    on.download(&rows, &mut found).unwrap();
    assert!(found.is_empty());
}
