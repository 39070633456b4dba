//! Construction of binary BVHs: by obvhs, or by a plain median split where obvhs would degenerate.

use bytemuck::Zeroable;
use bytemuck::allocation::zeroed_vec;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams};
use photon_core::parallel;

use super::{AccelError, check, chunked};

/// From this many primitives with identical boxes on, obvhs builds a list instead of a tree.
const TWINS: usize = 64;

/// A node of a binary tree, as both builders produce it.
#[derive(Clone, Copy, Debug, PartialEq, Zeroable)]
#[non_exhaustive]
pub struct Binary {
    /// Lower corner of the bounding box.
    pub low: [f32; 3],
    /// Upper corner of the bounding box.
    pub high: [f32; 3],
    /// Leaf: index of its first primitive. Inner node: index of the first of two adjacent children.
    pub first: u32,
    /// Number of primitives; 0 for an inner node.
    pub count: u32,
}

/// A binary tree over padded triangle bounds, from which backends derive their own node formats.
#[derive(Debug)]
#[non_exhaustive]
pub struct BinaryTree {
    /// The root first; empty without triangles.
    pub nodes: Vec<Binary>,
    /// Triangle indices, in the order that leaves refer to.
    pub order: Vec<u32>,
}

impl BinaryTree {
    /// Builds a low-cost tree (surface area heuristic, by obvhs) with up to `leaf` ≥ 1 triangles per
    /// leaf. It may be deep. All cores build it; it does not depend on their number.
    ///
    /// # Errors
    /// [`AccelError`], which names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]], leaf: usize) -> Result<Self, AccelError> {
        Self::by(|boxes, leaf| tree(boxes, leaf, parallel::threads()), positions, triangles, leaf)
    }

    /// Builds by median splits: the depth is at most the logarithm of the count, rounded up, plus 1.
    ///
    /// # Errors
    /// [`AccelError`], which names the triangle or the vertex.
    pub fn balanced(positions: &[[f32; 3]], triangles: &[[u32; 3]], leaf: usize) -> Result<Self, AccelError> {
        Self::by(balanced, positions, triangles, leaf)
    }

    fn by(
        build: fn(&[Padded], usize) -> Arranged,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        leaf: usize,
    ) -> Result<Self, AccelError> {
        let boxes = padded(positions, triangles, parallel::threads())?;
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), order: Vec::new() });
        }
        let (nodes, order) = build(&boxes, leaf.max(1));
        Ok(Self { nodes, order })
    }
}

/// Nodes, and the order of primitives that leaves refer to.
pub(crate) type Arranged = (Vec<Binary>, Vec<u32>);

/// A padded bounding box, in the form that obvhs takes.
#[derive(Clone, Copy, Debug, Zeroable)]
pub(crate) struct Padded {
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
}

impl Padded {
    /// Bounds of a triangle, padded by more than the rounding errors of the triangle test within a unit box.
    pub(crate) fn around(corners: [[f32; 3]; 3]) -> Self {
        const ULPS: f32 = 8.0 * f32::EPSILON;
        let mut padded = Self { low: corners[0], high: corners[0] };
        for corner in corners {
            for axis in 0..3 {
                padded.low[axis] = padded.low[axis].min(corner[axis]);
                padded.high[axis] = padded.high[axis].max(corner[axis]);
            }
        }
        for axis in 0..3 {
            padded.low[axis] -= ULPS * (1.0 + padded.low[axis].abs());
            padded.high[axis] += ULPS * (1.0 + padded.high[axis].abs());
        }
        padded
    }

    /// The bits of all bounds.
    fn key(&self) -> [u32; 6] {
        let [x, y, z] = self.low.map(f32::to_bits);
        let [u, v, w] = self.high.map(f32::to_bits);
        [x, y, z, u, v, w]
    }
}

impl Boundable for Padded {
    fn aabb(&self) -> Aabb {
        Aabb { min: obvhs_vec(self.low), max: obvhs_vec(self.high) }
    }
}

pub(crate) fn obvhs_vec(v: [f32; 3]) -> glam::Vec3A {
    v.into()
}

/// Triangles that a thread takes at a time.
const PART: usize = 1 << 15;

/// A padded bounding box for each triangle.
pub(crate) fn padded(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    threads: usize,
) -> Result<Vec<Padded>, AccelError> {
    check(positions, triangles, threads)?;
    let mut boxes: Vec<Padded> = zeroed_vec(triangles.len());
    parallel::for_each(threads, boxes.chunks_mut(PART).zip(triangles.chunks(PART)), |_, (boxes, triangles)| {
        for (padded, triangle) in boxes.iter_mut().zip(triangles) {
            *padded = Padded::around(triangle.map(|vertex| positions[vertex as usize]));
        }
    });
    Ok(boxes)
}

/// A binary tree over `boxes`, root first, and the order of primitives that its leaves refer to, the same for any number of
/// threads. Leaves hold at most `leaf` primitives.
pub(crate) fn tree(boxes: &[Padded], leaf: usize, threads: usize) -> Arranged {
    if boxes.len() < chunked::MANY { single(boxes, leaf) } else { chunked::tree(boxes, leaf, threads) }
}

/// As [`tree`], by one thread and as a whole.
pub(crate) fn single(boxes: &[Padded], leaf: usize) -> Arranged {
    if boxes.len() <= leaf || has_twins(boxes) {
        return balanced(boxes, leaf);
    }
    let built = build_bvh2(boxes, parameters(leaf), &mut std::time::Duration::default());
    (binary(&built), built.primitive_indices)
}

/// As [`single`], for a part of a scene: primitives are sorted within a cube. Within its own bounds, the order in a nearly
/// flat part would depend on its unevenness.
pub(crate) fn part(boxes: &[Padded], leaf: usize) -> Arranged {
    if boxes.len() <= leaf || has_twins(boxes) {
        return balanced(boxes, leaf);
    }
    let parameters = parameters(leaf);
    let mut bounds = boxes.iter().fold(Aabb::empty(), |bounds, padded| bounds.union(&padded.aabb()));
    bounds.max = bounds.min + glam::Vec3A::splat(bounds.diagonal().max_element());
    let mut builder = PlocBuilder::new();
    builder.current_nodes = (0..).zip(boxes).map(|(id, padded)| Bvh2Node::new(padded.aabb(), 1, id)).collect();
    let mut tree = Bvh2::zeroed(boxes.len());
    tree.reset_for_reuse(boxes.len(), Some((0..boxes.len() as u32).collect()));
    // The search distance and the steps of `build_bvh2` with these parameters.
    builder.build_ploc_from_leaves::<14, false>(
        &mut tree,
        bounds,
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    let ratio = parameters.reinsertion_batch_ratio;
    optimizer.run(&mut tree, ratio, None);
    collapse(&mut tree, parameters.max_prims_per_leaf, parameters.collapse_traversal_cost);
    optimizer.run(&mut tree, ratio * parameters.post_collapse_reinsertion_batch_ratio_multiplier, None);
    (binary(&tree), tree.primitive_indices)
}

fn parameters(leaf: usize) -> BvhBuildParams {
    BvhBuildParams { max_prims_per_leaf: leaf as u32, ..BvhBuildParams::medium_build() }
}

/// Converts the nodes of an obvhs tree.
fn binary(tree: &Bvh2) -> Vec<Binary> {
    tree.nodes
        .iter()
        .map(|node| {
            let aabb = node.aabb();
            let (low, high) = (aabb.min.to_array(), aabb.max.to_array());
            Binary { low, high, first: node.first_index, count: node.prim_count }
        })
        .collect()
}

/// Whether [`TWINS`] boxes are identical. Identical boxes have the same hash, so that boxes are sorted only if that many
/// of them share one.
fn has_twins(boxes: &[Padded]) -> bool {
    let bits = boxes.len().max(1).ilog2() + 1;
    is_crowded(boxes, bits) && {
        let mut keys: Vec<[u32; 6]> = boxes.iter().map(Padded::key).collect();
        keys.sort_unstable();
        keys.windows(TWINS).any(|run| run[0] == run[TWINS - 1])
    }
}

/// Whether the hashes of [`TWINS`] boxes have the same first `bits` ≥ 1 bits.
fn is_crowded(boxes: &[Padded], bits: u32) -> bool {
    let mut counts = vec![0_u8; 1 << bits];
    boxes.iter().any(|padded| {
        // The multiplicative hash of the Rust compiler; its high bits depend on all bits of the key.
        let mix = |hash: u64, word: u32| (hash.rotate_left(5) ^ u64::from(word)).wrapping_mul(0x517c_c1b7_2722_0a95);
        let count = &mut counts[(padded.key().into_iter().fold(0, mix) >> (64 - bits)) as usize];
        *count += 1;
        usize::from(*count) == TWINS
    })
}

/// Splits at the median of the widest axis: the depth is at most the logarithm of the count.
pub(crate) fn balanced(boxes: &[Padded], leaf: usize) -> Arranged {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let blank = Binary { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], first: 0, count: 0 };
    let mut nodes = vec![blank];
    let mut open = vec![(0_usize, 0_usize, boxes.len())];
    while let Some((place, from, to)) = open.pop() {
        let mut node = blank;
        for &id in &order[from..to] {
            for axis in 0..3 {
                node.low[axis] = node.low[axis].min(boxes[id as usize].low[axis]);
                node.high[axis] = node.high[axis].max(boxes[id as usize].high[axis]);
            }
        }
        if to - from <= leaf {
            node.first = from as u32;
            node.count = (to - from) as u32;
        } else {
            let middle = (from + to) / 2;
            let extent: [f32; 3] = std::array::from_fn(|axis| node.high[axis] - node.low[axis]);
            let axis = (0..3).max_by(|&i, &j| extent[i].total_cmp(&extent[j])).unwrap_or(0);
            let center = |id: u32| boxes[id as usize].low[axis] + boxes[id as usize].high[axis];
            order[from..to]
                .select_nth_unstable_by(middle - from, |&a, &b| center(a).total_cmp(&center(b)).then(a.cmp(&b)));
            node.first = nodes.len() as u32;
            nodes.extend([blank, blank]);
            open.push((nodes.len() - 2, from, middle));
            open.push((nodes.len() - 1, middle, to));
        }
        nodes[place] = node;
    }
    (nodes, order)
}

#[cfg(test)]
mod tests;
