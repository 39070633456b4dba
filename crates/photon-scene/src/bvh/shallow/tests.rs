//! Every primitive stays in the tree once and in all boxes above it, and no path is longer than asked for.

use super::{DEPTHS, levels, shallow};
use crate::bvh::binary::{Arranged, Binary, Padded, balanced, single};

/// The levels of a tree, if each primitive is in one leaf and in the boxes of all its ancestors.
fn check((nodes, order): &Arranged, boxes: &[Padded], leaf: usize) -> u32 {
    let mut seen = vec![0; boxes.len()];
    let (mut deepest, mut open) = (0, vec![(0_u32, 1_u32)]);
    let inside = |a: &Binary, b: &Binary| (0..3).all(|x| a.low[x] >= b.low[x] && a.high[x] <= b.high[x]);
    while let Some((index, depth)) = open.pop() {
        let node = &nodes[index as usize];
        deepest = deepest.max(depth);
        if node.count == 0 {
            for child in [node.first, node.first + 1] {
                assert!(inside(&nodes[child as usize], node), "{child} in {index}");
                open.push((child, depth + 1));
            }
            continue;
        }
        assert!(node.count as usize <= leaf);
        for &id in &order[node.first as usize..(node.first + node.count) as usize] {
            seen[id as usize] += 1;
            let own = balanced(&boxes[id as usize..=id as usize], 1).0[0];
            assert!(inside(&own, node), "primitive {id} in {index}");
        }
    }
    assert!(seen.iter().all(|&times| times == 1) && order.len() == boxes.len(), "{seen:?}");
    deepest
}

/// Each within the previous ones: the surface area heuristic makes a chain of them.
fn nested(count: u32) -> Vec<Padded> {
    let size = |i: u32| 0.97_f32.powi(i as i32);
    (0..count).map(|i| [[0.0; 3], [size(i); 3], [size(i), 0.0, 0.0]]).map(Padded::around).collect()
}

fn apart(count: u32) -> Vec<Padded> {
    let at = |i: u32| [(i % 37) as f32, (i % 101) as f32 * 0.3, i as f32 * 0.01].map(|c| c * 0.01);
    (0..count).map(|i| Padded::around([at(i), at(i + 1), at(i + 2)])).collect()
}

#[test]
fn deep_trees_become_as_shallow_as_asked_for() {
    for leaf in [1, 4] {
        let boxes = [nested(600), apart(500)].concat();
        let built = single(&boxes, leaf);
        let depth = check(&built, &boxes, leaf);
        assert!(depth > 64, "{depth}: the chain is no test");
        for most in [64, 48, 32, 20, levels(boxes.len(), leaf)] {
            let result = shallow(&built, &boxes, leaf, most, 2).unwrap();
            let depth = check(&result, &boxes, leaf);
            assert!(depth <= most, "{depth} levels of {most}");
            // The levels that are there are used.
            assert!(depth + 1 >= most, "{depth} levels of {most}");
        }
        assert!(shallow(&built, &boxes, leaf, levels(boxes.len(), leaf) - 1, 2).is_none());
    }
}

/// Many primitives, of which one region is too deep: the same for any number of threads.
#[test]
fn a_deep_region_of_a_large_tree_becomes_shallow() {
    let boxes = [apart(80_000), nested(600)].concat();
    let built = crate::bvh::binary::tree(&boxes, 1, 2);
    let depth = check(&built, &boxes, 1);
    assert!(depth > 64, "{depth}: the chain is no test");
    let result = shallow(&built, &boxes, 1, 48, 1).unwrap();
    let depth = check(&result, &boxes, 1);
    assert!((20..=48).contains(&depth), "{depth} levels of 48");
    for threads in [2, 7] {
        assert!(shallow(&built, &boxes, 1, 48, threads).unwrap() == result);
    }
}

/// Trees that are shallow enough have the same nodes, in another order.
#[test]
fn shallow_trees_keep_their_splits() {
    let boxes = apart(5000);
    let built = single(&boxes, 1);
    let depth = check(&built, &boxes, 1);
    let result = shallow(&built, &boxes, 1, depth, 2).unwrap();
    assert_eq!(check(&result, &boxes, 1), depth);
    let bounds = |(nodes, _): &Arranged| {
        let mut bounds: Vec<[u32; 6]> = nodes
            .iter()
            .map(|node| {
                let ([a, b, c], [d, e, f]) = (node.low.map(f32::to_bits), node.high.map(f32::to_bits));
                [a, b, c, d, e, f]
            })
            .collect();
        bounds.sort_unstable();
        bounds
    };
    assert_eq!(bounds(&built), bounds(&result));
}

#[test]
fn a_tree_that_is_damaged_is_noticed() {
    let boxes = apart(100);
    let mut built = single(&boxes, 1);
    built.1[3] = built.1[4];
    assert!(std::panic::catch_unwind(|| check(&built, &boxes, 1)).is_err());
}

#[test]
fn few_primitives() {
    for count in 1..9 {
        let boxes = apart(count);
        let built = single(&boxes, 1);
        let most = levels(boxes.len(), 1);
        assert!(check(&shallow(&built, &boxes, 1, most, 2).unwrap(), &boxes, 1) <= most);
    }
    assert!(DEPTHS.is_sorted_by(|a, b| a > b) && shallow(&(Vec::new(), Vec::new()), &[], 1, 4, 2).is_none());
}
