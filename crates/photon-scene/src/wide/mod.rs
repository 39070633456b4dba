//! The ray caster: a tree of eight-wide nodes over watertight packets of triangles.
//!
//! obvhs builds a binary tree over padded boxes; traversal and the triangle test are ours. No test
//! has an absolute epsilon: boxes are entered unless they are surely missed, and a ray that meets an
//! edge or a vertex hits one of the triangles there.

mod build;
mod node;
mod traverse;
mod triangle;

use photon_core::{Hit, Ray, RayCaster};

pub use node::Binary;

use node::Node;
use triangle::Packet;

/// What keeps a tree from being built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccelError {
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {count}")]
    OutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The index.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A coordinate is not finite, or far outside the unit box that scenes are brought to.
    #[error("vertex {vertex} lies at {position:?}: bring the scene to a unit box about the origin first")]
    NotNormalised {
        /// Which vertex.
        vertex: usize,
        /// Where it lies.
        position: [f32; 3],
    },
    /// More triangles than an index can number.
    #[error("{count} triangles are more than 2^31: split the scene")]
    TooMany {
        /// How many there are.
        count: usize,
    },
}

/// The ray caster of scenes in normalised space.
#[derive(Debug)]
pub struct Accel {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
}

/// Beyond this, padding for a unit box no longer covers rounding.
const LIMIT: f32 = 16.0;

impl Accel {
    /// Builds the tree. The same triangles give the same tree, on any number of threads.
    ///
    /// # Errors
    /// [`AccelError`] names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        let boxes = padded(positions, triangles)?;
        let corners = |id: u32| triangles[id as usize].map(|vertex| positions[vertex as usize]);
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), packets: Vec::new() });
        }
        let (binary, order) = build::tree(&boxes, triangle::LANES);
        let (nodes, packets, depth) = node::widen(&binary, &order, &corners);
        if depth <= traverse::MAX_DEPTH {
            return Ok(Self { nodes, packets });
        }
        // A tree too deep for the stack of a traversal; a median split never is.
        let (binary, order) = build::balanced(&boxes, triangle::LANES);
        let (nodes, packets, _) = node::widen(&binary, &order, &corners);
        Ok(Self { nodes, packets })
    }
}

/// A binary tree over padded boxes about triangles, for those who arrange it in their own way.
#[derive(Debug)]
pub struct BinaryTree {
    /// The root first; none where there are no triangles.
    pub nodes: Vec<Binary>,
    /// Indices of triangles, in the order that leaves refer to.
    pub order: Vec<u32>,
}

impl BinaryTree {
    /// The tree with the least expected cost that obvhs finds, with up to `leaf` ≥ 1 triangles in a
    /// leaf. It may be deep.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]], leaf: usize) -> Result<Self, AccelError> {
        Self::by(build::tree, positions, triangles, leaf)
    }

    /// Split at medians: never deeper than the logarithm of the count, rounded up, and 1.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn balanced(positions: &[[f32; 3]], triangles: &[[u32; 3]], leaf: usize) -> Result<Self, AccelError> {
        Self::by(build::balanced, positions, triangles, leaf)
    }

    fn by(
        build: fn(&[build::Padded], usize) -> build::Arranged,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        leaf: usize,
    ) -> Result<Self, AccelError> {
        let boxes = padded(positions, triangles)?;
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), order: Vec::new() });
        }
        let (nodes, order) = build(&boxes, leaf.max(1));
        Ok(Self { nodes, order })
    }
}

fn padded(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Vec<build::Padded>, AccelError> {
    check(positions, triangles)?;
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
    Ok(triangles.iter().map(|triangle| build::Padded::around(corners(triangle))).collect())
}

fn check(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), AccelError> {
    if triangles.len() >= 1 << 31 {
        return Err(AccelError::TooMany { count: triangles.len() });
    }
    let count = positions.len();
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(AccelError::OutOfRange { triangle, vertex, count });
        }
    }
    let sane = |position: &[f32; 3]| position.iter().all(|c| c.abs() <= LIMIT);
    match positions.iter().position(|position| !sane(position)) {
        Some(vertex) => Err(AccelError::NotNormalised { vertex, position: positions[vertex] }),
        None => Ok(()),
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
