//! Surfaces that coincide are set apart, so that a ray meets them one after the other.
//!
//! The next ray of a path starts [`photon_core::offset::STEP`] beyond a surface, hence beyond all others in the same plane,
//! which it would never meet. Here, triangles that coincide are moved by a few steps, in an order that depends on what they
//! bound alone: a solid recedes from a sheet (a film of air), solids reach into each other (optical contact; the stack of
//! media does the rest), and of two sheets the smaller one is in front. Faces between two parts of one medium are removed.
//! Normals stay as they are, and all else does where nothing coincides.

mod candidates;
mod inner;
mod order;
mod pairs;
mod planes;
mod shift;
mod warnings;

use std::collections::HashMap;

use glam::Vec3;
use photon_core::{offset, parallel};

use crate::describe::MaterialDesc;
use crate::mesh::Mesh;
use crate::normalise::Geometry;
use pairs::{Contact, Overlap, corners};
use planes::Touching;
use shift::Raised;
use warnings::Findings;

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
    // Of one medium, entering twice is the same in any order.
    let wanted = |[a, b]: [usize; 2], is_parallel: bool| {
        let [a, b] = [owners[a], owners[b]];
        (a != b || !is_parallel) && source.may_touch(a, b)
    };
    let (mut contacts, is_partial) = pairs::find(geometry, &candidates, wanted);
    let mut findings = Findings { is_partial, ..Findings::default() };
    if contacts.is_empty() {
        findings.warn(warnings);
        return;
    }
    let inner = inner::find(&source, geometry, &contacts);
    if !inner.is_empty() {
        let places = geometry.remove(&inner);
        contacts.retain_mut(|contact| {
            contact.triangles = contact.triangles.map(|triangle| places[triangle as usize]);
            !contact.triangles.contains(&u32::MAX)
        });
    }
    findings.inner = inner.len();
    let raised = Touching::new(&source, geometry, &contacts).raised(&contacts, &mut findings);
    shift::apply(geometry, source.materials, &raised);
    note_failures(&source, geometry, &contacts, &raised, &mut findings);
    findings.warn(warnings);
}

/// Notes the pairs that did not come apart.
fn note_failures(
    source: &Source<'_>,
    geometry: &Geometry,
    contacts: &[Contact],
    raised: &[Raised],
    findings: &mut Findings,
) {
    let levels: HashMap<u32, Raised> = raised.iter().map(|of| (of.triangle, *of)).collect();
    for contact in contacts {
        let [a, b] = contact.triangles;
        let (Some(low), Some(high)) = (levels.get(&a), levels.get(&b)) else { continue };
        let Some(overlap) = Overlap::of(corners(geometry, a), corners(geometry, b)) else { continue };
        let sign = if low.level < high.level { 1.0 } else { -1.0 };
        let along = Vec3::from_array(geometry.primitives[a as usize].0).as_dvec3().dot(low.up).signum() * sign;
        let height = if along > 0.0 { overlap.heights.0 } else { -overlap.heights.1 };
        if height < 1.5 * f64::from(offset::STEP) {
            findings.failed.insert(source.pair(geometry, contact).1);
        }
    }
}

impl Source<'_> {
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
}
