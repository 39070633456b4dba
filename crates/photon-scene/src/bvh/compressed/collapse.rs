//! Collapses the binary tree to the wide tree of least expected cost: chooses the nodes that stay and the
//! triangles that share a leaf, by dynamic programming (Ylitie, Karras and Laine 2017, section 4.1).

use crate::bvh::Binary;

/// Cost of a triangle test, relative to testing a node of eight boxes.
const TRIANGLE: f32 = 0.3;
/// The two subtrees of a node share eight child slots; each gets one to seven.
const MAX_CHILDREN: usize = 7;
/// No split: use as few slots as the entry before; or, in the first entry, make a leaf.
const NONE: u8 = u8::MAX;

/// For each binary node, how it is best replaced by a forest of 1, of up to 2, … up to 7 trees: the
/// number of these trees that come from its first child.
#[derive(Debug)]
pub(crate) struct Collapse {
    /// Entry 0: how many of eight slots the first child gets, where the node is a tree by itself.
    firsts: Vec<[u8; MAX_CHILDREN]>,
}

impl Collapse {
    /// The cheapest tree with leaves of up to `leaf` triangles.
    pub(crate) fn of(nodes: &[Binary], leaf: u32) -> Self {
        let mut firsts = vec![[NONE; MAX_CHILDREN]; nodes.len()];
        let mut costs = vec![[0.0_f32; MAX_CHILDREN]; nodes.len()];
        let mut counts = vec![0_u32; nodes.len()];
        for &index in parents_first(nodes).iter().rev() {
            let index = index as usize;
            let node = &nodes[index];
            let area = area(node);
            if node.count > 0 {
                counts[index] = node.count;
                costs[index] = [area * node.count as f32 * TRIANGLE; MAX_CHILDREN];
                continue;
            }
            let (a, b) = (node.first as usize, node.first as usize + 1);
            counts[index] = counts[a] + counts[b];
            // The best share of `places` slots for the first child.
            let best = |places: usize| {
                (1..places)
                    .filter(|&first| first <= MAX_CHILDREN && places - first <= MAX_CHILDREN)
                    .map(|first| (first as u8, costs[a][first - 1] + costs[b][places - first - 1]))
                    .fold((NONE, f32::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
            };
            let (first, below) = best(MAX_CHILDREN + 1);
            let mut own = [below + area; MAX_CHILDREN];
            let mut shares = [NONE; MAX_CHILDREN];
            shares[0] = first;
            let as_leaf = area * counts[index] as f32 * TRIANGLE;
            if counts[index] <= leaf && as_leaf < own[0] {
                own[0] = as_leaf;
                shares[0] = NONE;
            }
            for places in 2..=MAX_CHILDREN {
                let (first, cost) = best(places);
                if cost < own[places - 2] {
                    (shares[places - 1], own[places - 1]) = (first, cost);
                } else {
                    own[places - 1] = own[places - 2];
                }
            }
            (firsts[index], costs[index]) = (shares, own);
        }
        Self { firsts }
    }

    /// Whether a child of a wide node becomes a leaf.
    pub(crate) fn is_leaf(&self, index: u32) -> bool {
        self.firsts[index as usize][0] == NONE
    }

    /// The up to eight children of the wide node that replaces the binary node `root`.
    pub(crate) fn children(&self, nodes: &[Binary], root: u32) -> Vec<u32> {
        if self.is_leaf(root) {
            // Only if the whole tree is one leaf.
            return vec![root];
        }
        let first = self.firsts[root as usize][0];
        let below = nodes[root as usize].first;
        let mut children = Vec::with_capacity(MAX_CHILDREN + 1);
        self.forest(nodes, below, first, &mut children);
        self.forest(nodes, below + 1, MAX_CHILDREN as u8 + 1 - first, &mut children);
        children
    }

    /// Appends the up to `places` trees that replace a node; the recursion is never deeper than `places`.
    fn forest(&self, nodes: &[Binary], index: u32, mut places: u8, to: &mut Vec<u32>) {
        let shares = &self.firsts[index as usize];
        while places > 1 && shares[places as usize - 1] == NONE {
            places -= 1;
        }
        if places == 1 {
            to.push(index);
            return;
        }
        let first = shares[places as usize - 1];
        let below = nodes[index as usize].first;
        self.forest(nodes, below, first, to);
        self.forest(nodes, below + 1, places - first, to);
    }

    /// Appends the triangles of a leaf.
    pub(crate) fn triangles(&self, nodes: &[Binary], order: &[u32], leaf: u32, to: &mut Vec<u32>) {
        let mut open = vec![leaf];
        while let Some(index) = open.pop() {
            let node = &nodes[index as usize];
            if node.count == 0 {
                open.extend([node.first + 1, node.first]);
            } else {
                to.extend_from_slice(&order[node.first as usize..(node.first + node.count) as usize]);
            }
        }
    }
}

/// All nodes, each before its descendants. Iterative, since a tree may be deep.
fn parents_first(nodes: &[Binary]) -> Vec<u32> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut open = vec![0_u32];
    while let Some(index) = open.pop() {
        order.push(index);
        let node = &nodes[index as usize];
        if node.count == 0 {
            open.extend([node.first + 1, node.first]);
        }
    }
    order
}

fn area(node: &Binary) -> f32 {
    let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| node.high[axis] - node.low[axis]);
    x * y + y * z + z * x
}
