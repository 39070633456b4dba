//! Search for triangles that may touch others, by boxes: most scenes have few.

use glam::Vec3;
use photon_core::{offset, parallel};

use super::Source;
use crate::normalise::Geometry;

/// More meshes than this are not compared with each other before their triangles are.
const FEW: usize = 512;

impl Source<'_> {
    /// Triangles that may touch others: those of solids, and those near another mesh.
    pub(super) fn candidates(&self, geometry: &Geometry) -> Vec<u32> {
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
}
