//! Binary trees in an order in which several threads can work on them.

use std::collections::VecDeque;
use std::ops::Range;

use photon_core::parallel;

use super::binary::Binary;
use super::chunked;
use super::concat::{concat, starts};

/// Regions of a large tree.
const REGIONS: usize = 512;

/// The nodes of a tree, ordered so that children come after their parents, and those below each of some nodes are
/// contiguous.
pub(crate) struct Regions {
    /// The top, then one region after another.
    pub(crate) nodes: Vec<Binary>,
    /// Number of nodes in the top.
    pub(crate) top: usize,
    /// A node of the top, and the places of all nodes below it. Not empty.
    pub(crate) regions: Vec<(u32, Range<usize>)>,
}

impl Regions {
    /// Orders a tree. A small one has one region, below its root.
    pub(crate) fn of(nodes: &[Binary], threads: usize) -> Self {
        let most = if nodes.len() < chunked::MANY { 1 } else { REGIONS };
        let mut top = vec![nodes[0]];
        let mut open = VecDeque::from([0_u32]);
        let mut leaves = 0;
        // From the root, level by level. Leaves are put back, since they have to be counted once.
        while leaves < open.len()
            && open.len() < most
            && let Some(at) = open.pop_front()
        {
            let node = top[at as usize];
            if node.count > 0 {
                leaves += 1;
                open.push_back(at);
                continue;
            }
            leaves = 0;
            let first = top.len() as u32;
            top[at as usize].first = first;
            top.extend([nodes[node.first as usize], nodes[node.first as usize + 1]]);
            open.extend([first, first + 1]);
        }
        let roots: Vec<u32> = open.into_iter().filter(|&at| top[at as usize].count == 0).collect();
        let parts = parallel::map(threads, roots.iter(), |_, &root| below(nodes, &top[root as usize]));
        let begin = starts(top.len(), parts.iter().map(Vec::len));
        let parts: Vec<&[Binary]> = parts.iter().map(Vec::as_slice).collect();
        let mut ordered = concat(&top, &parts, threads, |part, node| {
            if node.count == 0 { Binary { first: node.first + begin[part], ..node } } else { node }
        });
        let mut regions = Vec::with_capacity(roots.len());
        for ((&root, &start), part) in roots.iter().zip(&begin).zip(&parts) {
            ordered[root as usize].first = start;
            regions.push((root, start as usize..start as usize + part.len()));
        }
        Self { nodes: ordered, top: top.len(), regions }
    }
}

/// The nodes below one, its children first, by indices among themselves.
fn below(nodes: &[Binary], root: &Binary) -> Vec<Binary> {
    let pair = |node: &Binary| [nodes[node.first as usize], nodes[node.first as usize + 1]];
    let mut found = pair(root).to_vec();
    let mut open = vec![1, 0];
    while let Some(at) = open.pop() {
        let node: Binary = found[at];
        if node.count == 0 {
            let first = found.len();
            found[at].first = first as u32;
            found.extend(pair(&node));
            open.extend([first + 1, first]);
        }
    }
    found
}
