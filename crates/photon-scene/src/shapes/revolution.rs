//! Surfaces of revolution about the y axis.

use super::{Shape, translate};
use std::f64::consts::TAU;

/// The solid under a profile of `[radius, height]` points, turned about the y axis.
///
/// The profile runs upwards: it begins with the bottom on the axis and ends with the top on the axis
/// (their radii are taken as 0); the points in between have radii > 0, and there is at least one.
/// At least 3 segments. A profile of fewer than three points makes an empty shape.
#[must_use]
pub fn revolve(profile: &[[f64; 2]], segments: u32) -> Shape {
    let [bottom, rings @ .., top] = profile else {
        return Shape::default();
    };
    if rings.is_empty() {
        return Shape::default();
    }
    let segments = segments.max(3);
    let mut positions = turned(rings, segments);
    let (south, north) = (positions.len() as u32, positions.len() as u32 + 1);
    positions.push([0.0, bottom[1], 0.0]);
    positions.push([0.0, top[1], 0.0]);
    let last = (rings.len() as u32 - 1) * segments;
    let mut triangles = Vec::new();
    for step in 0..segments {
        let next = (step + 1) % segments;
        triangles.push([south, step, next]);
        for ring in 1..rings.len() as u32 {
            band(&mut triangles, (ring - 1) * segments, ring * segments, step, next);
        }
        triangles.push([last + step, north, last + next]);
    }
    (positions, triangles)
}

/// The ring obtained by revolving a closed profile of `[radius, height]` points about the y axis.
///
/// The profile runs counter-clockwise with the radius to the right and the height upwards; all radii
/// are > 0. At least 3 segments. A profile of fewer than three points makes an empty shape.
#[must_use]
pub fn revolve_loop(profile: &[[f64; 2]], segments: u32) -> Shape {
    if profile.len() < 3 {
        return Shape::default();
    }
    let segments = segments.max(3);
    let rings = profile.len() as u32;
    let mut triangles = Vec::new();
    for step in 0..segments {
        for ring in 0..rings {
            let above = (ring + 1) % rings;
            band(&mut triangles, ring * segments, above * segments, step, (step + 1) % segments);
        }
    }
    (turned(profile, segments), triangles)
}

/// A closed cylinder about a vertical axis; `center` is the centre of its base. Its segments, at least 3,
/// are inscribed.
#[must_use]
pub fn cylinder(center: [f64; 3], radius: f64, height: f64, segments: u32) -> Shape {
    let profile = [[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]];
    translate(revolve(&profile, segments), center)
}

/// A ring of rectangular cross-section about a vertical axis; `center` is the centre of its base.
/// Requires 0 < inner < outer; its segments, at least 3, are inscribed.
#[must_use]
pub fn tube(center: [f64; 3], inner: f64, outer: f64, height: f64, segments: u32) -> Shape {
    let profile = [[inner, 0.0], [outer, 0.0], [outer, height], [inner, height]];
    translate(revolve_loop(&profile, segments), center)
}

/// A torus about a vertical axis through `center`: a circle of radius `minor` at distance `major`,
/// with at least 3 by 3 inscribed segments. Requires 0 < minor < major.
#[must_use]
pub fn torus(center: [f64; 3], major: f64, minor: f64, segments: u32, sides: u32) -> Shape {
    let sides = sides.max(3);
    let profile: Vec<_> = (0..sides)
        .map(|side| {
            let (sin, cos) = libm::sincos(TAU * f64::from(side) / f64::from(sides));
            [major + minor * cos, minor * sin]
        })
        .collect();
    translate(revolve_loop(&profile, segments), center)
}

/// One ring of vertices for each profile point.
fn turned(profile: &[[f64; 2]], segments: u32) -> Vec<[f64; 3]> {
    let ring = |&[radius, height]: &[f64; 2]| {
        (0..segments).map(move |step| {
            let (sin, cos) = libm::sincos(TAU * f64::from(step) / f64::from(segments));
            [radius * cos, height, radius * sin]
        })
    };
    profile.iter().flat_map(ring).collect()
}

/// The two triangles between two rings and two segment boundaries.
fn band(triangles: &mut Vec<[u32; 3]>, below: u32, above: u32, step: u32, next: u32) {
    let [a, b, c, d] = [below + step, above + step, above + next, below + next];
    triangles.push([a, b, c]);
    triangles.push([a, c, d]);
}
