//! Degenerate point sets for builders.

use photon_core::random::SplitMix64;

/// Nine tenths of the points in a disc, with density 1/r, the others anywhere.
fn caustic(count: usize, radius: f32) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(5);
    (0..count)
        .map(|_| {
            let (r, angle) = (random.unit() * radius, random.unit() * std::f32::consts::TAU);
            if random.unit() < 0.9 { [0.3 + r * angle.cos(), 0.0, 0.7 + r * angle.sin()] } else { random.point() }
        })
        .collect()
}

/// Larger than those of the searches and of the CPU, about the sizes of workgroups, lists and oversized runs.
pub(super) fn point_sets() -> Vec<(String, Vec<[f32; 3]>)> {
    let mut random = SplitMix64(1);
    let mut many =
        |n: usize, f: &mut dyn FnMut(&mut SplitMix64) -> [f32; 3]| (0..n).map(|_| f(&mut random)).collect::<Vec<_>>();
    let mut sets = vec![
        ("none", Vec::new()),
        ("random", many(3000, &mut SplitMix64::point)),
        ("identical", vec![[0.5, 0.25, -1.0]; 5000]),
        ("zeros of both signs", (0..100).map(|i| if i % 2 == 0 { [0.0; 3] } else { [-0.0; 3] }).collect()),
        ("collinear", many(1000, &mut |r| [1.0, 2.0, -1.0].map(|c| c * r.unit()))),
        ("one axis", many(1500, &mut |r| [3.0, r.unit(), 4.0])),
        ("coplanar", many(1500, &mut |r| [r.unit(), 1.0, r.unit()])),
        ("lattice with duplicates", many(9000, &mut |r| r.point().map(|c| (c * 6.0).floor()))),
        ("sorted", (0..2000).map(|i| [i as f32, 0.0, 0.0]).collect()),
        ("sorted backwards", (0..2000).map(|i| [0.0, -(i as f32), 1.0]).collect()),
        ("tiny", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 1e-30))),
        ("subnormal", many(2500, &mut |r| r.point().map(|c| (c - 0.25) * 1e-42))),
        ("a few subnormal steps", many(2500, &mut |r| r.point().map(|c| f32::from_bits((c * 40.0) as u32)))),
        ("about the least normal", many(2500, &mut |r| r.point().map(|c| (c - 0.5) * 5e-38))),
        ("huge", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2e30))),
        ("limits", many(2600, &mut |r| r.point().map(|c| (c - 0.5) * 2.0 * f32::MAX))),
        (
            "all scales",
            many(3000, &mut |r| {
                let scale = 10_f32.powf(r.unit() * 70.0 - 38.0);
                r.point().map(|c| (c - 0.5) * scale)
            }),
        ),
        ("caustic", caustic(3000, 1e-6)),
        ("a larger caustic", caustic(20_000, 0.05)),
        (
            "clusters",
            many(6000, &mut |r| {
                let (corner, offset) = (r.point().map(|c| (c * 3.0).floor()), r.point());
                [corner[0] + offset[0] * 1e-6, corner[1] + offset[1] * 1e-6, corner[2]]
            }),
        ),
        // Finer than a cell of the first Morton grid, and of the second.
        (
            "grids within grids",
            many(9000, &mut |r| {
                let scale = [1.0, 1e-8, 1e-16, 1e-24][(r.unit() * 4.0) as usize];
                r.point().map(|c| c * scale)
            }),
        ),
        (
            "spiral",
            (0..4000)
                .map(|i| {
                    let (angle, r) = (i as f32 * 0.02, 0.999_f32.powi(i * 4));
                    [r * angle.cos(), r * angle.sin(), r]
                })
                .collect(),
        ),
        ("every tenfold", (0..5000).map(|i| [1.03_f32.powi(i % 2600), 0.0, (i % 7) as f32]).collect()),
    ];
    let mut far = many(7000, &mut SplitMix64::point);
    far[3000] = [1e9, 0.0, 0.0];
    sets.push(("one far away", far));
    for n in
        [1, 2, 3, 15, 16, 17, 31, 32, 33, 255, 256, 257, 272, 511, 513, 1023, 1024, 1025, 2048, 2049, 4097, 100_000]
    {
        sets.push(("so many", many(n, &mut SplitMix64::point)));
    }
    sets.into_iter().map(|(name, points)| (format!("{name}, {}", points.len()), points)).collect()
}
