//! Polyhedra, and transforms of shapes.

use super::{Shape, grid};

/// The box between two corners; needs `low < high` on every axis.
#[must_use]
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Shape {
    let [x0, y0, z0] = low;
    let [x1, y1, z1] = high;
    prism(&[[x0, z0], [x0, z1], [x1, z1], [x1, z0]], 0, y0, y1)
}

/// A polygon of `[x, z]` points, extruded from height `bottom` to height `top`.
///
/// The points run counter-clockwise as seen from above (from +z towards +x), at least 3 of them.
/// The caps are fans around point number `hub`, from which all others must be visible: any point
/// of a convex polygon, the inner corner of an L. With fewer points, or a hub out of range, the shape is
/// empty.
#[must_use]
pub fn prism(polygon: &[[f64; 2]], hub: u32, bottom: f64, top: f64) -> Shape {
    let count = polygon.len() as u32;
    if count < 3 || hub >= count {
        return Shape::default();
    }
    let level = |height: f64| polygon.iter().map(move |&[x, z]| [x, height, z]);
    let positions = level(bottom).chain(level(top)).collect();
    let mut triangles = Vec::new();
    for step in 1..count - 1 {
        let [b, c] = [(hub + step) % count, (hub + step + 1) % count];
        triangles.push([hub, c, b]);
        triangles.push([hub + count, b + count, c + count]);
    }
    for a in 0..count {
        let b = (a + 1) % count;
        triangles.push([a, b, b + count]);
        triangles.push([a, b + count, a + count]);
    }
    (positions, triangles)
}

/// A solid with a flat bottom at height `bottom` and a top at `height(x, z)` over the rectangle from
/// `low` to `high` (`[x, z]` each), of `cells` (in x and z, at least 1 each) of two triangles.
///
/// `height` must be above `bottom` everywhere.
#[must_use]
pub fn height_field(
    low: [f64; 2],
    high: [f64; 2],
    cells: [u32; 2],
    bottom: f64,
    height: impl Fn(f64, f64) -> f64,
) -> Shape {
    let [nx, nz] = cells.map(|count| count.max(1));
    let [[x0, z0], [x1, z1]] = [low, high];
    // Columns run along z, as does the first side of the quadrilateral.
    let (mut positions, mut triangles) = grid([[x0, 0., z0], [x0, 0., z1], [x1, 0., z1], [x1, 0., z0]], nz, nx);
    for at in &mut positions {
        at[1] = height(at[0], at[2]);
    }
    // The boundary, counter-clockwise as seen from above.
    let at = |x: u32, z: u32| x * (nz + 1) + z;
    let rim: Vec<u32> = (0..nz)
        .map(|z| at(0, z))
        .chain((0..nx).map(|x| at(x, nz)))
        .chain((0..nz).map(|z| at(nx, nz - z)))
        .chain((0..nx).map(|x| at(nx - x, 0)))
        .collect();
    // The bottom is a fan around its centre, so that it needs no vertices other than those of the boundary.
    let middle = positions.len() as u32;
    positions.push([(x0 + x1) / 2.0, bottom, (z0 + z1) / 2.0]);
    positions.extend(
        rim.iter().map(|&vertex| positions[vertex as usize]).map(|[x, _, z]| [x, bottom, z]).collect::<Vec<_>>(),
    );
    for (step, &a) in (0..).zip(&rim) {
        let next = (step + 1) % rim.len() as u32;
        let [below, below_next] = [middle + 1 + step, middle + 1 + next];
        triangles.push([below, below_next, rim[next as usize]]);
        triangles.push([below, rim[next as usize], a]);
        triangles.push([middle, below_next, below]);
    }
    (positions, triangles)
}

/// Translates a shape.
#[must_use]
pub fn translate((mut positions, triangles): Shape, by: [f64; 3]) -> Shape {
    for at in &mut positions {
        for (part, by) in at.iter_mut().zip(by) {
            *part += by;
        }
    }
    (positions, triangles)
}

/// Rotates a shape about the y axis, by radians from +z towards +x.
#[must_use]
pub fn rotate_y((mut positions, triangles): Shape, angle: f64) -> Shape {
    let (sin, cos) = libm::sincos(angle);
    for at in &mut positions {
        let [x, y, z] = *at;
        *at = [cos * x + sin * z, y, cos * z - sin * x];
    }
    (positions, triangles)
}
