//! Surfaces that coincide are set apart, so that a ray meets them one after the other.
//!
//! The next ray of a path starts [`photon_core::offset::STEP`] beyond a surface, hence beyond all others in the same plane,
//! which it would never meet. Here, triangles that coincide are moved by a few steps, in an order that depends on what they
//! bound alone: a solid recedes from a sheet (a film of air), solids reach into each other (optical contact; the stack of
//! media does the rest), and of two sheets the smaller one is in front. Faces between two parts of one medium are removed.
//! Normals stay as they are, and all else does where nothing coincides.

mod order;
mod pairs;
mod shift;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::{DVec3, Vec3};
use photon_core::{offset, parallel};

use crate::describe::{MaterialDesc, Surface};
use crate::mesh::Mesh;
use crate::normalise::Geometry;
use order::Patch;
use pairs::{Contact, Overlap, corners};
use shift::Raised;

/// Number of names in a warning.
const NAMED: usize = 6;

/// More meshes than this are not compared with each other before their triangles are.
const FEW: usize = 512;

/// The scene that is separated.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) meshes: &'a [Mesh],
    pub(crate) materials: &'a [MaterialDesc],
    /// Whether anything has textures or vertex attributes.
    pub(crate) is_shaded: bool,
}

/// Separates all triangles that coincide, and says so.
pub(crate) fn separate(source: Source<'_>, geometry: &mut Geometry, warnings: &mut Vec<String>) {
    let candidates = source.candidates(geometry);
    if candidates.is_empty() {
        return;
    }
    let owners: Vec<u32> = parallel::collect(candidates.len(), |i| geometry.mesh_of(candidates[i]) as u32);
    let (mut contacts, is_partial) = pairs::find(geometry, &candidates, |a, b| source.may_touch(owners[a], owners[b]));
    if is_partial {
        warnings.push(
            "so many triangles overlap that not all of them were compared; where some coincide, light may miss one of \
             them: remove duplicates"
                .to_owned(),
        );
    }
    // Of one medium, entering twice is the same in any order.
    contacts.retain(|contact| {
        let [a, b] = contact.triangles.map(|triangle| geometry.mesh_of(triangle));
        a != b || !contact.is_parallel
    });
    if contacts.is_empty() {
        return;
    }
    let inner = source.inner(geometry, &contacts);
    if !inner.is_empty() {
        let places = geometry.remove(&inner);
        contacts.retain_mut(|contact| {
            contact.triangles = contact.triangles.map(|triangle| places[triangle as usize]);
            !contact.triangles.contains(&u32::MAX)
        });
    }
    let mut told = Told { inner: inner.len(), ..Told::default() };
    let raised = source.raised(geometry, &contacts, &mut told);
    shift::apply(geometry, source.materials, &raised);
    let levels: HashMap<u32, Raised> = raised.iter().map(|of| (of.triangle, *of)).collect();
    for contact in &contacts {
        let [a, b] = contact.triangles;
        if let (Some(low), Some(high)) = (levels.get(&a), levels.get(&b)) {
            let overlap = Overlap::of(corners(geometry, a), corners(geometry, b));
            let sign = if low.level < high.level { 1.0 } else { -1.0 };
            let along = Vec3::from_array(geometry.primitives[a as usize].0).as_dvec3().dot(low.up).signum() * sign;
            let is_apart = overlap.is_none_or(|overlap| {
                let height = if along > 0.0 { overlap.heights.0 } else { -overlap.heights.1 };
                height >= 1.5 * f64::from(offset::STEP)
            });
            if !is_apart {
                told.failed.insert(source.pair(geometry, contact).1);
            }
        }
    }
    told.warn(warnings);
}

impl Source<'_> {
    /// Triangles that may touch others: those of solids, and those near another mesh.
    fn candidates(&self, geometry: &Geometry) -> Vec<u32> {
        let count = geometry.mesh_starts.len();
        let is_solid = |mesh: usize| self.material(mesh).is_solid();
        let margin = Vec3::splat(2.0 * offset::STEP);
        let around = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|vertex| Vec3::from_array(geometry.positions[vertex as usize]));
            (a.min(b).min(c) - margin, a.max(b).max(c) + margin)
        };
        let join = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
        let meet = |a: (Vec3, Vec3), b: (Vec3, Vec3)| a.0.cmple(b.1).all() && b.0.cmple(a.1).all();
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let boxes: Vec<(Vec3, Vec3)> = (0..count)
            .map(|mesh| geometry.triangles[geometry.range(mesh)].iter().map(around).fold(empty, join))
            .collect();
        let of_mesh = |_, mesh: usize| {
            let range = geometry.range(mesh);
            if range.is_empty() {
                return Vec::new();
            }
            if is_solid(mesh) || count > FEW {
                return range.map(|triangle| triangle as u32).collect();
            }
            let mut near: Vec<(Vec3, Vec3)> = (0..count)
                .filter(|&other| {
                    other != mesh && meet(boxes[mesh], boxes[other]) && self.may_touch(mesh as u32, other as u32)
                })
                .map(|other| boxes[other])
                .collect();
            // Few boxes are compared with each triangle.
            if near.len() > 16 {
                near = vec![near.into_iter().fold(empty, join)];
            }
            let is_near = |triangle: &usize| {
                let own = around(&geometry.triangles[*triangle]);
                near.iter().any(|&other| meet(own, other))
            };
            range.filter(is_near).map(|triangle| triangle as u32).collect()
        };
        parallel::map(parallel::threads(), 0..count, of_mesh).concat()
    }

    fn material(&self, mesh: usize) -> &MaterialDesc {
        &self.materials[self.meshes[mesh].material.0 as usize]
    }

    /// Whether it matters which of two triangles of these meshes a ray meets first.
    fn may_touch(&self, a: u32, b: u32) -> bool {
        let [first, second] = [a, b].map(|mesh| self.meshes[mesh as usize].material);
        let is_solid = [a, b].map(|mesh| self.material(mesh as usize).is_solid());
        let is_sheet = is_solid == [false; 2];
        let is_alike = || first == second || self.material(a as usize).is_alike(self.material(b as usize));
        !is_sheet || a != b && (self.is_shaded || !is_alike())
    }

    /// The faces that both sides of which are of one medium: fully covered by others of them that face them.
    fn inner(&self, geometry: &Geometry, contacts: &[Contact]) -> BTreeSet<u32> {
        let medium = |triangle: u32| {
            let desc = self.material(geometry.mesh_of(triangle));
            match desc.surface {
                Surface::Dielectric { ior, absorption, .. } if !desc.is_emissive() => {
                    Some((ior, absorption, desc.priority))
                }
                _ => None,
            }
        };
        let is_within = |contact: &Contact| {
            let [a, b] = contact.triangles.map(medium);
            !contact.is_parallel && a.is_some() && a == b
        };
        let mut covered: HashMap<u32, f64> = HashMap::new();
        for contact in contacts.iter().filter(|contact| is_within(contact)) {
            for triangle in contact.triangles {
                *covered.entry(triangle).or_default() += contact.area;
            }
        }
        let is_full = |&(&triangle, &covered): &(&u32, &f64)| {
            let [a, b, c] = corners(geometry, triangle);
            let area = 0.5 * (b - a).cross(c - a).length();
            let around = a.distance(b) + b.distance(c) + c.distance(a);
            (covered - area).abs() <= 1e-4 * area + f64::from(offset::STEP) * around
        };
        let mut inner: BTreeSet<u32> = covered.iter().filter(is_full).map(|(&triangle, _)| triangle).collect();
        // One that touches anything else stays, and so do those that it covers.
        loop {
            let before = inner.len();
            for contact in contacts {
                let [a, b] = contact.triangles;
                if !(is_within(contact) && inner.contains(&a) && inner.contains(&b)) {
                    inner.remove(&a);
                    inner.remove(&b);
                }
            }
            if inner.len() == before {
                return inner;
            }
        }
    }

    /// The triangles that touch others, with their levels.
    fn raised(&self, geometry: &Geometry, contacts: &[Contact], told: &mut Told) -> Vec<Raised> {
        let mut touched: Vec<u32> = contacts.iter().flat_map(|contact| contact.triangles).collect();
        touched.sort_unstable();
        touched.dedup();
        let index = |triangle: u32| touched.partition_point(|&other| other < triangle);
        let mut planes = Planes::new(touched.len());
        for contact in contacts {
            let [a, b] = contact.triangles.map(index);
            planes.join(a, b, contact.is_parallel);
        }
        // Patches of each plane, by mesh and orientation.
        let mut patches: BTreeMap<(usize, u32, bool), (usize, f64)> = BTreeMap::new();
        let keys: Vec<(usize, u32, bool)> = touched
            .iter()
            .enumerate()
            .map(|(i, &triangle)| {
                let (plane, is_up) = planes.find(i);
                (plane, geometry.mesh_of(triangle) as u32, is_up)
            })
            .collect();
        let area = |triangle: u32| {
            let [a, b, c] = corners(geometry, triangle);
            0.5 * (b - a).cross(c - a).length()
        };
        for (&key, &triangle) in keys.iter().zip(&touched) {
            patches.entry(key).or_default().1 += area(triangle);
        }
        let mut whole: HashMap<u32, f64> = HashMap::new();
        for &(_, mesh, _) in patches.keys() {
            whole
                .entry(mesh)
                .or_insert_with(|| geometry.range(mesh as usize).map(|triangle| area(triangle as u32)).sum());
        }
        patches.values_mut().enumerate().for_each(|(i, patch)| patch.0 = i);
        let all: Vec<(usize, Patch<'_>)> = patches
            .iter()
            .map(|(&(plane, mesh, is_up), &(_, touching))| {
                let material = self.material(mesh as usize);
                (plane, Patch { material, is_up, areas: [touching, whole[&mesh]] })
            })
            .collect();
        let patch_of: Vec<usize> = keys.iter().map(|key| patches[key].0).collect();
        let mut pairs: Vec<(usize, [usize; 2], usize)> = contacts
            .iter()
            .enumerate()
            .map(|(i, contact)| {
                let [a, b] = contact.triangles.map(|triangle| patch_of[index(triangle)]);
                (all[a].0, [a.min(b), a.max(b)], i)
            })
            .collect();
        pairs.sort_unstable();
        pairs.dedup_by_key(|pair| (pair.0, pair.1));
        let mut levels: Vec<Option<i32>> = vec![None; all.len()];
        for same in pairs.chunk_by(|a, b| a.0 == b.0) {
            // The patches of a plane are consecutive.
            let first = all.partition_point(|(plane, _)| *plane < same[0].0);
            let end = all.partition_point(|(plane, _)| *plane <= same[0].0);
            let own: Vec<Patch<'_>> = all[first..end].iter().map(|(_, patch)| patch.clone()).collect();
            let of_own: Vec<[usize; 2]> = same.iter().map(|pair| pair.1.map(|patch| patch - first)).collect();
            let found = order::levels(&own, &of_own);
            for (_, _, contact) in same {
                let (kind, names) = self.pair(geometry, &contacts[*contact]);
                match &found {
                    None => drop(told.failed.insert(names)),
                    Some(found) => {
                        let kind = if kind == Kind::Film && found.is_wet { Kind::Optical } else { kind };
                        // Not of solids with a common outer face, and of sheets that hide each other, as a box and its
                        // floor: nothing is decided there.
                        let decides = match kind {
                            Kind::Film => true,
                            Kind::Optical => !contacts[*contact].is_parallel,
                            Kind::Sheets => contacts[*contact].is_parallel,
                        };
                        if decides {
                            told.pairs.entry(kind).or_default().insert(names);
                        }
                    }
                }
            }
            if let Some(found) = found {
                for (place, level) in levels[first..end].iter_mut().zip(found.levels) {
                    *place = Some(level);
                }
            }
        }
        let raise = |(i, &triangle): (usize, &u32)| {
            let (.., is_up) = keys[i];
            let normal = Vec3::from_array(geometry.primitives[triangle as usize].0).as_dvec3();
            let up: DVec3 = if is_up { normal } else { -normal };
            levels[patch_of[i]].map(|level| Raised { triangle, up, level })
        };
        touched.iter().enumerate().filter_map(raise).collect()
    }

    /// The kind of a contact, and the names of what touches: the solid or the smaller one first.
    fn pair(&self, geometry: &Geometry, contact: &Contact) -> (Kind, String) {
        let mut meshes = contact.triangles.map(|triangle| geometry.mesh_of(triangle));
        let solid = meshes.map(|mesh| self.material(mesh).is_solid());
        let kind = match solid {
            [true, true] => Kind::Optical,
            [false, false] => Kind::Sheets,
            _ => Kind::Film,
        };
        let name = |mesh: usize| {
            let own: &str = &self.meshes[mesh].name;
            if own.is_empty() { &*self.material(mesh).name } else { own }
        };
        if solid == [false, true] || solid[0] == solid[1] && name(meshes[0]) > name(meshes[1]) {
            meshes.swap(0, 1);
        }
        let [a, b] = meshes.map(name);
        (kind, format!("'{a}' and '{b}'"))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Film,
    Optical,
    Sheets,
}

/// Subjects of the warnings.
#[derive(Debug, Default)]
struct Told {
    inner: usize,
    pairs: BTreeMap<Kind, BTreeSet<String>>,
    failed: BTreeSet<String>,
}

impl Told {
    fn warn(self, warnings: &mut Vec<String>) {
        for (kind, names) in &self.pairs {
            let how = match kind {
                Kind::Film => {
                    "a film of air is assumed between a solid and what it touches: model an overlap for optical \
                               contact"
                }
                Kind::Optical => "optical contact is assumed, without air between them: model a gap for air",
                Kind::Sheets => "surfaces in one plane: the smaller one is in front",
            };
            warnings.push(format!("{} touch; {how}", listed(names)));
        }
        if self.inner > 0 {
            warnings.push(format!("{} faces within one medium bound nothing and were removed", self.inner));
        }
        if !self.failed.is_empty() {
            warnings.push(format!(
                "{} coincide and could not be set apart, so that light may miss one of them; move them apart by 1e-5 of \
                 the scene's extent",
                listed(&self.failed)
            ));
        }
    }
}

fn listed(names: &BTreeSet<String>) -> String {
    let mut text = names.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > NAMED {
        text += &format!(", and {} more", names.len() - NAMED);
    }
    text
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
