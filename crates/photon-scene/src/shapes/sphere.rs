//! Spheres.

use super::{Shape, revolve, translate};
use glam::DVec3;
use std::f64::consts::PI;

/// More would exceed the memory of most machines: 20 million triangles.
const MAX_SUBDIVISIONS: u32 = 10;

/// A sphere of `20 · 4^subdivision` nearly equal inscribed triangles: an icosahedron whose
/// triangles are subdivided into four repeatedly, at most 10 times.
#[must_use]
pub fn icosphere(subdivision: u32, center: [f64; 3], radius: f64) -> Shape {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..subdivision.min(MAX_SUBDIVISIONS) {
        // For each vertex its neighbours of greater number, at most 6, with the middle of the edge to them.
        let mut middles = vec![[(u32::MAX, 0); 6]; points.len()];
        let mut finer = Vec::with_capacity(triangles.len() * 4);
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to): (u32, u32)| {
                // The triangle on the other side of the edge looks up the same vertex.
                for (neighbour, middle) in &mut middles[from.min(to) as usize] {
                    if *neighbour == u32::MAX {
                        points.push((points[from as usize] + points[to as usize]).normalize_or_zero());
                        (*neighbour, *middle) = (from.max(to), points.len() as u32 - 1);
                    }
                    if *neighbour == from.max(to) {
                        return *middle;
                    }
                }
                unreachable!("vertices of an icosphere have at most 6 neighbours")
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let center = DVec3::from_array(center);
    (points.into_iter().map(|at| (center + at * radius).to_array()).collect(), triangles)
}

/// The icosahedron in the unit sphere: the corners of three perpendicular golden rectangles.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points = Vec::with_capacity(12);
    for axis in 0..3 {
        for (short, long) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
            let mut at = [0.0; 3];
            at[axis] = short;
            at[(axis + 1) % 3] = long;
            points.push(DVec3::from_array(at));
        }
    }
    // Neighbours are at distance 2, all others at least 2 · golden.
    let near = |a: usize, b: usize| points[a].distance_squared(points[b]) < 5.0;
    let mut triangles = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outwards = points[a].dot(points[b].cross(points[c])) > 0.0;
                    let (b, c) = if outwards { (b, c) } else { (c, b) };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    (points.into_iter().map(DVec3::normalize_or_zero).collect(), triangles)
}

/// An inscribed sphere of `segments` meridians (at least 3) and `rings` bands (at least 2), with
/// poles at the top and bottom.
#[must_use]
pub fn uv_sphere(segments: u32, rings: u32, center: [f64; 3], radius: f64) -> Shape {
    let rings = rings.max(2);
    let profile: Vec<_> = (0..=rings)
        .map(|ring| {
            let (sin, cos) = libm::sincos(PI * f64::from(ring) / f64::from(rings));
            [radius * sin, -radius * cos]
        })
        .collect();
    translate(revolve(&profile, segments), center)
}
