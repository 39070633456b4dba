//! Every kind of index, on every instruction set, against brute force.

use super::dispatch::Isa;
use super::layout::{LEAF, MAX_DEPTH, WIDTH};
use super::{IndexError, IndexKind, Neighbour, Neighbours, PointIndex};

const KINDS: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

/// A small generator of our own: tests must not change with a dependency. (SplitMix64, Steele, Lea and
/// Flood 2014.)
pub(super) struct Random(pub(super) u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 * (1.0 / (1 << 24) as f32)
    }

    pub(super) fn point(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }
}

fn square_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [dx, dy, dz] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dx * dx + dy * dy + dz * dz
}

/// All points within `r2` that `accept` lets through, by (distance, id).
fn brute_force(points: &[[f32; 3]], query: [f32; 3], r2: f32, accept: impl Fn(u32) -> bool) -> Vec<(f32, u32)> {
    let mut all: Vec<(f32, u32)> = points
        .iter()
        .enumerate()
        .map(|(id, &p)| (square_distance(query, p), id as u32))
        .filter(|&(d2, id)| d2 <= r2 && accept(id))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    all
}

fn pairs(found: &[Neighbour]) -> Vec<(f32, u32)> {
    found.iter().map(|n| (n.d2, n.id)).collect()
}

/// Point sets that break search structures.
fn point_sets() -> Vec<(&'static str, Vec<[f32; 3]>)> {
    let mut random = Random(1);
    let mut many =
        |n: usize, f: &mut dyn FnMut(&mut Random) -> [f32; 3]| (0..n).map(|_| f(&mut random)).collect::<Vec<_>>();
    let mut sets = vec![
        ("none", Vec::new()),
        ("one", vec![[0.25, -3.0, 7.5]]),
        ("two", vec![[0.0; 3], [1.0, 0.0, 0.0]]),
        ("random", many(3000, &mut Random::point)),
        ("identical", vec![[0.5, 0.25, -1.0]; 2000]),
        ("zeros of both signs", (0..100).map(|i| if i % 2 == 0 { [0.0; 3] } else { [-0.0; 3] }).collect()),
        (
            "collinear",
            many(1000, &mut |r| {
                let t = r.unit();
                [t, 2.0 * t, -t]
            }),
        ),
        ("one axis", many(1000, &mut |r| [3.0, r.unit(), 4.0])),
        ("coplanar", many(1500, &mut |r| [r.unit(), 1.0, r.unit()])),
        ("lattice with duplicates", many(2000, &mut |r| r.point().map(|c| (c * 6.0).floor()))),
        ("tiny", many(600, &mut |r| r.point().map(|c| c * 1e-30))),
        ("subnormal", many(600, &mut |r| r.point().map(|c| c * 1e-42))),
        ("huge", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2e30))),
        ("limits", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2.0 * f32::MAX))),
        (
            "all scales",
            many(800, &mut |r| {
                let s = 10_f32.powf(r.unit() * 70.0 - 38.0);
                r.point().map(|c| (c - 0.5) * s)
            }),
        ),
        (
            "caustic",
            many(3000, &mut |r| {
                let (radius, angle) = (r.unit() * 1e-6, r.unit() * std::f32::consts::TAU);
                if r.unit() < 0.9 { [0.3 + radius * angle.cos(), 0.0, 0.7 + radius * angle.sin()] } else { r.point() }
            }),
        ),
        (
            "clusters",
            many(2000, &mut |r| {
                let c = r.point().map(|c| (c * 3.0).floor());
                let d = r.point();
                [c[0] + d[0] * 1e-6, c[1] + d[1] * 1e-6, c[2]]
            }),
        ),
    ];
    for n in [3, 15, 16, 17, 31, 32, 33, 63, 64, 65, 127, 128, 129, 255, 256, 257, 272, 511, 512, 513, 4095, 4096, 4097]
    {
        sets.push(("power of two", many(n, &mut Random::point)));
    }
    sets
}

/// Queries on, near and far from a set.
fn queries(points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut random = Random(2);
    let mut all =
        vec![[0.0; 3], [0.5; 3], [1e9, -1e9, 3.0], [f32::MAX; 3], [-f32::MAX, 0.0, 1e-40], [f32::INFINITY, 0.0, 0.0]];
    for _ in 0..6 {
        if let Some(&p) = points.get((random.unit() * points.len() as f32) as usize) {
            // A coincident one and one close by, in sequence, so that the second profits from the first.
            all.push(p);
            all.push(p.map(|c| c + c * 1e-3 * random.unit()));
        }
        all.push(random.point());
    }
    all
}

#[test]
fn searches_agree_with_brute_force() {
    for (name, points) in point_sets() {
        for kind in KINDS {
            let first = PointIndex::build(&points, kind).expect("finite points");
            let mut slots = first.order().to_vec();
            slots.sort_unstable();
            assert!(slots.iter().copied().eq(0..points.len() as u32), "{name} {kind:?}: a permutation");
            for isa in Isa::all() {
                let index = PointIndex::build_with(&points, kind, isa).expect("finite points");
                assert_eq!(index.order(), first.order(), "{name} {kind:?} {isa:?}");
                let mut found = Neighbours::new();
                for query in queries(&points) {
                    check_query(
                        &index,
                        &points,
                        query,
                        &mut found,
                        &format!("{name} ({}) {kind:?} {isa:?} {query:?}", points.len()),
                    );
                }
            }
        }
    }
}

fn check_query(index: &PointIndex, points: &[[f32; 3]], query: [f32; 3], found: &mut Neighbours, context: &str) {
    let all = brute_force(points, query, f32::INFINITY, |_| true);
    let middle = all.get(all.len() / 8).map_or(0.0, |n| n.0);
    for r2 in [0.0, middle, f32::INFINITY] {
        let mut within = Vec::new();
        index.within(query, r2, |slot, d2| within.push((d2, index.order()[slot as usize])));
        within.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let expected: Vec<_> = all.iter().copied().filter(|n| n.0 <= r2).collect();
        assert_eq!(within, expected, "{context} within {r2}");
        assert_eq!(index.count_within(query, r2) as usize, expected.len(), "{context} count within {r2}");
    }
    for (k, max_r2) in
        [(1, f32::INFINITY), (7, middle), (50, f32::INFINITY), (50, middle), (50, 0.0), (usize::MAX, middle)]
    {
        let expected: Vec<_> = all.iter().copied().filter(|n| n.0 <= max_r2).take(k).collect();
        // The second search starts from what the first remembered.
        for _ in 0..2 {
            index.nearest(query, k, max_r2, |_| true, found);
            assert_eq!(pairs(found.as_slice()), expected, "{context} k {k} within {max_r2}");
        }
        for n in found.as_slice() {
            assert_eq!(index.order()[n.slot as usize], n.id, "{context}");
        }
    }
    let odd = |slot: u32| index.order()[slot as usize] % 2 == 1;
    let expected: Vec<_> = all.iter().copied().filter(|n| n.1 % 2 == 1).take(20).collect();
    for _ in 0..2 {
        index.nearest(query, 20, f32::INFINITY, odd, found);
        assert_eq!(pairs(found.as_slice()), expected, "{context} odd ids only");
    }
}

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
                index.within(query, r2, |_, _| panic!("nothing is within"));
                assert_eq!(index.count_within(query, r2), 0);
            }
        }
    }
}

#[test]
fn points_that_are_not_finite_are_named() {
    let mut points = vec![[0.0; 3]; 100_000];
    points[77_777] = [1.0, f32::NAN, 0.0];
    points[99_999] = [f32::INFINITY; 3];
    for kind in KINDS {
        let error = PointIndex::build(&points, kind).expect_err("NaN");
        assert!(matches!(error, IndexError::NotFinite { index: 77_777, .. }), "{error:?}");
    }
}

#[test]
fn a_million_equal_points_are_no_trouble() {
    let points = vec![[0.1, 0.2, 0.3]; 1_000_000];
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        assert!(depth(&index) <= MAX_DEPTH);
        let mut found = Neighbours::new();
        for _ in 0..10_000 {
            index.nearest([0.1, 0.2, 0.3], 50, f32::INFINITY, |_| true, &mut found);
            assert!(found.as_slice().iter().map(|n| n.id).eq(0..50));
            assert_eq!(index.count_within([0.1, 0.2, 0.3], 0.0), 1_000_000);
        }
    }
}

/// Nodes from the root to the deepest block.
fn depth(index: &PointIndex) -> usize {
    fn below(index: &PointIndex, node: u32) -> usize {
        let children = index.tree.nodes[node as usize].child;
        1 + children.iter().filter(|&&c| c & LEAF == 0).map(|&c| below(index, c)).max().unwrap_or(0)
    }
    if index.is_empty() { 0 } else { below(index, 0) }
}

#[test]
fn depth_is_bounded_even_where_the_heuristic_peels() {
    // Every plane that halves the voxel leaves one point alone.
    let points: Vec<[f32; 3]> = (0..4000).map(|i| [2_f32.powi(-(i / 17)), 0.0, 0.0]).collect();
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        assert!(depth(&index) <= MAX_DEPTH, "{kind:?} {}", depth(&index));
    }
}

#[test]
fn batches_and_threads_change_nothing() {
    let mut random = Random(3);
    let points: Vec<_> = (0..60_000).map(|_| random.point()).collect();
    let queries: Vec<_> = (0..2_000).map(|_| random.point()).collect();
    for kind in KINDS {
        let mut results = Vec::new();
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            results.push(pool.install(|| {
                let index = PointIndex::build(&points, kind).expect("finite points");
                let mut nearest = vec![0; queries.len() * 9];
                index.nearest_many(&queries, 9, 0.01, &mut nearest);
                let mut counts = vec![0; queries.len()];
                index.count_within_many(&queries, 0.01, &mut counts);
                let mut one = Neighbours::new();
                for (row, (&query, &count)) in nearest.chunks(9).zip(queries.iter().zip(&counts)) {
                    index.nearest(query, 9, 0.01, |_| true, &mut one);
                    let ids = one.as_slice().iter().map(|n| n.id).chain(std::iter::repeat(u32::MAX));
                    assert!(row.iter().copied().eq(ids.take(9)));
                    assert_eq!(index.count_within(query, 0.01), count);
                }
                (index.order().to_vec(), nearest, counts)
            }));
        }
        assert!(results.iter().all(|r| *r == results[0]), "{kind:?}");
    }
}

#[test]
fn the_median_order_is_the_canonical_one() {
    // The rules of `median`, by sorting whole segments.
    fn arrange(segment: &mut [(u32, [f32; 3])]) {
        if segment.len() <= WIDTH {
            segment.sort_by_key(|p| p.0);
            return;
        }
        let side = |axis: usize| {
            let c = segment.iter().map(|p| p.1[axis]);
            c.clone().fold(f32::NEG_INFINITY, f32::max) - c.fold(f32::INFINITY, f32::min)
        };
        let axis = if side(0) >= side(1).max(side(2)) {
            0
        } else if side(1) >= side(2) {
            1
        } else {
            2
        };
        segment.sort_by(|a, b| a.1[axis].partial_cmp(&b.1[axis]).expect("finite").then(a.0.cmp(&b.0)));
        let mut left = WIDTH;
        while 2 * left < segment.len() {
            left *= 2;
        }
        let (low, high) = segment.split_at_mut(left);
        arrange(low);
        arrange(high);
    }
    for (name, points) in point_sets() {
        let mut segment: Vec<(u32, [f32; 3])> = points.iter().enumerate().map(|(id, &p)| (id as u32, p)).collect();
        arrange(&mut segment);
        let index = PointIndex::build(&points, IndexKind::Median).expect("finite points");
        assert!(index.order().iter().copied().eq(segment.iter().map(|p| p.0)), "{name}");
    }
}
