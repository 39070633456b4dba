//! The shape of the photon kd-trees, on which backends agree so that they build the same trees.

/// Maximum number of photons in a leaf, and of children of a node.
pub const WIDTH: u32 = 16;

/// Flag of a leaf, in the word that otherwise holds a count or an index.
pub const LEAF: u32 = 1 << 31;

/// Maximum depth of a tree, counted in nodes from the root to a leaf; at most one node per level waits on the
/// stack of a traversal.
pub const MAX_DEPTH: u32 = 64;

/// Slabs per voxel in the Voxel Volume Heuristic; the candidate planes lie between them.
pub const SLABS: u32 = 32;

/// Maximum number of photons of a voxel that the heuristic counts.
pub const SAMPLE: u32 = 64;

/// Below this depth, voxels are split at the median. Adversarial photons could make the heuristic split off
/// leaf after leaf; 24 levels of it and at most 28 levels of medians stay below [`MAX_DEPTH`].
pub const HEURISTIC_DEPTH: u32 = 24;

/// Bits of a Morton code per axis.
pub const MORTON_BITS: u32 = 21;
