//! Any points, any queries: an index finds what brute force finds, or the points are rejected.
#![no_main]

use backend_cpu::index::{IndexKind, Neighbours, PointIndex};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let (Some(&first), data) = (data.first(), data.get(1..).unwrap_or_default()) else { return };
    let number = |at: &[u8]| f32::from_le_bytes([at[0], at[1], at[2], at[3]]);
    let mut rows = data.chunks_exact(12).map(|row| [number(&row[..4]), number(&row[4..8]), number(&row[8..])]);
    let (Some(query), Some([radius, ..])) = (rows.next(), rows.next()) else { return };
    let mut points: Vec<[f32; 3]> = rows.take(4000).collect();
    // Sometimes many copies of few points: trees over equal points.
    if first & 64 != 0 {
        points = points.repeat(1 + usize::from(first >> 2 & 7) * 4);
    }
    let kind = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton][usize::from(first % 3)];
    let finite = points.iter().flatten().all(|x| x.is_finite());
    let index = PointIndex::build(&points, kind);
    assert_eq!(index.is_ok(), finite);
    let Ok(index) = index else { return };
    let square = |p: &[f32; 3]| {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| p[axis] - query[axis]);
        x * x + y * y + z * z
    };
    let r2 = radius * radius;
    let mut expected: Vec<(f32, u32)> =
        points.iter().enumerate().map(|(id, p)| (square(p), id as u32)).filter(|(d2, _)| *d2 <= r2).collect();
    let mut found = 0;
    index.within(query, r2, |_, d2| {
        assert!(d2 <= r2);
        found += 1;
    });
    assert_eq!(found, expected.len());
    assert_eq!(index.count_within(query, r2) as usize, expected.len());
    expected.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let k = 1 + usize::from(first >> 3);
    let mut nearest = Neighbours::default();
    index.nearest_of_all(query, k, r2, &mut nearest);
    let nearest: Vec<(f32, u32)> = nearest.as_slice().iter().map(|n| (n.d2, n.id)).collect();
    expected.truncate(k);
    assert_eq!(nearest, expected);
});
