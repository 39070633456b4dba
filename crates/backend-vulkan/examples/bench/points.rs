//! Photons and queries for search benchmarks.

use std::f32::consts::TAU;

use photon_core::glam::Vec3;
use photon_core::random::SplitMix64;
use photon_core::{Photon, Query, octahedral};

fn photon(position: [f32; 3], normal: Vec3) -> Photon {
    let (normal, direction) = (octahedral::pack(normal), octahedral::pack(normal));
    Photon { position, direction, power: [1.0; 3], normal }
}

fn on_a_wall(random: &mut SplitMix64) -> Photon {
    let (u, v) = (random.unit(), random.unit());
    match random.word() % 5 {
        0 => photon([u, 0.0, v], Vec3::Y),
        1 => photon([u, 1.0, v], -Vec3::Y),
        2 => photon([0.0, u, v], Vec3::X),
        3 => photon([1.0, u, v], -Vec3::X),
        _ => photon([u, v, 0.0], Vec3::Z),
    }
}

/// Photons distributed uniformly over five walls of a box.
pub(crate) fn walls(count: usize) -> Vec<Photon> {
    let mut random = SplitMix64(1);
    (0..count).map(|_| on_a_wall(&mut random)).collect()
}

/// Nine tenths of the photons in a disc of radius 0.05 on the floor, with density 1/r.
pub(crate) fn caustic(count: usize) -> Vec<Photon> {
    let mut random = SplitMix64(2);
    (0..count)
        .map(|_| {
            if random.unit() >= 0.9 {
                return on_a_wall(&mut random);
            }
            let (r, angle) = (random.unit() * 0.05, random.unit() * TAU);
            photon([0.3 + r * angle.cos(), 0.0, 0.7 + r * angle.sin()], Vec3::Y)
        })
        .collect()
}

/// One query per pixel: the back wall in the upper half of an image, the floor in the lower.
pub(crate) fn rows(width: usize, height: usize, radius: f32) -> Vec<Query> {
    let half = height / 2;
    (0..width * height)
        .map(|pixel| {
            let (x, y) = (pixel % width, pixel / width);
            let (u, v) = ((x as f32 + 0.5) / width as f32, ((y % half) as f32 + 0.5) / half as f32);
            let (position, normal) = if y < half { ([u, 1.0 - v, 0.0], Vec3::Z) } else { ([u, 0.0, v], Vec3::Y) };
            Query { position, radius, normal: normal.to_array(), pixel: pixel as u32, ..Query::default() }
        })
        .collect()
}
