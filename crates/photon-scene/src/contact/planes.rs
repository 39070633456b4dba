//! Planes in which triangles touch, and the level of each triangle there.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec3, Vec3};

use super::Source;
use super::order::{self, Levels, Patch};
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
        let places: HashMap<Key, usize> = touching.keys().enumerate().map(|(i, &key)| (key, i)).collect();
        let patch = |(&(plane, mesh, is_up), &touching): (&Key, &f64)| {
            let material = source.material(mesh as usize);
            (plane, Patch { material, is_up, areas: [touching, whole[&mesh]] })
        };
        let patches = touching.iter().map(patch).collect();
        let patch_of = keys.iter().map(|key| places[key]).collect();
        Self { source, geometry, triangles, patch_of, patches }
    }

    /// The triangles with their levels; those without an order are left out, and noted.
    pub(super) fn raised(&self, contacts: &[Contact], findings: &mut Findings) -> Vec<Raised> {
        // Each pair of patches once: their plane, they, and one of their contacts.
        let mut pairs: Vec<(usize, [usize; 2], usize)> = contacts
            .iter()
            .enumerate()
            .map(|(i, contact)| {
                let [a, b] = contact.triangles.map(|triangle| self.patch_of[index(&self.triangles, triangle)]);
                (self.patches[a].0, [a.min(b), a.max(b)], i)
            })
            .collect();
        pairs.sort_unstable();
        pairs.dedup_by_key(|pair| (pair.0, pair.1));
        let mut levels: Vec<Option<i32>> = vec![None; self.patches.len()];
        for same in pairs.chunk_by(|a, b| a.0 == b.0) {
            // The patches of a plane are consecutive.
            let first = self.patches.partition_point(|(plane, _)| *plane < same[0].0);
            let end = self.patches.partition_point(|(plane, _)| *plane <= same[0].0);
            let own: Vec<Patch<'_>> = self.patches[first..end].iter().map(|(_, patch)| patch.clone()).collect();
            let of_own: Vec<[usize; 2]> = same.iter().map(|pair| pair.1.map(|patch| patch - first)).collect();
            let found = order::levels(&own, &of_own);
            for (_, _, contact) in same {
                self.note(&contacts[*contact], found.as_ref(), findings);
            }
            if let Some(found) = found {
                for (place, level) in levels[first..end].iter_mut().zip(found.levels) {
                    *place = Some(level);
                }
            }
        }
        let raise = |(&triangle, &patch): (&u32, &usize)| {
            let normal = Vec3::from_array(self.geometry.primitives[triangle as usize].0).as_dvec3();
            let up: DVec3 = if self.patches[patch].1.is_up { normal } else { -normal };
            levels[patch].map(|level| Raised { triangle, up, level })
        };
        self.triangles.iter().zip(&self.patch_of).filter_map(raise).collect()
    }

    /// Notes the assumption where two patches touch; `found` are the levels in their plane.
    fn note(&self, contact: &Contact, found: Option<&Levels>, findings: &mut Findings) {
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
            Kind::Optical => !contact.is_parallel,
            Kind::Sheets => contact.is_parallel,
        };
        if decides {
            findings.pairs.entry(kind).or_default().insert(names);
        }
    }
}

/// Place of a triangle in a sorted list that has it.
fn index(sorted: &[u32], triangle: u32) -> usize {
    sorted.partition_point(|&other| other < triangle)
}

/// Sets of triangles in one plane (union-find), and whether each faces as the first one of its set.
#[derive(Debug)]
struct Planes {
    parents: Vec<(usize, bool)>,
}

impl Planes {
    fn new(count: usize) -> Self {
        Self { parents: (0..count).map(|i| (i, true)).collect() }
    }

    fn find(&mut self, mut of: usize) -> (usize, bool) {
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

    fn join(&mut self, a: usize, b: usize, is_parallel: bool) {
        let ((a, first), (b, second)) = (self.find(a), self.find(b));
        if a != b {
            self.parents[a.max(b)] = (a.min(b), (first == second) == is_parallel);
        }
    }
}
