//! Solids that are thinner than what is resolved.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use photon_core::{crossing, offset, parallel};

use super::pairs::{Contact, corners};
use super::planes::{Planes, index};
use super::{SolidMedium, Source};
use crate::normalise::Geometry;

/// Distance from two faces that coincide at which it is decided what is outside of both.
const BEYOND: f64 = 4.0 * offset::STEP as f64;

/// Marks the contacts of faces that bound one medium, where that is on neither side of both.
pub(super) fn mark(source: &Source<'_>, geometry: &Geometry, contacts: &mut [Contact]) {
    let medium = |triangle: u32| source.medium(geometry.mesh_of(triangle));
    let is_of_one = |contact: &Contact| {
        let [a, b] = contact.triangles.map(medium);
        !contact.is_parallel && !contact.is_apart && a.is_some() && a == b
    };
    let own: Vec<usize> = (0..contacts.len()).filter(|&i| is_of_one(&contacts[i])).collect();
    let mut triangles: Vec<u32> = own.iter().flat_map(|&i| contacts[i].triangles).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let mut planes = Planes::new(triangles.len());
    for &i in &own {
        let [a, b] = contacts[i].triangles.map(|triangle| index(&triangles, triangle));
        planes.join(a, b, false);
    }
    // The answer is the same for all that are connected; it is that for the largest one.
    let mut plane_of = |i: usize| planes.find(index(&triangles, contacts[i].triangles[0])).0;
    let plane_of: Vec<usize> = own.iter().map(|&i| plane_of(i)).collect();
    let mut largest: BTreeMap<usize, usize> = BTreeMap::new();
    for (&i, &plane) in own.iter().zip(&plane_of) {
        let known = largest.entry(plane).or_insert(i);
        if contacts[i].area > contacts[*known].area {
            *known = i;
        }
    }
    let boxes =
        boxes(source, geometry, &largest.values().map(|&i| medium(contacts[i].triangles[0])).collect::<Vec<_>>());
    let is_thin = |_, (&plane, &i): (&usize, &usize)| {
        let contact = &contacts[i];
        let [first, _] = contact.triangles;
        let up = Vec3::from_array(geometry.primitives[first as usize].0).as_dvec3() * BEYOND;
        let of = medium(first);
        let is_outside = |at: DVec3| {
            let meshes = boxes.iter().filter(|(mesh, low, high)| {
                source.medium(*mesh) == of
                    && (1..3).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis])
                    && at.x <= high.x
            });
            let triangles = meshes.flat_map(|(mesh, ..)| geometry.range(*mesh));
            triangles.map(|triangle| crossing(corners(geometry, triangle as u32), at)).sum::<i32>() <= 0
        };
        (plane, [contact.middle + up, contact.middle - up].into_iter().all(is_outside))
    };
    let is_thin: BTreeMap<usize, bool> =
        parallel::map(parallel::threads(), largest.iter(), is_thin).into_iter().collect();
    for (i, plane) in own.into_iter().zip(plane_of) {
        contacts[i].is_thin = is_thin[&plane];
    }
}

/// The meshes that bound one of these media, with their bounding boxes.
fn boxes(source: &Source<'_>, geometry: &Geometry, media: &[Option<SolidMedium>]) -> Vec<(usize, DVec3, DVec3)> {
    let of = |mesh: usize| {
        let points = geometry.range(mesh).flat_map(|triangle| corners(geometry, triangle as u32));
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        (mesh, low, high)
    };
    (0..geometry.mesh_starts.len()).filter(|&mesh| media.contains(&source.medium(mesh))).map(of).collect()
}
