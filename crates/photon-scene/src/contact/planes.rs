//! Planes in which triangles touch, and the level of each triangle there.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::Vec3;

use super::Source;
use super::order::{self, Levels, Pair, Patch};
use super::pairs::{Contact, corners};
use super::shift::Raised;
use super::warnings::{Findings, Kind};
use crate::normalise::Geometry;

/// A plane, a mesh, and whether its triangles face as the first one of the plane.
type Key = (usize, u32, bool);

/// The triangles that touch others, grouped into patches: those of one mesh in one plane that face one way.
pub(super) struct Touching<'a> {
    source: &'a Source<'a>,
    geometry: &'a Geometry,
    /// In ascending order.
    triangles: Vec<u32>,
    /// Patch of each triangle.
    patch_of: Vec<usize>,
    /// Plane of each patch, in ascending order, and the patch.
    patches: Vec<(usize, Patch<'a>)>,
    /// Material of each patch.
    materials: Vec<u32>,
}

/// The contacts of two patches.
#[derive(Default)]
struct Joint {
    /// The first one of those that coincide, or else of all.
    contact: usize,
    is_apart: bool,
    area: f64,
    /// Area times height of the second patch over the first one.
    moment: f64,
}

impl<'a> Touching<'a> {
    pub(super) fn new(source: &'a Source<'a>, geometry: &'a Geometry, contacts: &[Contact]) -> Self {
        let mut triangles: Vec<u32> = contacts.iter().flat_map(|contact| contact.triangles).collect();
        triangles.sort_unstable();
        triangles.dedup();
        let mut planes = Planes::new(triangles.len());
        for contact in contacts {
            let [a, b] = contact.triangles.map(|triangle| index(&triangles, triangle));
            planes.join(a, b, contact.is_parallel);
        }
        let key = |(i, &triangle): (usize, &u32)| {
            let (plane, is_up) = planes.find(i);
            (plane, geometry.mesh_of(triangle) as u32, is_up)
        };
        let keys: Vec<Key> = triangles.iter().enumerate().map(key).collect();
        let area = |triangle: u32| {
            let [a, b, c] = corners(geometry, triangle);
            0.5 * (b - a).cross(c - a).length()
        };
        let mut touching: BTreeMap<Key, f64> = BTreeMap::new();
        for (&key, &triangle) in keys.iter().zip(&triangles) {
            *touching.entry(key).or_default() += area(triangle);
        }
        let mut whole: HashMap<u32, f64> = HashMap::new();
        for &(_, mesh, _) in touching.keys() {
            let of_mesh = || geometry.range(mesh as usize).map(|triangle| area(triangle as u32)).sum();
            whole.entry(mesh).or_insert_with(of_mesh);
        }
        let thin: HashSet<u32> =
            contacts.iter().filter(|contact| contact.is_thin).flat_map(|contact| contact.triangles).collect();
        let mut corner_of: HashMap<Key, ([f32; 3], bool)> = HashMap::new();
        for (&key, &triangle) in keys.iter().zip(&triangles) {
            let own = corner_of.entry(key).or_insert(([f32::INFINITY; 3], false));
            let corners = geometry.triangles[triangle as usize].map(|vertex| geometry.positions[vertex as usize]);
            own.0 = corners.into_iter().fold(own.0, |first, at| if at < first { at } else { first });
            own.1 |= thin.contains(&triangle);
        }
        let places: HashMap<Key, usize> = touching.keys().enumerate().map(|(i, &key)| (key, i)).collect();
        let patch = |(key, &touching): (&Key, &f64)| {
            let &(plane, mesh, is_up) = key;
            let (corner, is_thin) = corner_of[key];
            let material = source.material(mesh as usize);
            (plane, Patch { material, is_up, areas: [touching, whole[&mesh]], is_thin, corner })
        };
        let patches = touching.iter().map(patch).collect();
        let patch_of = keys.iter().map(|key| places[key]).collect();
        let materials = touching.keys().map(|&(_, mesh, _)| source.meshes[mesh as usize].material.0).collect();
        Self { source, geometry, triangles, patch_of, patches, materials }
    }

    /// The triangles with their levels; those without an order are left out, and noted.
    pub(super) fn raised(&self, contacts: &[Contact], findings: &mut Findings) -> Vec<Raised> {
        let joints = self.joints(contacts);
        let mut levels: Vec<Option<i32>> = vec![None; self.patches.len()];
        let joints: Vec<(&(usize, [usize; 2]), &Joint)> = joints.iter().collect();
        for same in joints.chunk_by(|a, b| a.0.0 == b.0.0) {
            // The patches of a plane are consecutive.
            let plane = same[0].0.0;
            let first = self.patches.partition_point(|(other, _)| *other < plane);
            let end = self.patches.partition_point(|(other, _)| *other <= plane);
            let own: Vec<Patch<'_>> = self.patches[first..end].iter().map(|(_, patch)| patch.clone()).collect();
            let mut pairs: Vec<Pair> = same
                .iter()
                .map(|((_, patches), joint)| Pair {
                    patches: patches.map(|patch| patch - first),
                    height: joint.moment / joint.area,
                    is_apart: joint.is_apart,
                })
                .collect();
            join_layers(&own, &self.materials[first..end], &mut pairs);
            let found = order::levels(&own, &pairs);
            for (_, joint) in same.iter().filter(|(_, joint)| !joint.is_apart) {
                self.note(&contacts[joint.contact], found.as_ref(), findings);
            }
            if let Some(found) = found {
                for (place, level) in levels[first..end].iter_mut().zip(found.levels) {
                    *place = Some(level);
                }
            }
        }
        let raise = |(&triangle, &patch): (&u32, &usize)| {
            let normal = Vec3::from_array(self.geometry.primitives[triangle as usize].0).as_dvec3();
            let is_up = self.patches[patch].1.is_up;
            levels[patch].map(|level| Raised { triangle, normal, level: if is_up { level } else { -level } })
        };
        self.triangles.iter().zip(&self.patch_of).filter_map(raise).collect()
    }

    /// The contacts of each pair of patches, by plane.
    fn joints(&self, contacts: &[Contact]) -> BTreeMap<(usize, [usize; 2]), Joint> {
        let mut joints: BTreeMap<(usize, [usize; 2]), Joint> = BTreeMap::new();
        for (i, contact) in contacts.iter().enumerate() {
            let [a, b] = contact.triangles.map(|triangle| self.patch_of[index(&self.triangles, triangle)]);
            let key = (self.patches[a].0, [a.min(b), a.max(b)]);
            let joint = joints.entry(key).or_insert(Joint { contact: i, is_apart: true, ..Joint::default() });
            if contact.is_apart && !joint.is_apart {
                continue;
            }
            if joint.is_apart && !contact.is_apart {
                *joint = Joint { contact: i, ..Joint::default() };
            }
            let is_turned = self.patches[a].1.is_up != (a < b);
            joint.area += contact.area;
            joint.moment += contact.area * if is_turned { -contact.height } else { contact.height };
        }
        joints
    }

    /// Notes the assumption where two patches touch; `found` are the levels in their plane.
    fn note(&self, contact: &Contact, found: Option<&Levels>, findings: &mut Findings) {
        if contact.is_thin {
            let name = self.source.name(self.geometry.mesh_of(contact.triangles[0])).to_owned();
            let thickness = findings.thin.entry(name).or_default();
            *thickness = thickness.max(contact.height.abs());
        }
        let (kind, names) = self.source.pair(self.geometry, contact);
        let Some(found) = found else {
            findings.failed.insert(names);
            return;
        };
        let kind = if kind == Kind::Film && found.is_wet { Kind::Optical } else { kind };
        // Not of solids with a common outer face, and of sheets that hide each other, as a box and its floor: nothing is
        // decided there.
        let decides = match kind {
            Kind::Film => true,
            Kind::Optical => !contact.is_parallel && !contact.is_thin,
            Kind::Sheets => contact.is_parallel,
        };
        if decides {
            findings.pairs.entry(kind).or_default().insert(names);
        }
    }
}

/// Gives both faces of a thin layer the same height over what they touch: their mean.
fn join_layers(patches: &[Patch<'_>], materials: &[u32], pairs: &mut [Pair]) {
    // By what the layer touches, and its material: the sum of heights over it, and their number.
    let mut heights: BTreeMap<(usize, u32), (f64, f64)> = BTreeMap::new();
    let of = |pair: &Pair| {
        let [a, b] = pair.patches;
        match (patches[a].is_thin, patches[b].is_thin) {
            _ if pair.is_apart => None,
            (false, true) => Some(((a, materials[b]), 1.0)),
            (true, false) => Some(((b, materials[a]), -1.0)),
            _ => None,
        }
    };
    for pair in &*pairs {
        if let Some((key, sign)) = of(pair) {
            let (sum, count) = heights.entry(key).or_default();
            *sum += sign * pair.height;
            *count += 1.0;
        }
    }
    for pair in pairs {
        if let Some((key, sign)) = of(pair) {
            let (sum, count) = heights[&key];
            pair.height = sign * sum / count;
        }
    }
}

/// Place of a triangle in a sorted list that has it.
pub(super) fn index(sorted: &[u32], triangle: u32) -> usize {
    sorted.partition_point(|&other| other < triangle)
}

/// Sets of triangles in one plane (union-find), and whether each faces as the first one of its set.
#[derive(Debug)]
pub(super) struct Planes {
    parents: Vec<(usize, bool)>,
}

impl Planes {
    pub(super) fn new(count: usize) -> Self {
        Self { parents: (0..count).map(|i| (i, true)).collect() }
    }

    pub(super) fn find(&mut self, mut of: usize) -> (usize, bool) {
        let mut same = true;
        while self.parents[of].0 != of {
            let (parent, first) = self.parents[of];
            let (above, second) = self.parents[parent];
            self.parents[of] = (above, first == second);
            same = same == self.parents[of].1;
            of = above;
        }
        (of, same)
    }

    pub(super) fn join(&mut self, a: usize, b: usize, is_parallel: bool) {
        let ((a, first), (b, second)) = (self.find(a), self.find(b));
        if a != b {
            self.parents[a.max(b)] = (a.min(b), (first == second) == is_parallel);
        }
    }
}
