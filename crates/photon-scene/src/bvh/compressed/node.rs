//! One node in 80 bytes, in the layout that intersect.glsl reads.

use crate::bvh::Binary;
use bytemuck::{Pod, Zeroable};

/// Number of children.
const WIDTH: usize = 8;

/// Eight children; their boxes are quantized in power-of-two steps from the lower corner of the parent's box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CompressedNode {
    corner: [f32; 3],
    /// Biased exponents of the step sizes along x, y, z.
    exponents: [u8; 3],
    /// Bit mask of the children that are inner nodes.
    nodes: u8,
    first_child: u32,
    first_triangle: u32,
    /// 0 for an empty slot; `001 11sss` for an inner node in slot s; otherwise a leaf: its triangle count in
    /// unary from bit 5 on, and in the lower bits the offset of its first triangle from `first_triangle`.
    meta: [u8; WIDTH],
    /// Lower bounds along x, y, z.
    low: [[u8; WIDTH]; 3],
    high: [[u8; WIDTH]; 3],
}

const _: () = assert!(size_of::<CompressedNode>() == 80);

impl CompressedNode {
    /// A node without children yet.
    pub(crate) fn around(bounds: &Binary, first_child: u32, first_triangle: u32) -> Self {
        let exponents = std::array::from_fn(|axis| exponent(bounds.low[axis], bounds.high[axis]));
        Self { corner: bounds.low, exponents, first_child, first_triangle, ..Self::zeroed() }
    }

    /// Stores a leaf of one to three triangles.
    pub(crate) fn put_leaf(&mut self, slot: usize, bounds: &Binary, first: u32, count: u32) {
        debug_assert!((1..=3).contains(&count) && first + count <= 24, "{count} triangles from offset {first}");
        self.meta[slot] = (((1 << count) - 1) << 5) as u8 | first as u8;
        self.put_box(slot, bounds);
    }

    /// Stores an inner node; inner nodes are numbered in order of their slots.
    pub(crate) fn put_node(&mut self, slot: usize, bounds: &Binary) {
        self.meta[slot] = 0x38 | slot as u8;
        self.nodes |= 1 << slot;
        self.put_box(slot, bounds);
    }

    /// The node in a table in which nodes and triangles have been moved.
    pub(crate) fn moved_by(self, nodes: u32, triangles: u32) -> Self {
        let (first_child, first_triangle) = (self.first_child + nodes, self.first_triangle + triangles);
        Self { first_child, first_triangle, ..self }
    }

    /// Stores the quantized box, rounded outward.
    fn put_box(&mut self, slot: usize, bounds: &Binary) {
        for axis in 0..3 {
            let steps = |x: f32| (f64::from(x) - f64::from(self.corner[axis])) / step(self.exponents[axis]);
            self.low[axis][slot] = steps(bounds.low[axis]).floor().clamp(0.0, 255.0) as u8;
            self.high[axis][slot] = steps(bounds.high[axis]).ceil().clamp(0.0, 255.0) as u8;
        }
    }

    /// The box of a child as the shader decodes it, its kind and its index.
    #[cfg(test)]
    pub(crate) fn child(&self, slot: usize) -> Option<Child> {
        let meta = self.meta[slot];
        let at = |axis: usize, steps: u8| f64::from(self.corner[axis]) + f64::from(steps) * step(self.exponents[axis]);
        let low = std::array::from_fn(|axis| at(axis, self.low[axis][slot]));
        let high = std::array::from_fn(|axis| at(axis, self.high[axis][slot]));
        let before = (self.nodes & ((1 << slot) - 1)).count_ones();
        let (first, triangles) = match meta {
            0 => return None,
            _ if self.nodes >> slot & 1 == 1 => (self.first_child + before, 0),
            _ => (self.first_triangle + u32::from(meta & 31), u32::from(meta >> 5).count_ones()),
        };
        Some(Child { low, high, first, triangles })
    }
}

/// A decoded child, for tests.
#[cfg(test)]
#[derive(Debug)]
pub(crate) struct Child {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
    pub(crate) first: u32,
    /// 0 for an inner node.
    pub(crate) triangles: u32,
}

/// The smallest step of which 255 span from `low` to `high`.
fn exponent(low: f32, high: f32) -> u8 {
    let extent = f64::from(high) - f64::from(low);
    let mut exponent = 1_u8;
    while exponent < 254 && step(exponent) * 255.0 < extent {
        exponent += 1;
    }
    exponent
}

/// The step size: 2^(exponent - 127).
fn step(exponent: u8) -> f64 {
    f64::from_bits((u64::from(exponent) + 1023 - 127) << 52)
}

/// Assigns children to slots so that the binary digits of a slot number say on which side of the node the child
/// lies: traversal in the order given by the octant of a ray then visits near children first (section 4.2; greedy,
/// which the authors found almost as good as an auction algorithm).
pub(crate) fn slots(nodes: &[Binary], root: u32, children: &[u32]) -> [Option<u32>; WIDTH] {
    let middle = |index: u32| -> [f32; 3] {
        let node = &nodes[index as usize];
        std::array::from_fn(|axis| 0.5 * (node.low[axis] + node.high[axis]))
    };
    let center = middle(root);
    // Distance of each child from the side of the node that each slot represents.
    let costs: Vec<[f32; WIDTH]> = children
        .iter()
        .map(|&child| {
            let at = middle(child);
            std::array::from_fn(|slot| {
                let along = |axis: usize| {
                    let offset = at[axis] - center[axis];
                    if slot >> (2 - axis) & 1 == 1 { -offset } else { offset }
                };
                along(0) + along(1) + along(2)
            })
        })
        .collect();
    let mut slots = [None; WIDTH];
    let mut open: Vec<usize> = (0..children.len()).collect();
    while !open.is_empty() {
        let free = (0..WIDTH).filter(|&slot| slots[slot].is_none());
        let pairs = free.flat_map(|slot| open.iter().map(move |&child| (slot, child)));
        let cheapest =
            pairs.min_by(|&(s, c), &(t, d)| costs[c][s].total_cmp(&costs[d][t]).then(c.cmp(&d)).then(s.cmp(&t)));
        let Some((slot, child)) = cheapest else { break };
        slots[slot] = Some(children[child]);
        open.retain(|&other| other != child);
    }
    slots
}
