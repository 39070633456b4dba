//! Displacement of vertices, so that triangles come to lie on their levels.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DMat3, DVec3, Vec3};
use photon_core::offset;

use super::pairs::corners;
use crate::describe::MaterialDesc;
use crate::normalise::Geometry;

/// Distance of levels: more than a ray's offset, and the rounding errors of vertices.
pub(super) const GAP: f64 = 4.0 * offset::STEP as f64;

/// Weight of short displacements against exact ones, where the planes of a vertex contradict each other.
const DAMPING: f64 = 1e-3;

/// Place of a vertex: the bits of its coordinates.
type Place = [u32; 3];

/// A triangle, its normal, and its level along that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raised {
    pub(super) triangle: u32,
    pub(super) normal: DVec3,
    pub(super) level: i32,
}

/// Moves the vertices of `raised` triangles. Vertices of one solid, or of one mesh that is no solid, that are at one place
/// move together; those of others stay.
pub(super) fn apply(geometry: &mut Geometry, materials: &[MaterialDesc], raised: &[Raised]) {
    let moving: HashSet<Place> = raised
        .iter()
        .filter(|raised| raised.level != 0)
        .flat_map(|raised| geometry.triangles[raised.triangle as usize].map(|vertex| place(geometry, vertex)))
        .collect();
    let touched: HashMap<u32, &Raised> = raised.iter().map(|raised| (raised.triangle, raised)).collect();
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let places = moving.iter().map(|at| Vec3::from_array(at.map(f32::from_bits)));
    let bounds = places.fold(empty, |(low, high), at| (low.min(at), high.max(at)));
    // Most vertices are nowhere near those.
    let is_near = |vertex: u32| {
        let at = Vec3::from_array(geometry.positions[vertex as usize]);
        at.cmpge(bounds.0).all() && at.cmple(bounds.1).all()
    };
    let is_moving: Vec<bool> = (0..geometry.positions.len() as u32)
        .map(|vertex| is_near(vertex) && moving.contains(&place(geometry, vertex)))
        .collect();
    // Triangles by what they may move with, and by place.
    let mut uses: HashMap<u32, usize> = HashMap::new();
    let mut fans: BTreeMap<(bool, u32, Place), Vec<u32>> = BTreeMap::new();
    for (triangle, corners) in (0..).zip(&geometry.triangles) {
        if !corners.iter().any(|&vertex| is_moving[vertex as usize]) {
            continue;
        }
        let material = geometry.primitives[triangle as usize].1;
        let is_solid = materials[material as usize].is_solid();
        let of = if is_solid { material } else { geometry.mesh_of(triangle) as u32 };
        for &vertex in corners.iter().filter(|&&vertex| is_moving[vertex as usize]) {
            fans.entry((is_solid, of, place(geometry, vertex))).or_default().push(triangle);
            *uses.entry(vertex).or_default() += 1;
        }
    }
    // Whether two faces that meet at an edge are those of a layer without thickness, which gets one.
    let comes_apart = |a: u32, b: u32| {
        let (Some(a), Some(b)) = (touched.get(&a), touched.get(&b)) else { return false };
        a.normal.dot(b.normal) < -0.999 && a.level + b.level != 0
    };
    // Corners that move, by vertex and new place.
    let mut moves: Vec<(u32, Place, u32)> = Vec::new();
    for ((is_solid, _, at), triangles) in fans {
        let fans = if is_solid { connected(geometry, at, &triangles, &comes_apart) } else { vec![triangles] };
        for fan in fans {
            let planes = fan.iter().filter_map(|triangle| touched.get(triangle)).copied();
            let Some(way) = displacement(planes) else { continue };
            let to = (Vec3::from_array(at.map(f32::from_bits)).as_dvec3() + way).as_vec3() + 0.0;
            for triangle in fan {
                let own = geometry.triangles[triangle as usize];
                let own = own.into_iter().filter(|&vertex| place(geometry, vertex) == at);
                moves.extend(own.map(|vertex| (vertex, to.to_array().map(f32::to_bits), triangle)));
            }
        }
    }
    moves.sort_unstable();
    for same in moves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (vertex, to, _) = same[0];
        let position = to.map(f32::from_bits);
        // A vertex that stays for other triangles is doubled.
        let uses = uses.entry(vertex).or_default();
        *uses -= same.len();
        if *uses == 0 {
            geometry.positions[vertex as usize] = position;
            continue;
        }
        let copy = geometry.positions.len() as u32;
        geometry.positions.push(position);
        for &(_, _, triangle) in same {
            for corner in geometry.triangles[triangle as usize].iter_mut().filter(|corner| **corner == vertex) {
                *corner = copy;
            }
        }
    }
}

fn place(geometry: &Geometry, vertex: u32) -> Place {
    // Zeros of both signs are the same.
    geometry.positions[vertex as usize].map(|x| (x + 0.0).to_bits())
}

/// Displacement of a vertex onto the levels of its planes, by least squares; `None` if it stays.
fn displacement<'a>(planes: impl Iterator<Item = &'a Raised>) -> Option<DVec3> {
    // In an order that does not depend on that of triangles.
    let mut planes: Vec<&Raised> = planes.collect();
    planes.sort_unstable_by(|a, b| {
        let by_normal = a.normal.to_array().into_iter().zip(b.normal.to_array()).map(|(a, b)| a.total_cmp(&b));
        by_normal.fold(b.level.abs().cmp(&a.level.abs()), Ordering::then)
    });
    // Several triangles of one plane count once, with the largest level.
    let mut different: Vec<&Raised> = Vec::new();
    for plane in planes {
        if different.iter().all(|known| known.normal.dot(plane.normal).abs() <= 0.999) {
            different.push(plane);
        }
    }
    let most = different.first().map(|plane| plane.level.abs()).filter(|&most| most > 0)?;
    let mut square = DMat3::from_diagonal(DVec3::splat(DAMPING));
    let mut right = DVec3::ZERO;
    for &&Raised { normal, level, .. } in &different {
        square += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        right += normal * (f64::from(level) * GAP);
    }
    Some((square.inverse() * right).clamp_length_max(4.0 * GAP * f64::from(most)))
}

/// Groups the triangles around a place that bound one solid: those that are connected by edges. Where solids touch along
/// an edge, a triangle is joined with the one that encloses the smaller angle of the solid.
fn connected(
    geometry: &Geometry,
    at: Place,
    triangles: &[u32],
    comes_apart: &dyn Fn(u32, u32) -> bool,
) -> Vec<Vec<u32>> {
    let mut group: Vec<usize> = (0..triangles.len()).collect();
    // The edges at the place: their other end, whether the triangle traverses them from there, and the triangle.
    let mut edges: Vec<(Place, bool, usize)> = Vec::with_capacity(2 * triangles.len());
    for (index, &triangle) in triangles.iter().enumerate() {
        let places = geometry.triangles[triangle as usize].map(|vertex| place(geometry, vertex));
        if let Some(corner) = places.iter().position(|&other| other == at) {
            edges.push((places[(corner + 1) % 3], true, index));
            edges.push((places[(corner + 2) % 3], false, index));
        }
    }
    edges.sort_unstable();
    let mut join = |a: usize, b: usize| {
        let (from, to) = (group[a], group[b]);
        group.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
    };
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        let outwards = edge.iter().filter(|edge| edge.1);
        let inwards = || edge.iter().filter(|edge| !edge.1);
        let mut joints: Vec<(bool, f64, usize, usize)> = outwards
            .flat_map(|from| inwards().map(|to| (from.2, to.2)))
            .filter(|&(from, to)| !comes_apart(triangles[from], triangles[to]))
            .map(|(from, to)| {
                let [a, b] = [from, to].map(|index| triangles[index]);
                let is_other = geometry.mesh_of(a) != geometry.mesh_of(b);
                (is_other, angle(geometry, edge[0].0, a, b), from, to)
            })
            .collect();
        joints.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut joined = HashSet::new();
        for (_, _, from, to) in joints {
            if !joined.contains(&from) && !joined.contains(&to) {
                joined.extend([from, to]);
                join(from, to);
            }
        }
    }
    let mut groups: HashMap<usize, Vec<u32>> = HashMap::new();
    for (&group, &triangle) in group.iter().zip(triangles) {
        groups.entry(group).or_default().push(triangle);
    }
    groups.into_values().collect()
}

/// The angle inside of the solid that two triangles enclose at their common edge, which ends at `end`.
fn angle(geometry: &Geometry, end: Place, a: u32, b: u32) -> f64 {
    let normal = |triangle: u32| {
        let [a, b, c] = corners(geometry, triangle);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let middle = |triangle: u32| corners(geometry, triangle).iter().sum::<DVec3>() / 3.0;
    let end = Vec3::from_array(end.map(f32::from_bits)).as_dvec3();
    let (first, second) = (normal(a), normal(b));
    // Whether the second triangle is behind the first one: a convex edge.
    let behind = first.dot(middle(b) - end);
    let bend = first.dot(second).clamp(-1.0, 1.0).acos();
    if behind <= 0.0 && bend < 3.1 { std::f64::consts::PI - bend } else { std::f64::consts::PI + bend }
}
