//! Point sets that are hard for search structures, and queries into them.

use photon_core::random::SplitMix64;

/// Nine tenths of the points in a disc on the floor, with density ∝ 1/r, the others anywhere.
pub(super) fn caustic(count: usize, radius: f32) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(5);
    (0..count)
        .map(|_| {
            let (r, angle) = (random.unit() * radius, random.unit() * std::f32::consts::TAU);
            if random.unit() < 0.9 { [0.3 + r * angle.cos(), 0.0, 0.7 + r * angle.sin()] } else { random.point() }
        })
        .collect()
}

/// Sizes are about the blocks of this index. The Vulkan backend has sets of its own, about the sizes of its workgroups.
pub(super) fn point_sets() -> Vec<(&'static str, Vec<[f32; 3]>)> {
    let mut random = SplitMix64(1);
    let mut many =
        |n: usize, f: &mut dyn FnMut(&mut SplitMix64) -> [f32; 3]| (0..n).map(|_| f(&mut random)).collect::<Vec<_>>();
    let mut sets = vec![
        ("none", Vec::new()),
        ("one", vec![[0.25, -3.0, 7.5]]),
        ("two", vec![[0.0; 3], [1.0, 0.0, 0.0]]),
        ("random", many(3000, &mut SplitMix64::point)),
        ("identical", vec![[0.5, 0.25, -1.0]; 2000]),
        ("zeros of both signs", (0..100).map(|i| if i % 2 == 0 { [0.0; 3] } else { [-0.0; 3] }).collect()),
        ("collinear", many(1000, &mut |r| [1.0, 2.0, -1.0].map(|c| c * r.unit()))),
        (
            "on a diagonal",
            many(1000, &mut |r| {
                let t = r.unit();
                [t, 2.0 * t, -t]
            }),
        ),
        ("one axis", many(1000, &mut |r| [3.0, r.unit(), 4.0])),
        ("coplanar", many(1500, &mut |r| [r.unit(), 1.0, r.unit()])),
        ("lattice with duplicates", many(2000, &mut |r| r.point().map(|c| (c * 6.0).floor()))),
        ("sorted", (0..2000).map(|i| [i as f32, 0.0, 0.0]).collect()),
        ("sorted backwards", (0..2000).map(|i| [0.0, -(i as f32), 1.0]).collect()),
        ("tiny", many(600, &mut |r| r.point().map(|c| c * 1e-30))),
        ("subnormal", many(600, &mut |r| r.point().map(|c| c * 1e-42))),
        ("huge", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2e30))),
        ("limits", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2.0 * f32::MAX))),
        (
            "all scales",
            many(800, &mut |r| {
                let scale = 10_f32.powf(r.unit() * 70.0 - 38.0);
                r.point().map(|c| (c - 0.5) * scale)
            }),
        ),
        ("caustic", caustic(3000, 1e-6)),
        (
            "clusters",
            many(2000, &mut |r| {
                let (corner, offset) = (r.point().map(|c| (c * 3.0).floor()), r.point());
                [corner[0] + offset[0] * 1e-6, corner[1] + offset[1] * 1e-6, corner[2]]
            }),
        ),
        // Finer than a cell of the first Morton grid, and of the second.
        (
            "grids within grids",
            many(2000, &mut |r| {
                let scale = [1.0, 1e-8, 1e-16, 1e-24][(r.unit() * 4.0) as usize];
                r.point().map(|c| c * scale)
            }),
        ),
    ];
    for n in [3, 15, 16, 17, 31, 32, 33, 63, 64, 65, 127, 128, 129, 255, 256, 257, 272, 511, 512, 513, 4095, 4096, 4097]
    {
        sets.push(("about a power of two", many(n, &mut SplitMix64::point)));
    }
    sets
}

/// Queries on, near and far from the points of a set.
pub(super) fn queries(points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(2);
    let mut all =
        vec![[0.0; 3], [0.5; 3], [1e9, -1e9, 3.0], [f32::MAX; 3], [-f32::MAX, 0.0, 1e-40], [f32::INFINITY, 0.0, 0.0]];
    for _ in 0..6 {
        if let Some(&p) = points.get((random.unit() * points.len() as f32) as usize) {
            // One coincident query and one close by, in sequence, so that the second uses the hint of the first.
            all.push(p);
            all.push(p.map(|c| c + c * 1e-3 * random.unit()));
        }
        all.push(random.point());
    }
    all
}
