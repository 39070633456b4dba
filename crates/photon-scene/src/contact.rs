//! Surfaces that coincide are set apart, so that a ray meets them one after the other.
//!
//! The next ray of a path starts [`photon_core::offset::STEP`] beyond a surface, hence beyond all others in the same plane,
//! which it would never meet. Here, triangles that coincide are moved by a few steps, in an order that depends on what they
//! bound alone: a solid recedes from a sheet (a film of air), solids reach into each other (optical contact; the stack of
//! media does the rest), and of two sheets the smaller one is in front. Faces between two parts of one medium are removed.
//! Normals stay as they are, and all else does where nothing coincides.

mod candidates;
mod cells;
mod inner;
mod order;
mod pairs;
mod planes;
mod shift;
mod thin;
mod warnings;

use std::collections::HashMap;

use photon_core::{offset, parallel};

use crate::describe::{Dispersion, GridDesc, MaterialDesc, PhaseDesc, Surface};
use crate::mesh::Mesh;
use crate::normalise::Geometry;
use pairs::{Contact, Overlap, REACH, corners};
use planes::Touching;
use shift::{GAP, Raised};
use warnings::Findings;

/// Refractive index, absorption, priority, dispersion, scattering and densities of a solid.
type SolidMedium = (f64, [f64; 3], u32, Option<Dispersion>, [f64; 3], PhaseDesc, Option<GridDesc>);

/// The scene that is separated.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) meshes: &'a [Mesh],
    pub(crate) materials: &'a [MaterialDesc],
    /// Whether anything has textures or vertex attributes.
    pub(crate) is_shaded: bool,
    /// User length of a normalised one.
    pub(crate) scale: f64,
}

/// Maximum number of searches: each finds what more levels could reach.
const SEARCHES: u32 = 4;

/// Separates all triangles that coincide, and says so.
pub(crate) fn separate(source: Source<'_>, geometry: &mut Geometry, warnings: &mut Vec<String>) {
    let mut inner = 0;
    // Two levels are enough for most scenes.
    let mut reach = REACH + 2.0 * GAP;
    for search in 1..=SEARCHES {
        let (mut contacts, is_partial) = source.contacts(geometry, reach);
        let mut findings = Findings { is_partial, ..Findings::default() };
        if contacts.iter().all(|contact| contact.is_apart) {
            findings.inner = inner;
            findings.warn(source.scale, warnings);
            return;
        }
        thin::mark(&source, geometry, &mut contacts);
        let within = inner::find(&source, geometry, &contacts);
        if !within.is_empty() {
            let places = geometry.remove(&within);
            contacts.retain_mut(|contact| {
                contact.triangles = contact.triangles.map(|triangle| places[triangle as usize]);
                !contact.triangles.contains(&u32::MAX)
            });
        }
        inner += within.len();
        findings.inner = inner;
        let raised = Touching::new(&source, geometry, &contacts).raised(&contacts, &mut findings);
        let most = raised.iter().map(|raised| raised.level.abs()).max().unwrap_or(0);
        let reached = REACH + f64::from(most) * GAP;
        if reached > reach && search < SEARCHES {
            reach = reached;
            continue;
        }
        shift::apply(geometry, source.materials, &raised);
        note_failures(&source, geometry, &contacts, &raised, &mut findings);
        findings.warn(source.scale, warnings);
        return;
    }
}

/// Notes the pairs that did not come apart.
fn note_failures(
    source: &Source<'_>,
    geometry: &Geometry,
    contacts: &[Contact],
    raised: &[Raised],
    findings: &mut Findings,
) {
    let levels: HashMap<u32, i32> = raised.iter().map(|of| (of.triangle, of.level)).collect();
    for contact in contacts {
        let [a, b] = contact.triangles;
        let (Some(&first), Some(&second)) = (levels.get(&a), levels.get(&b)) else { continue };
        let Some(overlap) = Overlap::of(corners(geometry, a), corners(geometry, b)) else { continue };
        // Along the normal of the first one.
        let second = if contact.is_parallel { second } else { -second };
        let is_above = if contact.is_apart { contact.height > 0.0 } else { first < second };
        let height = if is_above { overlap.heights.0 } else { -overlap.heights.1 };
        if height < 1.5 * f64::from(offset::STEP) {
            findings.failed.insert(source.pair(geometry, contact).1);
        }
    }
}

impl Source<'_> {
    fn material(&self, mesh: usize) -> &MaterialDesc {
        &self.materials[self.meshes[mesh].material.0 as usize]
    }

    /// Medium of the solid that a mesh bounds.
    fn medium(&self, mesh: usize) -> Option<SolidMedium> {
        let desc = self.material(mesh);
        let of = |surface: &Surface| match *surface {
            Surface::Dielectric { ior, absorption, .. } => {
                let (scattering, grid) = (desc.scattering, desc.grid.clone());
                Some((ior, absorption, desc.priority, desc.dispersion, scattering, desc.phase, grid))
            }
            _ => None,
        };
        of(&desc.surface).or_else(|| desc.transmitting_surface().as_ref().and_then(of))
    }

    /// The triangles that coincide, or nearly do, up to a distance of `reach`; and whether the search was given up.
    fn contacts(&self, geometry: &Geometry, reach: f64) -> (Vec<Contact>, bool) {
        let candidates = self.candidates(geometry, reach);
        if candidates.is_empty() { (Vec::new(), false) } else { self.among(geometry, &candidates, reach) }
    }

    /// The contacts among these triangles, and whether the search was given up.
    fn among(&self, geometry: &Geometry, candidates: &[u32], reach: f64) -> (Vec<Contact>, bool) {
        let owners: Vec<u32> = parallel::collect(candidates.len(), |i| geometry.mesh_of(candidates[i]) as u32);
        // Of one medium, entering twice is the same in any order.
        let wanted = |[a, b]: [usize; 2], is_parallel: bool| {
            let [a, b] = [owners[a], owners[b]];
            (a != b || !is_parallel) && self.may_touch(a, b)
        };
        pairs::find(geometry, candidates, reach, wanted)
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
