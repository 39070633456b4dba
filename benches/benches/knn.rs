//! Photon search compared with kiddo 6.3, single-threaded, alternating within one run.
//!
//! `cargo bench -p photon-benches --bench knn`. Environment: `KNN_POINTS` (default 1000000),
//! `KNN_QUERIES` (100000), `KNN_ROUNDS` (5), `KNN_RIVALS` (words; rivals whose name contains none of them are
//! excluded).
//! With `--features kiddo-simd` and `RUSTFLAGS="-C target-cpu=native"` kiddo's SIMD layouts are included.
//!
//! Before timing, the distances of every contestant are compared with those of the first one. Times are
//! medians over the rounds; as each round runs all contestants in turn, a slower or
//! busier machine affects them equally.
#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use backend_cpu::index::{IndexKind, Neighbours, PointIndex};
use kiddo::leaf_strategies::{FlatVec, VecOfArenas};
use kiddo::{Donnelly, Eytzinger, KdTree, SquaredEuclidean};
use photon_core::random::SplitMix64;
use std::hint::black_box;
use std::num::NonZero;
use std::time::Instant;

fn main() {
    let setting = |name: &str, default: usize| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let (count, queries, rounds) =
        (setting("KNN_POINTS", 1_000_000), setting("KNN_QUERIES", 100_000), setting("KNN_ROUNDS", 5));
    let side = (queries as f64).sqrt().ceil() as usize;
    // One thread for every contestant, in queries and builds.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let surface = points(count, false);
        let caustic = points(count, true);
        workload("surface", &surface, &picture(side, queries, false), rounds);
        workload("caustic", &caustic, &picture(side, queries, false), rounds);
        workload("caustic, zoom", &caustic, &picture(side, queries, true), rounds);
    });
}

/// One implementation with one layout.
trait Contestant {
    fn name(&self) -> String;
    fn ours(&self) -> bool;
    /// Rebuilds the index; the last one is kept.
    fn build(&mut self, points: &[[f32; 3]]);
    /// Runs all queries; returns a sum that depends on every neighbour.
    fn nearest(&self, queries: &[[f32; 3]], k: usize) -> f64;
    fn within(&self, queries: &[[f32; 3]], r2: f32) -> (f64, u64);
    /// Squared distances, nearest first.
    fn distances(&self, query: [f32; 3], k: usize) -> Vec<f32>;
}

struct Ours {
    kind: IndexKind,
    index: Option<PointIndex>,
}

impl Ours {
    fn index(&self) -> &PointIndex {
        self.index.as_ref().expect("built before it is searched")
    }
}

impl Contestant for Ours {
    fn name(&self) -> String {
        format!("ours {:?}", self.kind)
    }

    fn ours(&self) -> bool {
        true
    }

    fn build(&mut self, points: &[[f32; 3]]) {
        self.index = None;
        self.index = Some(PointIndex::build(points, self.kind).expect("finite points"));
    }

    fn nearest(&self, queries: &[[f32; 3]], k: usize) -> f64 {
        let (mut found, mut sum) = (Neighbours::new(), 0.0);
        for &query in queries {
            self.index().nearest_of_all(query, k, f32::INFINITY, &mut found);
            for n in found.as_slice() {
                sum += f64::from(n.d2) + f64::from(n.id);
            }
        }
        sum
    }

    fn within(&self, queries: &[[f32; 3]], r2: f32) -> (f64, u64) {
        let (mut sum, mut count) = (0.0, 0);
        for &query in queries {
            (sum, count) = self.index().fold_within(query, r2, (sum, count), |(sum, count), slot, d2| {
                (sum + f64::from(d2) + f64::from(slot), count + 1)
            });
        }
        (sum, count)
    }

    fn distances(&self, query: [f32; 3], k: usize) -> Vec<f32> {
        let mut found = Neighbours::new();
        self.index().nearest_of_all(query, k, f32::INFINITY, &mut found);
        found.as_slice().iter().map(|n| n.d2).collect()
    }
}

/// A kiddo tree, by the layout of its inner nodes and of its leaves.
macro_rules! kiddo_tree {
    ($contestant:ident, $name:literal, $stem:ty, $leaves:ty, $bucket:literal) => {
        #[derive(Default)]
        struct $contestant(Option<KdTree<f32, u32, $stem, $leaves, 3, $bucket>>);

        impl Contestant for $contestant {
            fn name(&self) -> String {
                format!("kiddo {}", $name)
            }

            fn ours(&self) -> bool {
                false
            }

            fn build(&mut self, points: &[[f32; 3]]) {
                self.0 = None;
                self.0 = Some(KdTree::new_from_slice(points).expect("kiddo builds"));
            }

            fn nearest(&self, queries: &[[f32; 3]], k: usize) -> f64 {
                let tree = self.0.as_ref().expect("built before it is searched");
                let k = NonZero::new(k).expect("k > 0");
                let mut scratch = tree.create_scratch::<SquaredEuclidean<f32>>();
                let mut sum = 0.0;
                for query in queries {
                    let found =
                        tree.query(query).nearest_n::<SquaredEuclidean<f32>>(k).with_scratch(&mut scratch).execute();
                    for n in &found {
                        sum += f64::from(n.distance) + f64::from(n.item);
                    }
                }
                sum
            }

            fn within(&self, queries: &[[f32; 3]], r2: f32) -> (f64, u64) {
                let tree = self.0.as_ref().expect("built before it is searched");
                let mut scratch = tree.create_scratch::<SquaredEuclidean<f32>>();
                let (mut sum, mut count) = (0.0, 0);
                for query in queries {
                    tree.query(query).within::<SquaredEuclidean<f32>>(r2).unsorted().with_scratch(&mut scratch).visit(
                        |n| {
                            sum += f64::from(n.distance) + f64::from(n.item);
                            count += 1;
                        },
                    );
                }
                (sum, count)
            }

            fn distances(&self, query: [f32; 3], k: usize) -> Vec<f32> {
                let tree = self.0.as_ref().expect("built before it is searched");
                let k = NonZero::new(k).expect("k > 0");
                tree.query(&query).nearest_n::<SquaredEuclidean<f32>>(k).execute().iter().map(|n| n.distance).collect()
            }
        }
    };
}

kiddo_tree!(EytzingerArenas, "Eytzinger arenas 32", Eytzinger, VecOfArenas<f32, u32, 3, 32>, 32);
kiddo_tree!(DonnellyArenas, "Donnelly arenas 32", Donnelly<4>, VecOfArenas<f32, u32, 3, 32>, 32);
kiddo_tree!(EytzingerFlat, "Eytzinger flat 32", Eytzinger, FlatVec<f32, u32, 3, 32>, 32);
kiddo_tree!(DonnellyFlat, "Donnelly flat 32", Donnelly<4>, FlatVec<f32, u32, 3, 32>, 32);
#[cfg(feature = "kiddo-simd")]
kiddo_tree!(DescentArenas, "SIMD descent arenas 32", kiddo::DonnellySimdDescent<4>, VecOfArenas<f32, u32, 3, 32>, 32);
#[cfg(feature = "kiddo-simd")]
kiddo_tree!(FullArenas, "SIMD full arenas 32", kiddo::DonnellySimdFull<4>, VecOfArenas<f32, u32, 3, 32>, 32);
#[cfg(feature = "kiddo-simd")]
kiddo_tree!(CyclicArenas, "cyclic SIMD full arenas 32", kiddo::DonnellyCyclicSimdFull<4>, VecOfArenas<f32, u32, 3, 32>, 32);
#[cfg(feature = "kiddo-simd")]
kiddo_tree!(CyclicFlat, "cyclic SIMD full flat 32", kiddo::DonnellyCyclicSimdFull<4>, FlatVec<f32, u32, 3, 32>, 32);

fn contestants() -> Vec<Box<dyn Contestant>> {
    let mut all: Vec<Box<dyn Contestant>> = Vec::new();
    for kind in [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton] {
        all.push(Box::new(Ours { kind, index: None }));
    }
    let mut rivals: Vec<Box<dyn Contestant>> = vec![
        Box::<EytzingerArenas>::default(),
        Box::<DonnellyArenas>::default(),
        Box::<EytzingerFlat>::default(),
        Box::<DonnellyFlat>::default(),
    ];
    #[cfg(feature = "kiddo-simd")]
    {
        rivals.push(Box::<DescentArenas>::default());
        rivals.push(Box::<FullArenas>::default());
        rivals.push(Box::<CyclicArenas>::default());
        rivals.push(Box::<CyclicFlat>::default());
    }
    let words = std::env::var("KNN_RIVALS").unwrap_or_default();
    rivals.retain(|r| words.is_empty() || words.split_whitespace().any(|word| r.name().contains(word)));
    all.append(&mut rivals);
    all
}

fn workload(name: &str, points: &[[f32; 3]], queries: &[[f32; 3]], rounds: usize) {
    let mut all = contestants();
    let names: Vec<(String, bool)> = all.iter().map(|c| (c.name(), c.ours())).collect();
    println!("\n## {name}: {} points, {} queries, one thread", points.len(), queries.len());
    println!("{:<34}{:<30}{:>10}{:>12}{:>9}", "work", "contestant", "seconds", "per second", "ratio");
    let times = race(rounds.min(3), all.len(), |c| all[c].build(points));
    report("build", &names, &times, points.len());
    compare(&mut all, queries);
    let names: Vec<(String, bool)> = all.iter().map(|c| (c.name(), c.ours())).collect();
    let shared: &[Box<dyn Contestant>] = &all;
    for k in [50, 200] {
        let times = race(rounds, shared.len(), |c| {
            black_box(shared[c].nearest(queries, k));
        });
        report(&format!("k-NN, k = {k}"), &names, &times, queries.len());
    }
    for target in [50, 200] {
        // The radius that contains that many points on average, over some queries.
        let mut radii: Vec<f32> =
            queries.iter().step_by(97).map(|&q| shared[0].distances(q, target)[target - 1]).collect();
        radii.sort_by(f32::total_cmp);
        let r2 = radii[radii.len() / 2];
        let (mut low, mut high) = (u64::MAX, 0);
        let times = race(rounds, shared.len(), |c| {
            let (sum, count) = shared[c].within(queries, r2);
            black_box(sum);
            (low, high) = (low.min(count), high.max(count));
        });
        // Rivals may use fused operations, and so decide differently on a point at the radius.
        assert!(high - low <= high / 1_000_000, "between {low} and {high} found within the radius");
        report(&format!("radius, {:.0} inside", low as f64 / queries.len() as f64), &names, &times, queries.len());
    }
}

/// Seconds of every contestant in every round.
fn race(rounds: usize, contestants: usize, mut run: impl FnMut(usize)) -> Vec<f64> {
    let mut seconds = vec![Vec::new(); contestants];
    for _ in 0..rounds {
        for (contestant, own) in seconds.iter_mut().enumerate() {
            let start = Instant::now();
            run(contestant);
            own.push(start.elapsed().as_secs_f64());
        }
    }
    seconds
        .into_iter()
        .map(|mut own| {
            own.sort_by(f64::total_cmp);
            own[own.len() / 2]
        })
        .collect()
}

/// Prints one line each; the ratio is to the fastest rival.
fn report(work: &str, names: &[(String, bool)], times: &[f64], items: usize) {
    let rival = times.iter().zip(names).filter(|(_, n)| !n.1).map(|(&t, _)| t).fold(f64::INFINITY, f64::min);
    for ((name, _), &time) in names.iter().zip(times) {
        println!("{work:<34}{name:<30}{time:>10.4}{:>10.0} k{:>9.2}", items as f64 / time / 1e3, rival / time);
    }
}

/// All of ours must find the same distances; a rival that does not is named and excluded.
fn compare(all: &mut Vec<Box<dyn Contestant>>, queries: &[[f32; 3]]) {
    let sample: Vec<_> = queries.iter().step_by(211).map(|&query| (query, all[0].distances(query, 50))).collect();
    all.retain(|contestant| {
        let wrong = sample.iter().find(|(query, expected)| {
            let found = contestant.distances(*query, 50);
            // Rivals may use fused operations.
            !(found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs()))
        });
        if let Some((query, _)) = wrong {
            assert!(!contestant.ours(), "{} is wrong at {query:?}", contestant.name());
            println!("{} misses neighbours of {query:?} and is left out", contestant.name());
        }
        wrong.is_none()
    });
}

/// Centre and radius of the caustic on the floor.
const DISC: ([f64; 3], f64) = ([0.6, 0.0, 0.4], 0.05);

/// Points on five walls of the unit box; as a caustic, nine of ten in the disc, with density 1/r.
fn points(count: usize, caustic: bool) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(7);
    (0..count)
        .map(|_| {
            if caustic && random.unit_f64() < 0.9 {
                let (r, angle) = (DISC.1 * random.unit_f64(), std::f64::consts::TAU * random.unit_f64());
                return [DISC.0[0] + r * angle.cos(), 0.0, DISC.0[2] + r * angle.sin()].map(|c| c as f32);
            }
            let (u, v) = (random.unit_f64(), random.unit_f64());
            match (random.unit_f64() * 5.0) as u32 {
                0 => [u, 0.0, v],
                1 => [u, 1.0, v],
                2 => [0.0, u, v],
                3 => [1.0, u, v],
                _ => [u, v, 1.0],
            }
            .map(|c| c as f32)
        })
        .collect()
}

/// Points seen by a camera in front of the open side, row by row; zoomed in, a square inside the disc.
fn picture(side: usize, count: usize, zoom: bool) -> Vec<[f32; 3]> {
    (0..count)
        .map(|pixel| {
            let (u, v) = (((pixel % side) as f64 + 0.5) / side as f64, ((pixel / side) as f64 + 0.5) / side as f64);
            if zoom {
                let half = DISC.1 / 2_f64.sqrt();
                return [DISC.0[0] + (2.0 * u - 1.0) * half, 0.0, DISC.0[2] + (2.0 * v - 1.0) * half].map(|c| c as f32);
            }
            let eye = [0.5, 0.5, -1.4];
            let direction = [(u - 0.5) * 0.7, (0.5 - v) * 0.7, 1.0];
            // The nearest wall ahead.
            let mut t = (1.0 - eye[2]) / direction[2];
            for axis in 0..2 {
                let wall = if direction[axis] > 0.0 { 1.0 } else { 0.0 };
                if direction[axis] != 0.0 {
                    t = t.min((wall - eye[axis]) / direction[axis]);
                }
            }
            [0, 1, 2].map(|axis| (eye[axis] + t * direction[axis]) as f32)
        })
        .collect()
}
