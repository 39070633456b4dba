//! Warnings: which surfaces touch, and what is assumed there.

use std::collections::{BTreeMap, BTreeSet};

use super::Source;
use super::pairs::{Contact, REACH};
use super::shift::GAP;
use crate::normalise::Geometry;

/// Thickness that rounding may cause, normalised.
const ROUNDING: f64 = 1.2e-7;

/// Number of names in a warning.
const NAMED: usize = 6;

/// Assumption where two surfaces touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Air between a solid and a sheet.
    Film,
    /// No air between two solids.
    Optical,
    /// One of two sheets in front of the other.
    Sheets,
}

/// Contacts, and faces that were removed, of which the user is warned.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Whether the search for contacts was given up.
    pub(super) is_partial: bool,
    /// Number of faces within one medium.
    pub(super) inner: usize,
    /// Names of the surfaces that touch.
    pub(super) pairs: BTreeMap<Kind, BTreeSet<String>>,
    /// Names of solids that are thinner than what is resolved, and their thickness, normalised.
    pub(super) thin: BTreeMap<String, f64>,
    /// Names of those that could not be set apart.
    pub(super) failed: BTreeSet<String>,
}

impl Findings {
    /// Adds the warnings; `scale` is the extent of the scene.
    pub(super) fn warn(self, scale: f64, warnings: &mut Vec<String>) {
        if self.is_partial {
            warnings.push(
                "so many triangles overlap that not all of them were compared; where some coincide, light may miss one of \
                 them: remove duplicates"
                    .to_owned(),
            );
        }
        for (name, &thickness) in self.thin.iter().take(NAMED) {
            let [own, least, shown] = [thickness, REACH, thickness + GAP].map(|length| length * scale);
            let own =
                if thickness > ROUNDING { format!("is only {own:.1e} thick") } else { "has no thickness".to_owned() };
            warnings.push(format!(
                "the solid '{name}' {own}: this scene resolves {least:.1e}, 2e-6 of its extent, and shows it {shown:.1e} \
                 thick; make it kind = thin, or thicker, or the scene smaller"
            ));
        }
        if self.thin.len() > NAMED {
            warnings.push(format!("{} more solids are thinner than what this scene resolves", self.thin.len() - NAMED));
        }
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

impl Source<'_> {
    /// The kind of a contact, and the names of what touches: the solid or the smaller one first.
    pub(super) fn pair(&self, geometry: &Geometry, contact: &Contact) -> (Kind, String) {
        let mut meshes = contact.triangles.map(|triangle| geometry.mesh_of(triangle));
        let solid = meshes.map(|mesh| self.material(mesh).is_solid());
        let kind = match solid {
            [true, true] => Kind::Optical,
            [false, false] => Kind::Sheets,
            _ => Kind::Film,
        };
        let name = |mesh: usize| self.name(mesh);
        if solid == [false, true] || solid[0] == solid[1] && name(meshes[0]) > name(meshes[1]) {
            meshes.swap(0, 1);
        }
        let [a, b] = meshes.map(name);
        (kind, if meshes[0] == meshes[1] { format!("parts of '{a}'") } else { format!("'{a}' and '{b}'") })
    }

    /// The name of a mesh, or else of its material.
    pub(super) fn name(&self, mesh: usize) -> &str {
        let own: &str = &self.meshes[mesh].name;
        if own.is_empty() { &self.material(mesh).name } else { own }
    }
}
