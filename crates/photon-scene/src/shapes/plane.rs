//! Flat, one-sided shapes.

use super::Shape;
use glam::DVec3;
use std::f64::consts::TAU;

/// Two triangles; corners counter-clockwise as seen from the front.
#[must_use]
pub fn quad(corners: [[f64; 3]; 4]) -> Shape {
    (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// A quadrilateral of `columns` (from the first corner towards the second) by `rows` (from the first
/// towards the last) cells of two triangles each, at least 1 by 1; corners counter-clockwise as
/// seen from the front.
#[must_use]
pub fn grid(corners: [[f64; 3]; 4], columns: u32, rows: u32) -> Shape {
    let (columns, rows) = (columns.max(1), rows.max(1));
    let [a, b, c, d] = corners.map(DVec3::from_array);
    let positions = (0..=rows).flat_map(|row| {
        let v = f64::from(row) / f64::from(rows);
        (0..=columns).map(move |column| {
            let u = f64::from(column) / f64::from(columns);
            a.lerp(b, u).lerp(d.lerp(c, u), v).to_array()
        })
    });
    let at = |column, row| row * (columns + 1) + column;
    let triangles = (0..rows).flat_map(|row| {
        (0..columns).flat_map(move |column| {
            let [a, b, c, d] = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            [[a, b, c], [a, c, d]]
        })
    });
    (positions.collect(), triangles.collect())
}

/// A disc facing `normal` (not zero, need not be unit), of at least 3 segments inscribed
/// in a circle of the given radius.
#[must_use]
pub fn disc(center: [f64; 3], normal: [f64; 3], radius: f64, segments: u32) -> Shape {
    let segments = segments.max(3);
    let center = DVec3::from_array(center);
    let normal = DVec3::from_array(normal);
    let (u, v) = (normal / normal.length()).any_orthonormal_pair();
    let rim = (0..segments).map(|step| {
        let (sin, cos) = libm::sincos(TAU * f64::from(step) / f64::from(segments));
        (center + (u * cos + v * sin) * radius).to_array()
    });
    let positions = std::iter::once(center.to_array()).chain(rim).collect();
    let triangles = (0..segments).map(|step| [0, step + 1, (step + 1) % segments + 1]).collect();
    (positions, triangles)
}
