//! The same tree for any number of threads, and hardly more expected work than that of one which is built as a whole.

use photon_core::random::{philox4x32, unit_f32};

use super::{MANY, tree};
use crate::bvh::binary::{Arranged, Padded, single};
use crate::bvh::{Accel, CompressedTree};

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Bumpy ground of `2 side²` triangles, two large ones, and as many identical ones as `twins` says.
fn ground(side: u32, twins: usize) -> Mesh {
    let at = |i: u32, j: u32| {
        let bump = unit_f32(philox4x32([i, j, 0, 0], [3, 4])[0]) * 0.02;
        [i as f32 / side as f32 - 0.5, bump, j as f32 / side as f32 - 0.5]
    };
    let mut positions: Vec<[f32; 3]> = (0..=side).flat_map(|i| (0..=side).map(move |j| at(i, j))).collect();
    let place = |i: u32, j: u32| i * (side + 1) + j;
    let mut triangles = Vec::new();
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let (a, b, c, d) = (place(i, j), place(i, j + 1), place(i + 1, j), place(i + 1, j + 1));
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    let first = positions.len() as u32;
    positions.extend([[-0.5, 0.5, -0.5], [0.5, 0.5, -0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]]);
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    triangles.extend(std::iter::repeat_n([0, 1, 2], twins));
    (positions, triangles)
}

fn boxes((positions, triangles): &Mesh) -> Vec<Padded> {
    triangles.iter().map(|corners| Padded::around(corners.map(|vertex| positions[vertex as usize]))).collect()
}

/// Expected boxes and primitives that a ray through the root meets (surface area heuristic), if each primitive is in one leaf
/// and each box in that of its parent.
fn cost((nodes, order): &Arranged, boxes: &[Padded]) -> f64 {
    let area = |node: usize| f64::from(f32::from_bits(super::area(&nodes[node])));
    let mut seen = vec![false; boxes.len()];
    let (mut cost, mut open) = (0.0, vec![0]);
    while let Some(at) = open.pop() {
        let node = nodes[at];
        cost += area(at) * f64::from(node.count.max(1));
        let within = |low: [f32; 3], high: [f32; 3]| (0..3).all(|x| node.low[x] <= low[x] && high[x] <= node.high[x]);
        if node.count == 0 {
            for child in [node.first as usize, node.first as usize + 1] {
                assert!(within(nodes[child].low, nodes[child].high), "{child} is not in {at}");
                open.push(child);
            }
        } else {
            for &id in &order[node.first as usize..(node.first + node.count) as usize] {
                assert!(!std::mem::replace(&mut seen[id as usize], true), "primitive {id} is there twice");
                assert!(within(boxes[id as usize].low, boxes[id as usize].high), "primitive {id} is not in {at}");
            }
        }
    }
    assert!(seen.iter().all(|&seen| seen) && order.len() == boxes.len());
    cost / area(0)
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mesh = ground(220, 300);
    assert!(mesh.1.len() > MANY);
    let by = |threads| {
        let (accel, compressed) =
            (Accel::build_by(&mesh.0, &mesh.1, threads), CompressedTree::build_by(&mesh.0, &mesh.1, threads));
        (accel.unwrap(), compressed.unwrap())
    };
    let (accel, compressed) = by(1);
    for threads in [2, 7] {
        let (other_accel, other_compressed) = by(threads);
        assert!(accel == other_accel, "{threads} threads");
        assert!(
            compressed.nodes == other_compressed.nodes && compressed.order == other_compressed.order,
            "{threads} threads"
        );
    }
}

/// A margin of 2 %: chunks cannot share what one tree of everything would put together.
#[test]
fn chunks_cost_hardly_more_than_one_tree() {
    for twins in [0, 100] {
        let boxes = boxes(&ground(200, twins));
        let own = cost(&tree(&boxes, 1, 2), &boxes);
        // Many identical boxes make the whole tree one of median splits, which costs more.
        let whole = cost(&single(&boxes, 1), &boxes);
        assert!(own < 1.02 * whole, "{own} and {whole}");
    }
}

/// Primitives in few places, all in one place, and at distances that halve each time.
#[test]
fn odd_arrangements_become_trees() {
    let count = MANY + 5;
    let at = |i: usize, place: [f32; 3]| {
        Padded::around([place, place.map(|c| c + 1e-3), [place[0], place[1] + i as f32 * 1e-9, 0.0]])
    };
    let places: [&dyn Fn(usize) -> [f32; 3]; 3] =
        [&|_| [0.25; 3], &|i| [(i % 2) as f32 * 0.5, (i % 3) as f32 * 0.1, 0.0], &|i| {
            [0.5_f32.powi((i % 100) as i32), 0.0, 0.1]
        }];
    for place in places {
        let boxes: Vec<Padded> = (0..count).map(|i| at(i, place(i))).collect();
        for leaf in [1, 4] {
            cost(&tree(&boxes, leaf, 3), &boxes);
        }
    }
}
