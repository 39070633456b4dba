//! Solids that are thinner than what is resolved.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};
use photon_core::{crossing, offset};

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
    // The answer is the same for all that are connected: that for the largest one.
    let mut plane_of = |i: usize| planes.find(index(&triangles, contacts[i].triangles[0])).0;
    let plane_of: Vec<usize> = own.iter().map(|&i| plane_of(i)).collect();
    let mut largest: BTreeMap<usize, usize> = BTreeMap::new();
    for (&i, &plane) in own.iter().zip(&plane_of) {
        let known = largest.entry(plane).or_insert(i);
        if contacts[i].area > contacts[*known].area {
            *known = i;
        }
    }
    let beyond = |(&plane, &i): (&usize, &usize)| {
        let [first, _] = contacts[i].triangles;
        let up = Vec3::from_array(geometry.primitives[first as usize].0).as_dvec3() * BEYOND;
        [up, -up].map(|up| Point { plane, medium: medium(first), at: contacts[i].middle + up, winding: 0 })
    };
    let mut points: Vec<Point> = largest.iter().flat_map(beyond).collect();
    count_windings(source, geometry, &mut points);
    let inside: BTreeSet<usize> = points.iter().filter(|point| point.winding > 0).map(|point| point.plane).collect();
    for (i, plane) in own.into_iter().zip(plane_of) {
        contacts[i].is_thin = !inside.contains(&plane);
    }
}

/// A point beside a plane.
struct Point {
    plane: usize,
    medium: Option<SolidMedium>,
    at: DVec3,
    /// Number of times that the boundaries of the medium enclose it.
    winding: i32,
}

/// Finds whether the points are in their media, by the triangles that a ray along +x crosses.
fn count_windings(source: &Source<'_>, geometry: &Geometry, points: &mut [Point]) {
    points.sort_by(|a, b| a.at.y.total_cmp(&b.at.y));
    for mesh in 0..geometry.mesh_starts.len() {
        let medium = source.medium(mesh);
        if medium.is_none() || points.iter().all(|point| point.medium != medium) {
            continue;
        }
        for triangle in geometry.range(mesh) {
            let corners = corners(geometry, triangle as u32);
            let [a, b, c] = corners;
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let from = points.partition_point(|point| point.at.y < low.y);
            for point in points[from..].iter_mut().take_while(|point| point.at.y <= high.y) {
                if low.z <= point.at.z && point.at.z <= high.z && point.medium == medium {
                    point.winding += crossing(corners, point.at);
                }
            }
        }
    }
}
