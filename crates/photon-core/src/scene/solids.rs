//! The solids of a scene: whether their bounding boxes overlap, and which of them contain a point.

use glam::{DVec2, DVec3, Vec3};

use crate::offset;
use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::scene::material::MaterialKind;
use crate::scene::media::{MediaFeatures, MediumStack};

/// A connected set of boundary triangles of one medium.
#[derive(Debug)]
struct Solid {
    medium: u32,
    triangles: Vec<u32>,
    low: Vec3,
    high: Vec3,
}

/// All solids of a scene.
#[derive(Debug)]
pub struct Solids<'a> {
    scene: SceneView<'a>,
    solids: Vec<Solid>,
}

impl<'a> Solids<'a> {
    /// Groups the dielectric triangles of a scene into connected boundaries, in one pass over all triangles if there
    /// are none. Triangles are connected if they share a vertex and a medium. In a scene that
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
        Self { scene: *scene, solids: group(scene, &boundary) }
    }

    /// What kernels have to support for these solids: [`MediaFeatures::NESTED`] if the bounding boxes of
    /// two of them overlap.
    #[must_use]
    pub fn features(&self) -> MediaFeatures {
        if boxes_meet(&self.solids) { MediaFeatures::NESTED } else { MediaFeatures::NONE }
    }

    /// Builds the structure that finds the solids around a point.
    #[must_use]
    pub fn locate(&self) -> Locator<'_> {
        Locator::new(self)
    }

    /// The same as `locate().at(point)`, without building the locator if the point is outside of all bounding boxes.
    #[must_use]
    pub fn at(&self, point: [f32; 3]) -> MediumStack {
        let at = Vec3::from(point);
        let near = |solid: &Solid| at.cmpge(solid.low).all() && at.cmple(solid.high).all();
        if self.solids.iter().any(near) { self.locate().at(point) } else { MediumStack::VACUUM }
    }
}

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
    fn new(solids: &'a Solids<'a>) -> Self {
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
        for &index in self.order.iter().filter(|&&index| Some(index) != but) {
            let (solid, winding) = (&self.solids.solids[index], windings[index]);
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

/// Whether the bounding boxes of two of them overlap.
fn boxes_meet(solids: &[Solid]) -> bool {
    let mut by_place: Vec<&Solid> = solids.iter().collect();
    by_place.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    by_place.iter().enumerate().any(|(index, solid)| {
        let mut beside = by_place[index + 1..].iter().take_while(|other| other.low.x <= solid.high.x);
        beside.any(|other| solid.low.cmple(other.high).all() && other.low.cmple(solid.high).all())
    })
}

/// Joins triangles that share a vertex index. If bounding boxes of the resulting groups overlap, also joins those with
/// vertices at equal positions.
fn group(scene: &SceneView<'_>, boundary: &[(u32, u32)]) -> Vec<Solid> {
    let mut media: Vec<u32> = boundary.iter().map(|&(_, medium)| medium).collect();
    media.dedup();
    media.sort_unstable();
    media.dedup();
    // Union-find parent of each vertex; `u32::MAX` if no boundary uses it.
    let mut parents = vec![u32::MAX; scene.positions.len()];
    let by_index = components(scene, boundary, &media, &mut parents, false);
    if boxes_meet(&by_index) { components(scene, boundary, &media, &mut parents, true) } else { by_index }
}

fn components(
    scene: &SceneView<'_>,
    boundary: &[(u32, u32)],
    media: &[u32],
    parents: &mut [u32],
    by_place: bool,
) -> Vec<Solid> {
    let mut solids = Vec::new();
    for &medium in media {
        let triangles = || {
            boundary
                .iter()
                .filter(|of| of.1 == medium)
                .map(|&(triangle, _)| (triangle, scene.triangles[triangle as usize]))
        };
        for (_, [a, b, c]) in triangles() {
            for vertex in [a, b, c] {
                if parents[vertex as usize] == u32::MAX {
                    parents[vertex as usize] = vertex;
                }
            }
            unite(parents, a, b);
            unite(parents, a, c);
        }
        if by_place {
            let place = |vertex: u32| scene.positions[vertex as usize].map(|x| (x + 0.0).to_bits());
            let mut places: Vec<([u32; 3], u32)> =
                triangles().flat_map(|(_, corners)| corners.map(|vertex| (place(vertex), vertex))).collect();
            places.sort_unstable();
            for pair in places.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                unite(parents, pair[0].1, pair[1].1);
            }
        }
        let mut by_root: Vec<(u32, u32)> =
            triangles().map(|(triangle, [a, ..])| (root(parents, a), triangle)).collect();
        by_root.sort_unstable();
        solids.extend(by_root.chunk_by(|a, b| a.0 == b.0).map(|same| solid(scene, medium, same)));
        for vertex in triangles().flat_map(|(_, corners)| corners) {
            parents[vertex as usize] = u32::MAX;
        }
    }
    solids
}

fn unite(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
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

fn solid(scene: &SceneView<'_>, medium: u32, triangles: &[(u32, u32)]) -> Solid {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &(_, triangle) in triangles {
        for vertex in scene.triangles[triangle as usize] {
            let corner = Vec3::from(scene.positions[vertex as usize]);
            (low, high) = (low.min(corner), high.max(corner));
        }
    }
    Solid { medium, triangles: triangles.iter().map(|&(_, triangle)| triangle).collect(), low, high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::{Material, Primitive};
    use crate::scene::medium::Medium;
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
                ..SceneView::default()
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
