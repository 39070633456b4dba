//! Trees that are too deep for the stack of a traversal: only their deep ends are replaced by median splits.

use super::binary::{Arranged, Binary, Padded, balanced};

/// Depths to try for the binary tree, from the one that keeps most of it. Wide trees are shallower, by how much depends on
/// the tree.
pub(crate) const DEPTHS: [u32; 4] = [128, 64, 48, 32];

/// The same tree with at most `most` levels, if median splits have so few: from the root, splits are kept as long as median
/// splits of what is below them would fit.
pub(crate) fn shallow((nodes, order): &Arranged, boxes: &[Padded], leaf: usize, most: u32) -> Option<Arranged> {
    let leaf = leaf.max(1);
    if nodes.is_empty() || levels(boxes.len(), leaf) > most {
        return None;
    }
    let below = Below::of(nodes);
    let mut result: Arranged = (vec![nodes[0]], Vec::with_capacity(order.len()));
    // The place in the tree and in the result, and the levels that are left, with this one.
    let mut open = vec![(0_u32, 0_usize, most)];
    while let Some((from, to, left)) = open.pop() {
        let node = nodes[from as usize];
        let fits = |child: u32| {
            let at = child as usize;
            below.levels[at] < left || levels(below.count[at] as usize, leaf) < left
        };
        if node.count > 0 {
            let first = node.first as usize;
            result.0[to] = Binary { first: result.1.len() as u32, ..node };
            result.1.extend(&order[first..first + node.count as usize]);
        } else if fits(node.first) && fits(node.first + 1) {
            let place = result.0.len();
            result.0[to] = Binary { first: place as u32, ..node };
            result.0.extend([nodes[node.first as usize], nodes[node.first as usize + 1]]);
            open.extend([(node.first, place, left - 1), (node.first + 1, place + 1, left - 1)]);
        } else {
            replace(to, &primitives(nodes, order, from), boxes, leaf, &mut result);
        }
    }
    Some(result)
}

/// What `widen` makes of the first tree that suits it: the given one, shallower ones, or median splits of everything, which
/// always do.
pub(crate) fn first_fitting<T>(
    tree: &Arranged,
    boxes: &[Padded],
    leaf: usize,
    widen: impl Fn(&Arranged) -> (T, bool),
) -> T {
    let (wide, fits) = widen(tree);
    if fits {
        return wide;
    }
    let mut shallower = DEPTHS.iter().filter_map(|&most| shallow(tree, boxes, leaf, most)).map(|tree| widen(&tree));
    let fitting = shallower.find_map(|(wide, fits)| fits.then_some(wide));
    fitting.unwrap_or_else(|| widen(&balanced(boxes, leaf)).0)
}

/// Levels of median splits of so many primitives.
fn levels(count: usize, leaf: usize) -> u32 {
    count.div_ceil(leaf).next_power_of_two().ilog2() + 1
}

/// What is below each node, with itself.
struct Below {
    levels: Vec<u32>,
    /// Primitives.
    count: Vec<u32>,
}

impl Below {
    fn of(nodes: &[Binary]) -> Self {
        let mut parents_first = vec![0_u32];
        let mut next = 0;
        while let Some(&index) = parents_first.get(next) {
            next += 1;
            let node = nodes[index as usize];
            if node.count == 0 {
                parents_first.extend([node.first, node.first + 1]);
            }
        }
        let mut below = Self { levels: vec![1; nodes.len()], count: nodes.iter().map(|node| node.count).collect() };
        for &index in parents_first.iter().rev() {
            let (node, index) = (nodes[index as usize], index as usize);
            if node.count == 0 {
                let [a, b] = [node.first as usize, node.first as usize + 1];
                below.levels[index] = 1 + below.levels[a].max(below.levels[b]);
                below.count[index] = below.count[a] + below.count[b];
            }
        }
        below
    }
}

/// The primitives below a node.
fn primitives(nodes: &[Binary], order: &[u32], root: u32) -> Vec<u32> {
    let (mut found, mut open) = (Vec::new(), vec![root]);
    while let Some(index) = open.pop() {
        let node = nodes[index as usize];
        if node.count == 0 {
            open.extend([node.first, node.first + 1]);
        } else {
            found.extend(&order[node.first as usize..(node.first + node.count) as usize]);
        }
    }
    found
}

/// Puts median splits of these primitives at the place `to` of the result.
fn replace(to: usize, primitives: &[u32], boxes: &[Padded], leaf: usize, (nodes, order): &mut Arranged) {
    let own: Vec<Padded> = primitives.iter().map(|&id| boxes[id as usize]).collect();
    let (mut added, arranged) = balanced(&own, leaf);
    // All but its root go to the end.
    let (shift, start) = (nodes.len() as u32 - 1, order.len() as u32);
    for node in &mut added {
        node.first += if node.count == 0 { shift } else { start };
    }
    nodes[to] = added[0];
    nodes.extend(&added[1..]);
    order.extend(arranged.into_iter().map(|at| primitives[at as usize]));
}

#[cfg(test)]
mod tests;
