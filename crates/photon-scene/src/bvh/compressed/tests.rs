//! Every triangle occurs exactly once in the tree, inside the boxes of all its ancestors.

use photon_core::random::{philox4x32, unit_f32};

use super::{CompressedNode, CompressedTree};

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Small random triangles, and `twins` identical ones.
fn soup(count: u32, twins: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let number = |block: u32| philox4x32([i, block, 0, 0], [1, 2]).map(unit_f32);
        let [x, y, z, size] = number(0);
        for corner in 1..4 {
            let [a, b, c, _] = number(corner);
            positions.push([x - 0.5 + size * 0.1 * a, y - 0.5 + size * 0.1 * b, z - 0.5 + size * 1e-4 * c]);
        }
    }
    let mut triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    triangles.extend(std::iter::repeat_n([0, 1, 2], twins as usize));
    (positions, triangles)
}

/// Checks that every triangle occurs once, inside every box above it, and that no path is too deep.
fn check(tree: &CompressedTree, (positions, triangles): &Mesh) -> Result<(), String> {
    let mut seen = vec![0; triangles.len()];
    let mut open = vec![(0_u32, 1_u32, vec![])];
    while let Some((index, depth, around)) = open.pop() {
        if depth > CompressedTree::MAX_DEPTH {
            return Err(format!("node {index} has depth {depth}"));
        }
        let node: &CompressedNode = &tree.nodes[index as usize];
        for slot in 0..8 {
            let Some(child) = node.child(slot) else { continue };
            let mut around = around.clone();
            around.push((child.low, child.high));
            if child.triangles == 0 {
                open.push((child.first, depth + 1, around));
                continue;
            }
            for place in child.first..child.first + child.triangles {
                let id = tree.order[place as usize] as usize;
                seen[id] += 1;
                for vertex in triangles[id] {
                    let at = positions[vertex as usize].map(f64::from);
                    let inside = |(low, high): &([f64; 3], [f64; 3])| (0..3).all(|a| low[a] < at[a] && at[a] < high[a]);
                    if let Some(out) = around.iter().find(|bounds| !inside(bounds)) {
                        return Err(format!("triangle {id}: {at:?} lies outside {out:?}"));
                    }
                }
            }
        }
    }
    seen.iter().position(|&times| times != 1).map_or(Ok(()), |id| Err(format!("triangle {id}: {} times", seen[id])))
}

#[test]
fn every_triangle_is_in_every_box_above_it() {
    for (count, twins) in [(1, 0), (2, 0), (3, 0), (4, 0), (9, 0), (25, 0), (3000, 0), (10, 5000)] {
        let mesh = soup(count, twins);
        let tree = CompressedTree::build(&mesh.0, &mesh.1).unwrap();
        check(&tree, &mesh).unwrap();
        assert!(tree.nodes.len() <= mesh.1.len().div_ceil(2).max(1), "{} nodes", tree.nodes.len());
    }
    assert!(CompressedTree::build(&[], &[]).unwrap().nodes.is_empty());
}

#[test]
fn what_is_missing_or_outside_is_noticed() {
    let mesh = soup(100, 0);
    let mut tree = CompressedTree::build(&mesh.0, &mesh.1).unwrap();
    tree.order[7] = tree.order[8];
    assert!(check(&tree, &mesh).is_err());
    let tree = CompressedTree::build(&mesh.0, &mesh.1).unwrap();
    let mut moved = mesh.clone();
    moved.0[50][1] += 0.2;
    assert!(check(&tree, &moved).is_err());
}
