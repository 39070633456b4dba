//! Collapses the binary tree to the wide tree of least expected cost: chooses the nodes that stay and the
//! triangles that share a leaf, by dynamic programming (Ylitie, Karras and Laine 2017, section 4.1).

use bytemuck::allocation::zeroed_vec;
use photon_core::parallel;

use crate::bvh::Binary;
use crate::bvh::regions::Regions;

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

/// Costs of the forests that replace a node, and the number of its triangles.
#[derive(Clone, Copy, Default)]
struct Costs {
    costs: [f32; MAX_CHILDREN],
    count: u32,
}

/// A node whose children are known.
fn solve(node: &Binary, children: Option<[&Costs; 2]>, leaf: u32) -> ([u8; MAX_CHILDREN], Costs) {
    let area = area(node);
    let Some([a, b]) = children else {
        let costs = [area * node.count as f32 * TRIANGLE; MAX_CHILDREN];
        return ([NONE; MAX_CHILDREN], Costs { costs, count: node.count });
    };
    let count = a.count + b.count;
    // The best share of `places` slots for the first child.
    let best = |places: usize| {
        (1..places)
            .filter(|&first| first <= MAX_CHILDREN && places - first <= MAX_CHILDREN)
            .map(|first| (first as u8, a.costs[first - 1] + b.costs[places - first - 1]))
            .fold((NONE, f32::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    };
    let (first, below) = best(MAX_CHILDREN + 1);
    let mut costs = [below + area; MAX_CHILDREN];
    let mut firsts = [NONE; MAX_CHILDREN];
    firsts[0] = first;
    let as_leaf = area * count as f32 * TRIANGLE;
    if count <= leaf && as_leaf < costs[0] {
        costs[0] = as_leaf;
        firsts[0] = NONE;
    }
    for places in 2..=MAX_CHILDREN {
        let (first, cost) = best(places);
        if cost < costs[places - 2] {
            (firsts[places - 1], costs[places - 1]) = (first, cost);
        } else {
            costs[places - 1] = costs[places - 2];
        }
    }
    (firsts, Costs { costs, count })
}

impl Collapse {
    /// The cheapest tree with leaves of up to `leaf` triangles.
    pub(crate) fn of(tree: &Regions, leaf: u32, threads: usize) -> Self {
        let mut firsts: Vec<[u8; MAX_CHILDREN]> = zeroed_vec(tree.nodes.len());
        let (top, mut below) = firsts.split_at_mut(tree.top);
        let mut tasks = Vec::with_capacity(tree.regions.len());
        for (root, range) in &tree.regions {
            let (part, rest) = below.split_at_mut(range.len());
            below = rest;
            tasks.push((*root, range.start, part));
        }
        let solved = parallel::map(threads, tasks.into_iter(), |_, (root, start, part)| {
            let nodes = &tree.nodes[start..start + part.len()];
            // Children come after their parents.
            let mut costs = vec![Costs::default(); nodes.len()];
            let children = |node: &Binary, costs: &[Costs]| {
                let first = node.first as usize - start;
                [costs[first], costs[first + 1]]
            };
            for (i, node) in nodes.iter().enumerate().rev() {
                let children = (node.count == 0).then(|| children(node, &costs));
                (part[i], costs[i]) = solve(node, children.as_ref().map(|[a, b]| [a, b]), leaf);
            }
            let node = &tree.nodes[root as usize];
            let [a, b] = children(node, &costs);
            (root, solve(node, Some([&a, &b]), leaf))
        });
        let mut costs = vec![Costs::default(); tree.top];
        let mut known = vec![false; tree.top];
        for (root, solution) in solved {
            (top[root as usize], costs[root as usize]) = solution;
            known[root as usize] = true;
        }
        for i in (0..tree.top).rev().filter(|&i| !known[i]) {
            let node = &tree.nodes[i];
            let first = node.first as usize;
            let children = (node.count == 0).then(|| [costs[first], costs[first + 1]]);
            (top[i], costs[i]) = solve(node, children.as_ref().map(|[a, b]| [a, b]), leaf);
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

fn area(node: &Binary) -> f32 {
    let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| node.high[axis] - node.low[axis]);
    x * y + y * z + z * x
}
