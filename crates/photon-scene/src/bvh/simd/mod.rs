//! The CPU ray caster: a BVH of eight-wide nodes over packets of triangles, with a watertight test.
//!
//! obvhs builds a binary tree over padded boxes; traversal and the triangle test are our own. No test
//! has an absolute epsilon: boxes are entered unless they are certainly missed, and a ray that hits an
//! edge or a vertex hits one of the adjacent triangles.

mod node;
mod overlap;
mod slabs;
mod traverse;
mod triangle;

use photon_core::glam::Vec3;
use photon_core::{Hit, Ray, RayCaster, SkipLimit, parallel};

use super::{AccelError, binary, check, shallow};
use node::Node;
use traverse::All;
use triangle::Packet;

/// Ray caster for scenes in normalised space.
#[derive(Debug, PartialEq)]
pub struct Accel {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
}

impl Accel {
    /// Builds the tree by all cores. It does not depend on their number.
    ///
    /// # Errors
    /// [`AccelError`], which names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        Self::build_by(positions, triangles, parallel::threads())
    }

    /// As [`Self::build`], by at most `threads` threads, the calling one among them. Those that it starts have ended when it
    /// returns.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_by(positions: &[[f32; 3]], triangles: &[[u32; 3]], threads: usize) -> Result<Self, AccelError> {
        let boxes = binary::padded(positions, triangles, threads)?;
        let corners = |id: u32| triangles[id as usize].map(|vertex| positions[vertex as usize]);
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), packets: Vec::new() });
        }
        let tree = binary::tree(&boxes, triangle::LANES, threads);
        // Some trees are too deep for the traversal stack.
        Ok(shallow::first_fitting(&tree, &boxes, triangle::LANES, threads, |tree| {
            let (nodes, packets, depth) = node::widen(tree, &corners, threads);
            (Self { nodes, packets }, depth <= traverse::MAX_DEPTH)
        }))
    }
}

impl RayCaster for Accel {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        traverse::nearest(&self.nodes, &self.packets, ray, All)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        traverse::occluded(&self.nodes, &self.packets, ray, All)
    }

    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        Ok(traverse::nearest(&self.nodes, &self.packets, ray, keep))
    }

    fn occluded_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<bool, SkipLimit> {
        Ok(traverse::occluded(&self.nodes, &self.packets, ray, keep))
    }

    fn overlapping<'a>(&self, low: Vec3, high: Vec3, room: &'a mut [u32]) -> Option<&'a [u32]> {
        overlap::overlapping(&self.nodes, &self.packets, (low, high), room)
    }

    fn bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())) as u64
    }
}

/// Tests every triangle against every ray with the same triangle test: the reference for [`Accel`].
#[derive(Debug)]
pub struct BruteForce {
    packets: Vec<Packet>,
}

impl BruteForce {
    /// Stores the triangles.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        check(positions, triangles, 1)?;
        let corners = |id: u32| triangles[id as usize].map(|vertex| positions[vertex as usize]);
        let ids: Vec<u32> = (0..triangles.len() as u32).collect();
        let packets = ids.chunks(triangle::LANES).map(|ids| Packet::of(ids, &corners)).collect();
        Ok(Self { packets })
    }
}

impl RayCaster for BruteForce {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        traverse::brute_force(&self.packets, ray, All)
    }

    fn nearest_where(&self, ray: &Ray, keep: &dyn Fn(&Hit) -> bool) -> Result<Option<Hit>, SkipLimit> {
        Ok(traverse::brute_force(&self.packets, ray, keep))
    }
}

#[cfg(test)]
mod tests;
