//! Which solids contain a point: the crossings of a ray with their triangles, found by a grid.

use glam::{DVec2, DVec3, Vec3};

use super::{Solid, Solids};
use crate::offset;
use crate::scene::light::Light;
use crate::scene::material::MaterialKind;
use crate::scene::media::MediumStack;

/// Finds the solids that contain a point, by the crossings of a ray along +x; the triangles are stored in a
/// grid over y and z.
#[derive(Debug)]
pub struct Locator<'a> {
    solids: &'a Solids<'a>,
    /// The largest first: what lies within another comes after it.
    order: Vec<usize>,
    /// Of y and z.
    low: DVec2,
    cells_per_length: DVec2,
    side: usize,
    /// Where each cell's entries begin, and the total number.
    starts: Vec<u32>,
    /// Solid and triangle.
    entries: Vec<(u32, u32)>,
}

impl<'a> Locator<'a> {
    pub(super) fn new(solids: &'a Solids<'a>) -> Self {
        let all =
            || (0..).zip(&solids.solids).flat_map(|(index, solid)| solid.triangles.iter().map(move |&id| (index, id)));
        let side = ((all().count() as f64).sqrt() as usize).clamp(1, 2048);
        let (low, high) = solids.solids.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), solid| {
            (low.min(across(solid.low.as_dvec3())), high.max(across(solid.high.as_dvec3())))
        });
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        // Six times the enclosed volume (divergence theorem); of a bubble, which faces inwards, the sum is negative.
        let volume = |solid: &Solid| -> f64 {
            let part = |&triangle: &u32| {
                let [a, b, c] = solids.corners(triangle);
                a.dot(b.cross(c))
            };
            solid.triangles.iter().map(part).sum::<f64>().abs()
        };
        let volumes: Vec<f64> = solids.solids.iter().map(volume).collect();
        let mut order: Vec<usize> = (0..volumes.len()).collect();
        order.sort_by(|&a, &b| volumes[b].total_cmp(&volumes[a]));
        let mut locator = Self {
            solids,
            order,
            low,
            cells_per_length: DVec2::splat(side as f64) / extent,
            side,
            starts: vec![0; side * side + 1],
            entries: Vec::new(),
        };
        let cells = |locator: &Self, triangle: u32| {
            let corners = solids.corners(triangle).map(across);
            let [low, high] = [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])];
            let ([y0, z0], [y1, z1]) = (locator.cell(low), locator.cell(high));
            (z0..=z1).flat_map(move |z| (y0..=y1).map(move |y| z * side + y))
        };
        for (_, triangle) in all() {
            for cell in cells(&locator, triangle) {
                locator.starts[cell + 1] += 1;
            }
        }
        for cell in 0..side * side {
            locator.starts[cell + 1] += locator.starts[cell];
        }
        let mut next = locator.starts.clone();
        let mut entries = vec![(0, 0); locator.starts[side * side] as usize];
        for (solid, triangle) in all() {
            for cell in cells(&locator, triangle) {
                entries[next[cell] as usize] = (solid, triangle);
                next[cell] += 1;
            }
        }
        locator.entries = entries;
        locator
    }

    /// The grid cell of a point, clamped to the grid.
    fn cell(&self, point: DVec2) -> [usize; 2] {
        let cell = (point - self.low) * self.cells_per_length;
        [cell.x, cell.y].map(|at| (at.max(0.0) as usize).min(self.side - 1))
    }

    /// The media at a point in normalised space, from the largest solid to the smallest.
    #[must_use]
    pub fn at(&self, point: [f32; 3]) -> MediumStack {
        self.at_but(point.into(), None)
    }

    /// The media in which a light's photons start, on its front and on its back: for a triangle on the two sides of its
    /// centre, for point and spot lights twice the same, for directional lights vacuum.
    #[must_use]
    pub fn of_light(&self, light: &Light) -> [MediumStack; 2] {
        match light.kind {
            Light::POINT | Light::SPOT => [self.at(light.position); 2],
            Light::TRIANGLE => {
                let corners = self.solids.corners(light.primitive);
                let primitive = &self.solids.scene.primitives[light.primitive as usize];
                let middle = ((corners[0] + corners[1] + corners[2]) / 3.0).as_vec3();
                let normal = Vec3::from(primitive.normal);
                let is_boundary =
                    self.solids.scene.materials_of(primitive).any(|of| of.kind() == MaterialKind::Dielectric);
                let own = if is_boundary {
                    self.solids.solids.iter().position(|solid| solid.triangles.contains(&light.primitive))
                } else {
                    None
                };
                let [front, back] =
                    [normal, -normal].map(|normal| self.at_but(offset::off_surface(middle, normal), own));
                [front, own.map_or(back, |own| back.enter(self.solids.solids[own].medium))]
            }
            _ => [MediumStack::VACUUM; 2],
        }
    }

    fn at_but(&self, point: Vec3, but: Option<usize>) -> MediumStack {
        let mut stack = MediumStack::VACUUM;
        if self.entries.is_empty() || !point.is_finite() {
            return stack;
        }
        let mut windings = vec![0_i32; self.solids.solids.len()];
        let [y, z] = self.cell(across(point.as_dvec3()));
        let cell = z * self.side + y;
        for &(solid, triangle) in &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            windings[solid as usize] += crossing(self.solids.corners(triangle), point.as_dvec3());
        }
        for &index in self.order.iter().filter(|&&index| Some(index) != but) {
            let (solid, winding) = (&self.solids.solids[index], windings[index]);
            for _ in 0..winding.unsigned_abs().min(MediumStack::DEPTH) {
                stack = if winding > 0 { stack.enter(solid.medium) } else { stack.leave(solid.medium) };
            }
        }
        stack
    }
}

/// The coordinates y and z.
fn across(point: DVec3) -> DVec2 {
    DVec2::new(point.y, point.z)
}

/// Crossing of a triangle by the ray along +x from `point`: 1 if it leaves through the front, -1 if it enters there, 0 if it
/// misses. Over a closed mesh that faces outwards, the sum is 1 for points inside and 0 for others.
///
/// Each edge is tested in a fixed direction that does not depend on the triangle, so that a ray through an
/// edge crosses exactly one of the two triangles that share it.
#[must_use]
pub fn crossing(corners: [DVec3; 3], point: DVec3) -> i32 {
    let at = across(point);
    let [a, b, c] = corners.map(across);
    let left = [side(a, b, at), side(b, c, at), side(c, a, at)];
    if left[0] != left[1] || left[1] != left[2] {
        return 0;
    }
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    // Distance to the plane along x; the sign of the normal's x is that of the orientation, which is
    // nonzero here except for rounding.
    let ahead = normal.dot(corners[0] - point) / normal.x;
    if !(ahead > 0.0) {
        return 0;
    }
    if left[0] { 1 } else { -1 }
}

/// Whether `at` is to the left of the line from `a` to `b`; always the opposite of the result for the line
/// from `b` to `a`.
fn side(a: DVec2, b: DVec2, at: DVec2) -> bool {
    let turn = |from: DVec2, to: DVec2| (to - from).perp_dot(at - from) >= 0.0;
    if (a.x, a.y) <= (b.x, b.y) { turn(a, b) } else { !turn(b, a) }
}
