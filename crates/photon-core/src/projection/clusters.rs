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

/// Largest deviation of a photon by rounding on its way to a surface: directions are accurate to 2·10⁻⁶,
/// and paths are not longer than the scene.
const ROUNDING: f64 = 1e-5;

/// Resolution of the finest grid that surfaces are sorted into, cells along each axis.
const FINEST: usize = 64;

/// Maximum total number of pieces that large triangles are split into.
const PIECES: usize = 1 << 20;

/// At most `most` spheres around all triangles of the materials `among`.
pub(super) fn of(scene: &SceneView<'_>, among: &dyn Fn(&Material) -> bool, most: usize) -> Vec<Sphere> {
    let specular = || {
        let primitives = scene.primitives.iter().zip(scene.triangles);
        primitives.filter(|(primitive, _)| scene.materials_of(primitive).any(among)).map(|(_, triangle)| triangle)
    };
    let count = specular().count();
    if count == 0 {
        return Vec::new();
    }
    let depth = (PIECES / count).max(1).ilog2();
    let mut cells = FINEST;
    loop {
        let mut grid = Grid::new(cells);
        for triangle in specular() {
            grid.add(triangle.map(|vertex| Vec3::from(scene.positions[vertex as usize])), depth);
        }
        let spheres = grid.spheres();
        if spheres.len() <= most || cells == 1 {
            return spheres;
        }
        cells /= 2;
    }
}

/// Bounding boxes of the triangles in each cell of a grid over the unit box.
struct Grid {
    cells: usize,
    boxes: Vec<(Vec3, Vec3)>,
}

impl Grid {
    fn new(cells: usize) -> Self {
        Self { cells, boxes: vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); cells.pow(3)] }
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
        let sphere = |&(low, high): &(Vec3, Vec3)| {
            let (low, high) = (low.as_dvec3(), high.as_dvec3());
            Sphere { centre: 0.5 * (low + high), radius: 0.5 * low.distance(high) + ROUNDING }
        };
        filled.map(sphere).collect()
    }
}
