//! Compares searches with brute force.

use photon_core::random::SplitMix64;

use super::inputs::{point_sets, queries};
use super::oracle::check;
use super::{Isa, KINDS, Neighbours, PointIndex, Workspace};

#[test]
fn searches_agree_with_brute_force() {
    // Shared by all builds: leftovers from other point sets must not affect results.
    let mut workspace = Workspace::default();
    for (name, points) in point_sets() {
        for kind in KINDS {
            let first = PointIndex::build(&points, kind).expect("finite points");
            let mut ids = first.order().to_vec();
            ids.sort_unstable();
            assert!(ids.iter().copied().eq(0..points.len() as u32), "{name} {kind:?}: the order is not a permutation");
            for isa in Isa::all() {
                let index = PointIndex::build_with(&points, kind, isa, &mut workspace).expect("finite points");
                assert_eq!(index.order(), first.order(), "{name} {kind:?} {isa:?}");
                let mut found = Neighbours::new();
                for query in queries(&points) {
                    if let Err(difference) = check(&index, &points, query, &mut found) {
                        panic!("{name}, {} points, {kind:?}, {isa:?}: {difference}", points.len());
                    }
                }
            }
        }
    }
}

/// One point moved by a few ulps, one point more, or two points exchanged: the comparison must notice.
#[test]
fn the_comparison_can_fail() {
    let mut random = SplitMix64(4);
    let points: Vec<_> = (0..500).map(|_| random.point()).collect();
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        let mut found = Neighbours::new();
        let query = [0.5; 3];
        assert_eq!(check(&index, &points, query, &mut found), Ok(()));
        let mut moved = points.clone();
        moved[123][1] = f32::from_bits(moved[123][1].to_bits() + 64);
        assert!(check(&index, &moved, query, &mut found).is_err());
        assert!(check(&index, &points[..499], query, &mut found).is_err());
        let mut swapped = points.clone();
        swapped.swap(7, 8);
        assert!(check(&index, &swapped, query, &mut found).is_err());
    }
}

/// Coherent and jumping queries, as many as an image has, with guesses that are right, too small and too large.
#[test]
fn guesses_change_no_result() {
    let points = super::inputs::caustic(20_000, 0.05);
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        let (mut guided, mut random) = (Neighbours::new(), SplitMix64(6));
        for step in 0..2_000 {
            let t = step as f32 / 2_000.0;
            let query = if step % 50 == 49 { random.point() } else { [t, 0.0, 0.7] };
            let k = if step % 70 == 0 { 5 } else { 40 };
            index.nearest(query, k, f32::INFINITY, |_| true, &mut guided);
            let mut fresh = Neighbours::new();
            index.nearest(query, k, f32::INFINITY, |_| true, &mut fresh);
            assert_eq!(guided.as_slice(), fresh.as_slice(), "{kind:?} step {step}");
        }
    }
}

/// Few distinct positions, each shared by many points in any order of ids, and some far enough away that boxes
/// contain both. Of the points tied with the k-th, those with the lowest ids count, even if others were found
/// first. Found by the fuzz target `map`.
#[test]
fn ties_with_the_kth_are_settled_by_ids() {
    let mut random = SplitMix64(9);
    for _ in 0..60 {
        let steps = [0.0, 0.0, 0.0, 0.0, 0.0, -1e-23, -2e8, -1e21];
        let places: Vec<_> = (0..25).map(|_| random.point().map(|c| steps[(c * 8.0) as usize])).collect();
        let points = places.repeat(29);
        let query = [0.0, 0.125, 0.3];
        let expected = super::oracle::ranking(&points, query);
        for kind in KINDS {
            let index = PointIndex::build(&points, kind).expect("finite points");
            for k in 1..=64 {
                let mut found = Neighbours::new();
                index.nearest(query, k, f32::INFINITY, |_| true, &mut found);
                let found: Vec<_> = found.as_slice().iter().map(|n| (n.d2, n.id)).collect();
                assert_eq!(found, expected[..k], "{kind:?} {k}");
            }
        }
    }
}
