//! Bounding-volume hierarchies: one builder of binary trees, and the two node formats that are made of
//! them. A backend takes the format that suits its hardware; none needs another backend for it.
//!
//! - `simd`: eight boxes of `f32` side by side for the vector units of a processor, and the traversal
//!   ([`Accel`]).
//! - `compressed`: eight boxes in 80 bytes for a GPU ([`CompressedTree`]); the traversal is the
//!   backend's shader.

mod binary;
mod compressed;
mod simd;

pub use binary::{Binary, BinaryTree};
pub use compressed::{CompressedNode, CompressedTree};
pub use simd::{Accel, BruteForce};

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

/// Beyond this, padding for a unit box no longer covers rounding.
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
