//! The ray caster: a tree of eight-wide nodes over watertight packets of triangles.
//!
//! obvhs builds a binary tree over padded boxes; traversal and the triangle test are ours. No test
//! has an absolute epsilon: boxes are entered unless they are surely missed, and a ray that meets an
//! edge or a vertex hits one of the triangles there.

mod node;
mod traverse;
mod triangle;

use photon_core::{Hit, Ray, RayCaster};

use super::{AccelError, binary, check};
use node::Node;
use triangle::Packet;

/// The ray caster of scenes in normalised space.
#[derive(Debug)]
pub struct Accel {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
}

impl Accel {
    /// Builds the tree. The same triangles give the same tree, on any number of threads.
    ///
    /// # Errors
    /// [`AccelError`] names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        let boxes = binary::padded(positions, triangles)?;
        let corners = |id: u32| triangles[id as usize].map(|vertex| positions[vertex as usize]);
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), packets: Vec::new() });
        }
        let (tree, order) = binary::tree(&boxes, triangle::LANES);
        let (nodes, packets, depth) = node::widen(&tree, &order, &corners);
        if depth <= traverse::MAX_DEPTH {
            return Ok(Self { nodes, packets });
        }
        // A tree too deep for the stack of a traversal; a median split never is.
        let (tree, order) = binary::balanced(&boxes, triangle::LANES);
        let (nodes, packets, _) = node::widen(&tree, &order, &corners);
        Ok(Self { nodes, packets })
    }
}

impl RayCaster for Accel {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        traverse::nearest(&self.nodes, &self.packets, ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        traverse::occluded(&self.nodes, &self.packets, ray)
    }

    fn bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())) as u64
    }
}

/// Every triangle against every ray, by the same test: what [`Accel`] must agree with.
#[derive(Debug)]
pub struct BruteForce {
    packets: Vec<Packet>,
}

impl BruteForce {
    /// Takes the triangles.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        check(positions, triangles)?;
        let corners = |id: u32| triangles[id as usize].map(|vertex| positions[vertex as usize]);
        let ids: Vec<u32> = (0..triangles.len() as u32).collect();
        let packets = ids.chunks(triangle::LANES).map(|ids| Packet::of(ids, &corners)).collect();
        Ok(Self { packets })
    }
}

impl RayCaster for BruteForce {
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        traverse::brute_force(&self.packets, ray)
    }
}

#[cfg(test)]
mod tests;
