//! Bounding-volume hierarchies: one builder of binary trees, and the two node formats derived from them.
//! A backend uses the format that suits its hardware, without depending on another backend.
//!
//! - `simd`: eight `f32` boxes per node for the vector units of a CPU, with its traversal
//!   ([`Accel`]).
//! - `compressed`: eight boxes in 80 bytes for a GPU ([`CompressedTree`]); the traversal is the
//!   backend's shader.

mod binary;
mod chunked;
mod compressed;
mod concat;
mod cut;
mod regions;
mod shallow;
mod simd;

pub use binary::{Binary, BinaryTree};
pub use compressed::{CompressedNode, CompressedTree};
pub use simd::{Accel, BruteForce};

use photon_core::memory::{self, OutOfMemory};
use photon_core::parallel;

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
    /// There is not enough memory to build it.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// Upper bound on the memory for building a tree, bytes per triangle; most of it is allocated by obvhs, which aborts the
/// process where there is none.
const BYTES: u64 = 512;

/// Largest coordinate magnitude: beyond it, padding for a unit box no longer covers rounding errors.
const LIMIT: f32 = 16.0;

/// Elements that a thread checks at a time.
const PART: usize = 1 << 16;

fn check(positions: &[[f32; 3]], triangles: &[[u32; 3]], threads: usize) -> Result<(), AccelError> {
    if triangles.len() >= 1 << 31 {
        return Err(AccelError::TooMany { count: triangles.len() });
    }
    memory::check(BYTES * triangles.len() as u64, "building a BVH")?;
    let count = positions.len();
    let outside = |corners: &[u32; 3]| corners.iter().find(|&&vertex| vertex as usize >= count).copied();
    let found =
        parallel::map(threads, triangles.chunks(PART), |_, part| part.iter().position(|t| outside(t).is_some()));
    let first = |found: Vec<Option<usize>>| (0..).zip(found).find_map(|(part, at)| at.map(|at| part * PART + at));
    if let Some(triangle) = first(found) {
        let vertex = outside(&triangles[triangle]).unwrap_or_default();
        return Err(AccelError::OutOfRange { triangle, vertex, count });
    }
    let sane = |position: &[f32; 3]| position.iter().all(|c| c.abs() <= LIMIT);
    let found = parallel::map(threads, positions.chunks(PART), |_, part| part.iter().position(|at| !sane(at)));
    match first(found) {
        Some(vertex) => Err(AccelError::NotNormalised { vertex, position: positions[vertex] }),
        None => Ok(()),
    }
}
