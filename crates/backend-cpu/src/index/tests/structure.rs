//! The canonical orders, computed by simple, slow builders, and the depth of trees.

use super::inputs::point_sets;
use super::{IndexKind, KINDS, PointIndex};
use crate::index::layout::{LEAF, MAX_DEPTH, WIDTH};

/// Number of nodes from the root to the deepest block.
fn depth(index: &PointIndex) -> usize {
    fn below(index: &PointIndex, node: u32) -> usize {
        let children = index.tree.nodes[node as usize].child;
        1 + children.iter().filter(|&&c| c & LEAF == 0).map(|&c| below(index, c)).max().unwrap_or(0)
    }
    if index.is_empty() { 0 } else { below(index, 0) }
}

#[test]
fn depth_is_bounded_even_where_the_heuristic_peels() {
    // Every plane that the heuristic picks separates only a few points.
    let points: Vec<[f32; 3]> = (0..40_000).map(|i| [2_f32.powi(-(i / 170)), 0.0, 0.0]).collect();
    for kind in KINDS {
        let index = PointIndex::build(&points, kind).expect("finite points");
        assert!(depth(&index) <= MAX_DEPTH, "{kind:?} {}", depth(&index));
    }
}

fn side(segment: &[(u32, [f32; 3])], axis: usize) -> f32 {
    let c = segment.iter().map(|p| p.1[axis]);
    c.clone().fold(f32::NEG_INFINITY, f32::max) - c.fold(f32::INFINITY, f32::min)
}

#[test]
fn the_median_order_is_the_canonical_one() {
    // The rules of `median`, applied by sorting whole segments.
    fn arrange(segment: &mut [(u32, [f32; 3])]) {
        if segment.len() <= WIDTH {
            segment.sort_by_key(|p| p.0);
            return;
        }
        let sides = [0, 1, 2].map(|axis| side(segment, axis));
        let axis = if sides[0] >= sides[1].max(sides[2]) {
            0
        } else if sides[1] >= sides[2] {
            1
        } else {
            2
        };
        segment.sort_by(|a, b| a.1[axis].partial_cmp(&b.1[axis]).expect("finite").then(a.0.cmp(&b.0)));
        let mut left = WIDTH;
        while 2 * left < segment.len() {
            left *= 2;
        }
        let (low, high) = segment.split_at_mut(left);
        arrange(low);
        arrange(high);
    }
    for (name, points) in point_sets() {
        let mut segment: Vec<_> = points.iter().enumerate().map(|(id, &p)| (id as u32, p)).collect();
        arrange(&mut segment);
        let index = PointIndex::build(&points, IndexKind::Median).expect("finite points");
        assert!(index.order().iter().copied().eq(segment.iter().map(|p| p.0)), "{name}");
    }
}

#[test]
fn the_morton_order_is_the_canonical_one() {
    // The rules of `morton`, applied bit by bit, in f64 where f32 would need care.
    fn arrange(segment: &mut [(u32, [f32; 3])]) {
        let lo = [0, 1, 2].map(|axis| segment.iter().map(|p| p.1[axis]).fold(f32::INFINITY, f32::min));
        let extent = (0..3).map(|axis| side(segment, axis)).fold(0.0, f32::max);
        // The greatest power of two that keeps the extent within 2^21 cells.
        let mut scale = 1.0_f64;
        while f64::from(extent) * scale > 2_097_152.0 {
            scale /= 2.0;
        }
        while extent > 0.0 && f64::from(extent) * scale * 2.0 <= 2_097_152.0 {
            scale *= 2.0;
        }
        let code = |p: [f32; 3]| {
            let mut code = 0_u64;
            for axis in 0..3 {
                let cell = ((f64::from(p[axis] - lo[axis]) * scale) as u64).min((1 << 21) - 1);
                for bit in 0..21 {
                    code |= (cell >> bit & 1) << (3 * bit + 2 - axis);
                }
            }
            code
        };
        segment.sort_by_key(|p| (code(p.1), p.0));
        for run in segment.chunk_by_mut(|a, b| code(a.1) == code(b.1)) {
            if run.len() > WIDTH && run.iter().any(|p| p.1 != run[0].1) {
                arrange(run);
            }
        }
    }
    for (name, points) in point_sets() {
        // In this set the extent overflows, and coordinates are halved first.
        if points.is_empty() || name == "limits" {
            continue;
        }
        let mut segment: Vec<_> = points.iter().enumerate().map(|(id, &p)| (id as u32, p)).collect();
        arrange(&mut segment);
        let index = PointIndex::build(&points, IndexKind::Morton).expect("finite points");
        assert!(index.order().iter().copied().eq(segment.iter().map(|p| p.0)), "{name}");
    }
}
