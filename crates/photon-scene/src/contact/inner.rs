//! Faces between two parts of one medium, which bound nothing.

use std::collections::{BTreeSet, HashMap};

use photon_core::offset;

use super::Source;
use super::pairs::{Contact, corners};
use crate::describe::Surface;
use crate::normalise::Geometry;

/// The faces with one medium on both sides: fully covered by others of it that face them.
pub(super) fn find(source: &Source<'_>, geometry: &Geometry, contacts: &[Contact]) -> BTreeSet<u32> {
    let medium = |triangle: u32| {
        let desc = source.material(geometry.mesh_of(triangle));
        let is_clear = matches!(desc.surface, Surface::Dielectric { .. }) && !desc.is_emissive();
        if is_clear { source.medium(geometry.mesh_of(triangle)) } else { None }
    };
    let is_within = |contact: &Contact| {
        let [a, b] = contact.triangles.map(medium);
        !contact.is_parallel && !contact.is_thin && a.is_some() && a == b
    };
    let contacts: Vec<&Contact> = contacts.iter().filter(|contact| !contact.is_apart).collect();
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
        for contact in &contacts {
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
