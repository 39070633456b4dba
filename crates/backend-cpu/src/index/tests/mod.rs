//! Compares every kind of index, on every instruction set, with brute force.

mod agreement;
mod inputs;
mod oracle;
mod structure;

use photon_core::random::SplitMix64;

use super::dispatch::Isa;
use super::{IndexError, IndexKind, Neighbours, PointIndex, Workspace};

const KINDS: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

#[test]
fn nothing_is_found_with_nan_or_zero_k() {
    for kind in KINDS {
        let index = PointIndex::build(&[[0.5; 3]; 40], kind).expect("finite points");
        let mut found = Neighbours::new();
        let nan = f32::NAN;
        for (query, k, r2) in [
            ([nan, 0.5, 0.5], 3, 1.0),
            ([0.5; 3], 3, nan),
            ([0.5; 3], 3, -1.0),
            ([0.5, 0.5, nan], 3, f32::INFINITY),
            ([0.5; 3], 0, 1.0),
        ] {
            index.nearest([0.5; 3], 3, 1.0, |_| true, &mut found);
            assert_eq!(found.as_slice().len(), 3);
            index.nearest(query, k, r2, |_| true, &mut found);
            assert_eq!(found.as_slice(), []);
            if k > 0 {
                index.within(query, r2, |_, _| panic!("no point may be found"));
                assert_eq!(index.count_within(query, r2), 0);
            }
        }
    }
}

#[test]
fn points_that_are_not_finite_are_named() {
    let mut points = vec![[0.0; 3]; 100_001];
    for (culprit, bad) in [(100_000, f32::NEG_INFINITY), (99_999, f32::INFINITY), (77_777, f32::NAN), (0, f32::NAN)] {
        points[culprit] = [1.0, bad, 0.0];
        for kind in KINDS {
            let error = PointIndex::build(&points, kind).expect_err("not finite");
            assert!(matches!(error, IndexError::NotFinite { index, .. } if index == culprit), "{error:?}");
        }
    }
}

#[test]
fn batches_and_threads_change_nothing() {
    let mut random = SplitMix64(3);
    // Enough points for every stage of every builder to run in parallel.
    let points: Vec<_> = (0..200_000).map(|_| random.point().map(|c| (c * 4096.0).floor() / 4096.0)).collect();
    let queries: Vec<_> = (0..2_000).map(|_| random.point()).collect();
    for kind in KINDS {
        let mut results = Vec::new();
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            results.push(pool.install(|| {
                let index = PointIndex::build(&points, kind).expect("finite points");
                let mut nearest = vec![0; queries.len() * 9];
                index.nearest_many(&queries, 9, 0.001, &mut nearest).unwrap();
                let mut counts = vec![0; queries.len()];
                index.count_within_many(&queries, 0.001, &mut counts);
                let mut one = Neighbours::new();
                for (row, (&query, &count)) in nearest.chunks(9).zip(queries.iter().zip(&counts)) {
                    index.nearest(query, 9, 0.001, |_| true, &mut one);
                    let ids = one.as_slice().iter().map(|n| n.id).chain(std::iter::repeat(u32::MAX));
                    assert!(row.iter().copied().eq(ids.take(9)));
                    assert_eq!(index.count_within(query, 0.001), count);
                }
                (index.order().to_vec(), nearest, counts)
            }));
        }
        assert!(results.iter().all(|r| *r == results[0]), "{kind:?}");
    }
}

#[test]
fn a_million_equal_points_are_no_trouble() {
    let points = vec![[0.1, 0.2, 0.3]; 1_000_000];
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        let mut found = Neighbours::new();
        let mut asked = 0;
        for _ in 0..100 {
            index.nearest(
                [0.1, 0.2, 0.3],
                50,
                f32::INFINITY,
                |_| {
                    asked += 1;
                    true
                },
                &mut found,
            );
            assert!(found.as_slice().iter().map(|n| n.id).eq(0..50));
            assert_eq!(index.count_within([0.1, 0.2, 0.3], 0.0), 1_000_000);
        }
        // A search visits no more points than it collects before it first discards some, plus some blocks.
        assert!(asked <= 100 * (4 * 50 + 64 + 2 * 50 + 32 + 64), "{kind:?}: {asked}");
    }
}

/// Nine tenths of the points are in a disc with a millionth of the extent. No query may visit more than a fixed
/// multiple of k points, wherever it is and whatever query preceded it.
#[test]
fn no_query_looks_at_much_more_than_it_finds() {
    let points = inputs::caustic(200_000, 1e-6);
    let mut random = SplitMix64(8);
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        let mut found = Neighbours::new();
        for turn in 0..600 {
            let jitter = random.point().map(|c| c - 0.5);
            // Cycle through inside the disc, at its edge, near it, and anywhere, so that guesses are as wrong as
            // possible.
            let scale = [5e-7, 2e-6, 1e-3, 1.0][turn % 4];
            let query = [0.3 + scale * jitter[0], 0.0, 0.7 + scale * jitter[2]];
            let mut asked = 0;
            index.nearest(
                query,
                50,
                f32::INFINITY,
                |_| {
                    asked += 1;
                    true
                },
                &mut found,
            );
            assert_eq!(found.as_slice().len(), 50);
            assert!(asked <= 40 * 50, "{kind:?} {query:?}: {asked}");
        }
    }
}

/// The instruction sets tested must include the baseline and the best one supported, so that there is something to
/// compare.
#[test]
fn the_baseline_is_always_among_those_tested() {
    let all = Isa::all();
    assert_eq!(all[0], Isa::Baseline);
    assert_eq!(all.last(), Some(&Isa::detect()));
}
