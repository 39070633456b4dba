//! Spheres that together contain all specular surfaces.

use glam::{DVec3, Vec3};

use crate::scene::SceneView;
use crate::scene::material::Material;

/// A sphere, normalised space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sphere {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
}

impl Sphere {
    /// The sphere around a box.
    fn around(low: Vec3, high: Vec3) -> Self {
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        Self { centre: 0.5 * (low + high), radius: 0.5 * low.distance(high) + ROUNDING }
    }
}

/// Largest deviation of a photon by rounding on its way to a surface: directions are accurate to 2·10⁻⁶,
/// and paths are not longer than the scene.
const ROUNDING: f64 = 1e-5;

/// Resolution of the finest grid that surfaces are sorted into, cells along each axis.
const FINEST: usize = 64;

/// Maximum total number of pieces that large triangles are split into.
const PIECES: usize = 1 << 20;

/// At most `most` spheres around all triangles of the materials `among`.
pub(super) fn of(scene: &SceneView<'_>, among: &dyn Fn(&Material) -> bool, most: usize) -> Vec<Sphere> {
    let count = specular(scene, among).count();
    if count == 0 {
        return Vec::new();
    }
    let depth = (PIECES / count).max(1).ilog2();
    around(specular(scene, among), depth, most)
}

/// One sphere around all of them; `None` if there are none.
pub(super) fn whole(scene: &SceneView<'_>, among: &dyn Fn(&Material) -> bool) -> Option<Sphere> {
    let corners = specular(scene, among).flatten();
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = corners.fold(empty, |(low, high), at| (low.min(at), high.max(at)));
    low.is_finite().then(|| Sphere::around(low, high))
}

/// The corners of the triangles of the materials `among`.
fn specular<'a>(
    scene: &'a SceneView<'_>,
    among: &'a dyn Fn(&Material) -> bool,
) -> impl Iterator<Item = [Vec3; 3]> + 'a {
    let primitives = scene.primitives.iter().zip(scene.triangles);
    primitives
        .filter(move |(primitive, _)| scene.materials_of(primitive).any(among))
        .map(move |(_, triangle)| triangle.map(|vertex| Vec3::from(scene.positions[vertex as usize])))
}

/// At most `most` spheres around triangles, which are bisected at most `depth` times.
fn around(triangles: impl Iterator<Item = [Vec3; 3]>, depth: u32, most: usize) -> Vec<Sphere> {
    // Those that are not larger than a cell of the finest grid are in one cell of each coarser grid too.
    let (mut small, mut large) = (Grid::new(FINEST), Vec::new());
    for triangle in triangles {
        if depth > 0 && small.is_larger(triangle) { large.push(triangle) } else { small.add(triangle, 0) }
    }
    loop {
        let mut grid = small.clone();
        large.iter().for_each(|&triangle| grid.add(triangle, depth));
        let spheres = grid.spheres();
        if spheres.len() <= most || grid.cells == 1 {
            return spheres;
        }
        small = small.halved();
    }
}

/// Bounding boxes of the triangles in each cell of a grid over the unit box.
#[derive(Clone)]
struct Grid {
    cells: usize,
    boxes: Vec<(Vec3, Vec3)>,
}

impl Grid {
    fn new(cells: usize) -> Self {
        Self { cells, boxes: vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); cells.pow(3)] }
    }

    /// The grid of half as many cells along each axis.
    fn halved(&self) -> Self {
        let mut half = Self::new(self.cells / 2);
        for (i, (low, high)) in self.boxes.iter().enumerate().filter(|(_, (low, high))| low.x <= high.x) {
            let [x, y, z] = [i / self.cells / self.cells, i / self.cells % self.cells, i % self.cells].map(|at| at / 2);
            let whole = &mut half.boxes[(x * half.cells + y) * half.cells + z];
            *whole = (whole.0.min(*low), whole.1.max(*high));
        }
        half
    }

    /// Whether a triangle is larger than a cell.
    fn is_larger(&self, [a, b, c]: [Vec3; 3]) -> bool {
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        longest * (self.cells * self.cells) as f32 > 1.0
    }

    /// Adds a triangle, bisected until it is not larger than a cell, at most `depth` times.
    fn add(&mut self, [a, b, c]: [Vec3; 3], depth: u32) {
        let edges = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let longest = edges[0].max(edges[1]).max(edges[2]);
        if depth > 0 && longest * (self.cells * self.cells) as f32 > 1.0 {
            // Renamed so that the longest edge is from a to b.
            let [a, b, c] = match longest {
                l if l == edges[0] => [a, b, c],
                l if l == edges[1] => [b, c, a],
                _ => [c, a, b],
            };
            let middle = 0.5 * (a + b);
            self.add([a, middle, c], depth - 1);
            self.add([middle, b, c], depth - 1);
            return;
        }
        let at = ((a + b + c) / 3.0 + 0.5) * self.cells as f32;
        let [x, y, z] = at.to_array().map(|x| (x.max(0.0) as usize).min(self.cells - 1));
        let (low, high) = &mut self.boxes[(x * self.cells + y) * self.cells + z];
        *low = low.min(a).min(b).min(c);
        *high = high.max(a).max(b).max(c);
    }

    fn spheres(&self) -> Vec<Sphere> {
        let filled = self.boxes.iter().filter(|(low, high)| low.x <= high.x);
        filled.map(|&(low, high)| Sphere::around(low, high)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{philox4x32, unit_f32};

    /// Each grid filled by itself gives the same spheres.
    #[test]
    fn coarser_grids_are_made_from_the_finest() {
        let number = |i: u32, block: u32| philox4x32([i, block, 0, 0], [5, 6]).map(unit_f32);
        let triangles: Vec<[Vec3; 3]> = (0..3000)
            .map(|i| {
                let [x, y, z, size] = number(i, 0);
                let size = if i % 50 == 0 { 0.3 } else { 0.02 * size };
                [1, 2, 3].map(|block| {
                    let [u, v, w, _] = number(i, block);
                    (Vec3::new(x, y, z) - 0.5 + size * (Vec3::new(u, v, w) - 0.5))
                        .clamp(Vec3::splat(-0.5), Vec3::splat(0.5))
                })
            })
            .collect();
        for (depth, most) in [(0, 4096), (8, 4096), (8, 500), (8, 60), (8, 1), (3, 0)] {
            let mut cells = FINEST;
            let expected = loop {
                let mut grid = Grid::new(cells);
                triangles.iter().for_each(|&triangle| grid.add(triangle, depth));
                let spheres = grid.spheres();
                if spheres.len() <= most || cells == 1 {
                    break spheres;
                }
                cells /= 2;
            };
            assert_eq!(around(triangles.iter().copied(), depth, most), expected, "{depth} {most}");
        }
    }
}
