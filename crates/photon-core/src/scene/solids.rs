//! The solids of a scene: whether they touch, and which of them contain a point.

use glam::{DVec2, DVec3, Vec3};

use crate::offset;
use crate::scene::SceneView;
use crate::scene::layout::{Light, MaterialKind};
use crate::scene::media::{MediaFeatures, MediumStack};

/// A connected set of boundary triangles of one medium.
#[derive(Debug)]
struct Solid {
    medium: u32,
    triangles: Vec<u32>,
    low: Vec3,
    high: Vec3,
    /// Enclosed volume; negative for a bubble, whose boundary faces inwards.
    volume: f64,
}

/// All solids of a scene.
#[derive(Debug)]
pub struct Solids<'a> {
    scene: SceneView<'a>,
    /// Sorted by decreasing volume, so that a solid comes after those that contain it.
    solids: Vec<Solid>,
}

impl<'a> Solids<'a> {
    /// Groups the dielectric triangles of a scene into closed boundaries; without any, this costs nothing.
    /// Triangles are connected if they share a vertex position and a medium. In a scene that
    /// [`SceneView::validate`] refuses, triangles with indices out of range are skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'a>) -> Self {
        let boundary: Vec<(u32, u32)> = (0..)
            .zip(scene.primitives)
            .filter_map(|(triangle, primitive)| {
                let material = scene.materials.get(primitive.material as usize)?;
                let corners = scene.triangles.get(triangle as usize)?;
                let fits = corners.iter().all(|&vertex| (vertex as usize) < scene.positions.len());
                (fits && material.kind() == MaterialKind::Dielectric).then_some((triangle, material.medium))
            })
            .collect();
        if boundary.is_empty() {
            return Self { scene: *scene, solids: Vec::new() };
        }
        let mut solids = group(scene, &boundary);
        solids.sort_by(|a, b| b.volume.abs().total_cmp(&a.volume.abs()));
        Self { scene: *scene, solids }
    }

    /// What kernels have to support for these solids: [`MediaFeatures::NESTED`] if the bounding boxes of
    /// two of them overlap.
    #[must_use]
    pub fn features(&self) -> MediaFeatures {
        let mut by_place: Vec<&Solid> = self.solids.iter().collect();
        by_place.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
        for (index, solid) in by_place.iter().enumerate() {
            let beside = by_place[index + 1..].iter().take_while(|other| other.low.x <= solid.high.x);
            for other in beside {
                if solid.low.cmple(other.high).all() && other.low.cmple(solid.high).all() {
                    return MediaFeatures::NESTED;
                }
            }
        }
        MediaFeatures::NONE
    }

    /// Builds the structure that finds the solids around a point.
    #[must_use]
    pub fn locate(&self) -> Locator<'_> {
        Locator::new(self)
    }
}

/// Finds the solids that contain a point, by the crossings of a ray along +x; the triangles are stored in a
/// grid over y and z.
#[derive(Debug)]
pub struct Locator<'a> {
    solids: &'a Solids<'a>,
    /// Lower corner of the grid, in y and z.
    low: DVec2,
    cells_per_length: DVec2,
    side: usize,
    /// Where each cell's entries begin, and the total number.
    starts: Vec<u32>,
    /// Solid and triangle.
    entries: Vec<(u32, u32)>,
}

impl<'a> Locator<'a> {
    fn new(solids: &'a Solids<'a>) -> Self {
        let all =
            || (0..).zip(&solids.solids).flat_map(|(index, solid)| solid.triangles.iter().map(move |&id| (index, id)));
        let side = ((all().count() as f64).sqrt() as usize).clamp(1, 2048);
        let (low, high) = solids.solids.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), solid| {
            (low.min(across(solid.low.as_dvec3())), high.max(across(solid.high.as_dvec3())))
        });
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut locator = Self {
            solids,
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

    /// The media at the origins of a light's photons, on its front and on its back. For a triangle those at
    /// its centre.
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
                    self.solids.scene.materials[primitive.material as usize].kind() == MaterialKind::Dielectric;
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
        for (index, (solid, winding)) in self.solids.solids.iter().zip(windings).enumerate() {
            if Some(index) == but {
                continue;
            }
            for _ in 0..winding.unsigned_abs().min(MediumStack::DEPTH) {
                stack = if winding > 0 { stack.enter(solid.medium) } else { stack.leave(solid.medium) };
            }
        }
        stack
    }
}

impl Solids<'_> {
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.scene.triangles[triangle as usize]
            .map(|vertex| Vec3::from(self.scene.positions[vertex as usize]).as_dvec3())
    }
}

/// The coordinates y and z.
fn across(point: DVec3) -> DVec2 {
    DVec2::new(point.y, point.z)
}

/// How the ray along +x from `point` crosses a triangle: 1 if it leaves through the front, -1 if it enters
/// there, 0 if it misses.
///
/// Each edge is tested in a fixed direction that does not depend on the triangle, so that a ray through an
/// edge crosses exactly one of the two triangles that share it.
fn crossing(corners: [DVec3; 3], point: DVec3) -> i32 {
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

/// Connected components by union-find, over vertex positions.
fn group(scene: &SceneView<'_>, boundary: &[(u32, u32)]) -> Vec<Solid> {
    let place = |vertex: u32| scene.positions[vertex as usize].map(|x| (x + 0.0).to_bits());
    // One node per position and medium.
    let mut nodes: Vec<([u32; 3], u32)> = boundary
        .iter()
        .flat_map(|&(triangle, medium)| scene.triangles[triangle as usize].map(|vertex| (place(vertex), medium)))
        .collect();
    nodes.sort_unstable();
    nodes.dedup();
    let node = |vertex: u32, medium: u32| nodes.binary_search(&(place(vertex), medium)).unwrap_or(0) as u32;
    let mut parents: Vec<u32> = (0..nodes.len() as u32).collect();
    for &(triangle, medium) in boundary {
        let [a, b, c] = scene.triangles[triangle as usize].map(|vertex| node(vertex, medium));
        for other in [b, c] {
            let (from, to) = (root(&mut parents, other), root(&mut parents, a));
            parents[from.max(to) as usize] = from.min(to);
        }
    }
    let mut by_root: Vec<(u32, u32, u32)> = boundary
        .iter()
        .map(|&(triangle, medium)| {
            let first = node(scene.triangles[triangle as usize][0], medium);
            (root(&mut parents, first), triangle, medium)
        })
        .collect();
    by_root.sort_unstable();
    by_root.chunk_by(|a, b| a.0 == b.0).map(|same| solid(scene, same)).collect()
}

/// The representative of the component of `node`.
fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let above = parents[parents[node as usize] as usize];
        parents[node as usize] = above;
        node = above;
    }
    node
}

fn solid(scene: &SceneView<'_>, triangles: &[(u32, u32, u32)]) -> Solid {
    let mut solid = Solid {
        medium: triangles[0].2,
        triangles: triangles.iter().map(|&(_, triangle, _)| triangle).collect(),
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
        volume: 0.0,
    };
    for &triangle in &solid.triangles {
        let corners = scene.triangles[triangle as usize].map(|vertex| Vec3::from(scene.positions[vertex as usize]));
        for corner in corners {
            solid.low = solid.low.min(corner);
            solid.high = solid.high.max(corner);
        }
        let [a, b, c]: [DVec3; 3] = corners.map(Vec3::as_dvec3);
        solid.volume += a.dot(b.cross(c)) / 6.0;
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::layout::{Material, Medium, Primitive};
    use crate::scene::units::Units;

    /// Boxes, each with lower corner, upper corner, material, and whether it faces inwards.
    struct Tables {
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        primitives: Vec<Primitive>,
        materials: Vec<Material>,
        lights: Vec<Light>,
    }

    const FACES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    fn tables(boxes: &[([f32; 3], [f32; 3], u32, bool)]) -> Tables {
        let solid = |medium| Material {
            kind: MaterialKind::Dielectric as u32,
            medium,
            ior: 1.5,
            emission: [1.0; 3],
            ..Material::default()
        };
        let mut tables = Tables {
            positions: Vec::new(),
            triangles: Vec::new(),
            primitives: Vec::new(),
            materials: vec![Material::default(), solid(1), solid(2)],
            lights: Vec::new(),
        };
        for &(low, high, material, inwards) in boxes {
            let corner = |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
            for face in FACES {
                let first = tables.positions.len() as u32;
                tables.positions.extend(face.map(corner));
                for triangle in [[0, 1, 2], [0, 2, 3]] {
                    let mut triangle = triangle.map(|i| first + i);
                    if inwards {
                        triangle.swap(1, 2);
                    }
                    let [a, b, c] = triangle.map(|i| Vec3::from(tables.positions[i as usize]));
                    let normal = (b - a).cross(c - a).normalize().to_array();
                    tables.triangles.push(triangle);
                    tables.primitives.push(Primitive { normal, material });
                }
            }
        }
        tables
    }

    impl Tables {
        fn view(&self) -> SceneView<'_> {
            SceneView {
                positions: &self.positions,
                triangles: &self.triangles,
                primitives: &self.primitives,
                materials: &self.materials,
                media: &[Medium::VACUUM; 3],
                lights: &self.lights,
                light_cdf: &[],
                radius: 1.0,
                units: Units { center: [0.0; 3], scale: 1.0, power: 1.0 },
            }
        }
    }

    #[test]
    fn points_are_in_what_encloses_them() {
        let tables = tables(&[
            ([-0.5; 3], [0.5; 3], 1, false),
            ([-0.2; 3], [0.2; 3], 2, false),
            ([0.3, -0.1, -0.1], [0.4, 0.1, 0.1], 1, true),
        ]);
        let view = tables.view();
        let solids = Solids::of(&view);
        assert_eq!(solids.solids.len(), 3);
        assert_eq!(solids.features(), MediaFeatures::NESTED);
        let locator = solids.locate();
        let outer = MediumStack::in_medium(1);
        // The rays of the first, second and last point cross edges and vertices of the boxes.
        assert_eq!(locator.at([0.0; 3]), outer.enter(2));
        assert_eq!(locator.at([-0.3, 0.2, 0.2]), outer);
        assert_eq!(locator.at([0.35, 0.03, 0.02]), MediumStack::VACUUM, "in the bubble");
        assert_eq!(locator.at([0.45, 0.03, 0.02]), outer);
        for outside in [[0.6, 0.0, 0.0], [-0.6, 0.0, 0.0], [0.0, 0.6, 0.0], [-0.6, 0.5, 0.5], [f32::NAN; 3]] {
            assert_eq!(locator.at(outside), MediumStack::VACUUM, "{outside:?}");
        }
    }

    /// A grid of points, compared with the boxes; some lie on diagonals and edges of faces.
    #[test]
    fn every_point_of_a_grid_is_where_it_is() {
        let tables = tables(&[([-0.5; 3], [0.5; 3], 1, false), ([-0.25, -0.25, -0.4], [0.25, 0.25, 0.25], 2, false)]);
        let view = tables.view();
        let solids = Solids::of(&view);
        let locator = solids.locate();
        for i in 0..19_i16.pow(3) {
            let at = [i % 19, i / 19 % 19, i / 361].map(|k| (f32::from(k) - 9.0) / 16.0 + 1.0 / 1024.0);
            let within = |low: [f32; 3], high: [f32; 3]| (0..3).all(|a| low[a] < at[a] && at[a] < high[a]);
            let mut expected = MediumStack::VACUUM;
            if within([-0.5; 3], [0.5; 3]) {
                expected = expected.enter(1);
            }
            if within([-0.25, -0.25, -0.4], [0.25, 0.25, 0.25]) {
                expected = expected.enter(2);
            }
            assert_eq!(locator.at(at), expected, "{at:?}");
        }
    }

    #[test]
    fn solids_apart_do_not_nest() {
        let apart = tables(&[([-0.5; 3], [-0.1; 3], 1, false), ([0.1; 3], [0.5; 3], 1, false)]);
        assert_eq!(Solids::of(&apart.view()).features(), MediaFeatures::NONE);
        let touching = tables(&[([-0.5; 3], [0.0; 3], 1, false), ([0.0; 3], [0.5; 3], 2, false)]);
        assert_eq!(Solids::of(&touching.view()).features(), MediaFeatures::NESTED);
        let none = tables(&[]);
        assert_eq!(Solids::of(&none.view()).features(), MediaFeatures::NONE);
        assert_eq!(Solids::of(&none.view()).locate().at([0.0; 3]), MediumStack::VACUUM);
    }

    /// An emissive boundary emits photons outside of its solid from the front, inside from the back.
    #[test]
    fn a_glowing_boundary_has_two_sides() {
        let tables = tables(&[([-0.5; 3], [0.5; 3], 1, false), ([-0.2; 3], [0.2; 3], 2, false)]);
        let view = tables.view();
        let solids = Solids::of(&view);
        let light = |primitive| Light { kind: Light::TRIANGLE, primitive, ..Light::default() };
        let outer = MediumStack::in_medium(1);
        assert_eq!(solids.locate().of_light(&light(0)), [MediumStack::VACUUM, outer]);
        assert_eq!(solids.locate().of_light(&light(12)), [outer, outer.enter(2)]);
        let point = Light { kind: Light::POINT, position: [0.3; 3], ..Light::default() };
        assert_eq!(solids.locate().of_light(&point), [outer; 2]);
        let sun = Light { kind: Light::DIRECTIONAL, ..Light::default() };
        assert_eq!(solids.locate().of_light(&sun), [MediumStack::VACUUM; 2]);
    }
}
