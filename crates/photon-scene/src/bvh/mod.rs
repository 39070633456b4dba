//! Bounding-volume hierarchies: one builder of binary trees, and the two node formats derived from them.
//! A backend uses the format that suits its hardware, without depending on another backend.
//!
//! - `simd`: eight `f32` boxes per node for the vector units of a CPU, with its traversal
//!   ([`Accel`]).
//! - `compressed`: eight boxes in 80 bytes for a GPU ([`CompressedTree`]); the traversal is the
//!   backend's shader.

mod binary;
mod compressed;
mod shallow;
mod simd;

pub use binary::{Binary, BinaryTree};
pub use compressed::{CompressedNode, CompressedTree};
pub use simd::{Accel, BruteForce};

/// Why a tree cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccelError {
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {count}")]
    OutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex index it holds.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A coordinate is not finite, or far outside the unit box of normalised space.
    #[error("vertex {vertex} lies at {position:?}: bring the scene to a unit box about the origin first")]
    NotNormalised {
        /// Index of the vertex.
        vertex: usize,
        /// Its position.
        position: [f32; 3],
    },
    /// More triangles than indices can address.
    #[error("{count} triangles are more than 2^31: split the scene")]
    TooMany {
        /// Number of triangles.
        count: usize,
    },
}

/// Largest coordinate magnitude: beyond it, padding for a unit box no longer covers rounding errors.
const LIMIT: f32 = 16.0;

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
