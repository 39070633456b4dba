//! Degenerate photons and queries for searches.

use photon_core::glam::Vec3;
use photon_core::random::SplitMix64;
use photon_core::{Photon, Query, octahedral};

/// One of the six axis directions, which packing preserves exactly.
pub(super) fn axis(random: &mut SplitMix64) -> Vec3 {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    axes[(random.word() % 6) as usize]
}

/// A photon at a point, with random power and direction.
pub(super) fn photon(random: &mut SplitMix64, position: [f32; 3]) -> Photon {
    let direction = Vec3::from(random.point()) - Vec3::splat(0.5);
    Photon {
        position,
        power: random.point(),
        normal: octahedral::pack(axis(random)),
        direction: octahedral::pack(direction.normalize_or(Vec3::X)),
    }
}

/// Photons at the given points.
pub(super) fn photons(points: &[[f32; 3]]) -> Vec<Photon> {
    let mut random = SplitMix64(11);
    points.iter().map(|&position| photon(&mut random, position)).collect()
}

/// Points distributed uniformly over the walls of a box.
pub(super) fn walls(count: usize) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(3);
    (0..count)
        .map(|_| {
            let (u, v) = (random.unit(), random.unit());
            match random.word() % 5 {
                0 => [u, 0.0, v],
                1 => [u, 1.0, v],
                2 => [0.0, u, v],
                3 => [1.0, u, v],
                _ => [u, v, 0.0],
            }
        })
        .collect()
}

/// Nine tenths of the points in a disc on the floor, with density 1/r, the others on the walls.
pub(super) fn caustic(count: usize, radius: f32) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(5);
    let walls = walls(count);
    walls
        .into_iter()
        .map(|wall| {
            let (r, angle) = (random.unit() * radius, random.unit() * std::f32::consts::TAU);
            if random.unit() < 0.9 { [0.3 + r * angle.cos(), 0.0, 0.7 + r * angle.sin()] } else { wall }
        })
        .collect()
}

/// Fewer and smaller than those of the builders (`index/tests/sets.rs`) and of the CPU: every search kernel runs over all
/// of them on llvmpipe.
pub(super) fn point_sets() -> Vec<(&'static str, Vec<[f32; 3]>)> {
    let mut random = SplitMix64(1);
    let mut many =
        |n: usize, f: &mut dyn FnMut(&mut SplitMix64) -> [f32; 3]| (0..n).map(|_| f(&mut random)).collect::<Vec<_>>();
    let mut sets = vec![
        ("none", Vec::new()),
        ("one", vec![[0.25, -3.0, 7.5]]),
        ("two", vec![[0.0; 3], [1.0, 0.0, 0.0]]),
        ("random", many(3000, &mut SplitMix64::point)),
        ("walls", walls(5000)),
        ("caustic", caustic(3000, 0.01)),
        ("identical", vec![[0.5, 0.25, -1.0]; 2000]),
        ("zeros of both signs", (0..100).map(|i| if i % 2 == 0 { [0.0; 3] } else { [-0.0; 3] }).collect()),
        ("collinear", many(1000, &mut |r| [1.0, 2.0, -1.0].map(|c| c * r.unit()))),
        ("one axis", many(1000, &mut |r| [3.0, r.unit(), 4.0])),
        ("lattice with duplicates", many(2000, &mut |r| r.point().map(|c| (c * 6.0).floor()))),
        ("two places", many(3000, &mut |r| if r.unit() < 0.5 { [0.0; 3] } else { [0.5; 3] })),
        ("sorted", (0..2000).map(|i| [i as f32, 0.0, 0.0]).collect()),
        ("small", many(600, &mut |r| r.point().map(|c| c * 1e-12))),
        ("huge", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2e30))),
        ("limits", many(600, &mut |r| r.point().map(|c| (c - 0.5) * 2.0 * f32::MAX))),
        (
            "many scales",
            many(800, &mut |r| {
                let scale = 10_f32.powf(r.unit() * 44.0 - 14.0);
                r.point().map(|c| (c - 0.5) * scale)
            }),
        ),
        ("a far outlier", {
            let mut points = many(1000, &mut SplitMix64::point);
            points[77] = [1e6, 0.0, 0.0];
            points
        }),
    ];
    for n in [15, 16, 17, 255, 256, 257, 4097] {
        sets.push(("about a power of two", many(n, &mut SplitMix64::point)));
    }
    sets
}

/// Query positions on, near and far from a point set.
pub(super) fn places(points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut random = SplitMix64(2);
    let mut all = vec![[0.0; 3], [0.5; 3], [1e6, -1e6, 3.0], [f32::MAX; 3], [f32::INFINITY, 0.0, 0.0]];
    for _ in 0..8 {
        if let Some(&p) = points.get((random.unit() * points.len() as f32) as usize) {
            all.push(p);
            all.push(p.map(|c| c + c * 1e-3 * random.unit()));
        }
        all.push(random.point());
    }
    all
}

/// Queries at the given positions, with random normals.
pub(super) fn queries(places: &[[f32; 3]], radius: f32) -> Vec<Query> {
    let mut random = SplitMix64(9);
    places
        .iter()
        .map(|&position| Query { position, radius, normal: axis(&mut random).to_array(), ..Query::default() })
        .collect()
}
