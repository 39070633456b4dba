//! Trees that are too deep for the stack of a traversal: only their deep ends are replaced by median splits.

use photon_core::parallel;

use super::binary::{Arranged, Binary, Padded, balanced};
use super::chunked;
use super::concat::{concat, starts};
use super::regions::Regions;

/// Depths to try for the binary tree, from the one that keeps most of it. Wide trees are shallower, by how much depends on
/// the tree.
pub(crate) const DEPTHS: [u32; 4] = [128, 64, 48, 32];

/// The same tree with at most `most` levels, if median splits have so few: from the root, splits are kept as long as median
/// splits of what is below them would fit. In a large tree, those near the root are kept in any case.
pub(crate) fn shallow(
    (nodes, order): &Arranged,
    boxes: &[Padded],
    leaf: usize,
    most: u32,
    threads: usize,
) -> Option<Arranged> {
    if nodes.is_empty() || levels(boxes.len(), leaf) > most {
        return None;
    }
    if boxes.len() < chunked::MANY {
        return below((nodes, order), boxes, leaf, most);
    }
    let tree = Regions::of(nodes, threads);
    let mut depths = vec![1_u32; tree.top];
    let mut top: Vec<Option<Binary>> = tree.nodes[..tree.top].iter().copied().map(Some).collect();
    for at in 0..tree.top {
        let (first, depth) = (tree.nodes[at].first as usize, depths[at]);
        if tree.nodes[at].count == 0 && first < tree.top {
            depths[first..=first + 1].fill(depth + 1);
        }
    }
    let parts = parallel::map(threads, tree.regions.iter(), |_, (root, range)| {
        // The root and what is below it, with its own indices.
        let moved = |node: &Binary| {
            if node.count == 0 { Binary { first: node.first - range.start as u32 + 1, ..*node } } else { *node }
        };
        let nodes = std::iter::once(&tree.nodes[*root as usize]).chain(&tree.nodes[range.clone()]);
        let nodes: Vec<Binary> = nodes.map(moved).collect();
        let left = most.checked_sub(depths[*root as usize] - 1)?;
        below((&nodes, order), boxes, leaf, left)
    });
    let parts: Vec<Arranged> = parts.into_iter().collect::<Option<_>>()?;
    tree.regions.iter().for_each(|(root, _)| top[*root as usize] = None);
    let mut first_ids = Vec::new();
    for node in top.iter_mut().flatten().filter(|node| node.count > 0) {
        let first = node.first as usize;
        node.first = first_ids.len() as u32;
        first_ids.extend(&order[first..first + node.count as usize]);
    }
    let ids = starts(first_ids.len(), parts.iter().map(|(_, order)| order.len()));
    let places = starts(tree.top, parts.iter().map(|(nodes, _)| nodes.len() - 1));
    let moved = |part: usize, node: Binary| Binary {
        first: node.first + if node.count == 0 { places[part] - 1 } else { ids[part] },
        ..node
    };
    for (i, (part, (root, _))) in parts.iter().zip(&tree.regions).enumerate() {
        top[*root as usize] = Some(moved(i, part.0[0]));
    }
    let top: Vec<Binary> = top.into_iter().flatten().collect();
    let others: Vec<&[Binary]> = parts.iter().map(|(nodes, _)| &nodes[1..]).collect();
    let nodes = concat(&top, &others, threads, moved);
    first_ids.extend(parts.iter().flat_map(|(_, order)| order));
    Some((nodes, first_ids))
}

/// As [`shallow`], for the tree below a node, the first one.
fn below((nodes, order): (&[Binary], &[u32]), boxes: &[Padded], leaf: usize, most: u32) -> Option<Arranged> {
    let leaf = leaf.max(1);
    let below = Below::of(nodes);
    if below.levels[0] > most && levels(below.count[0] as usize, leaf) > most {
        return None;
    }
    let mut result: Arranged = (vec![nodes[0]], Vec::with_capacity(below.count[0] as usize));
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
    threads: usize,
    widen: impl Fn(&Arranged) -> (T, bool),
) -> T {
    let (wide, fits) = widen(tree);
    if fits {
        return wide;
    }
    let mut shallower =
        DEPTHS.iter().filter_map(|&most| shallow(tree, boxes, leaf, most, threads)).map(|tree| widen(&tree));
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
pub(crate) fn primitives(nodes: &[Binary], order: &[u32], root: u32) -> Vec<u32> {
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
