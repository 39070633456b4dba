//! Chunks hold each primitive once, and few enough.

use super::{CHUNK, Cut, Top, cut};
use crate::bvh::binary::Padded;

/// Primitives of which most are in one place of a much larger scene.
fn crowd(count: usize) -> Vec<Padded> {
    let at = |i: usize| {
        let (x, y) = ((i % 251) as f32 / 251.0, (i / 251) as f32 / 300.0);
        if i.is_multiple_of(1000) { [x - 0.5, y - 0.5, 0.4] } else { [x * 1e-3, y * 1e-3, 0.0] }
    };
    (0..count).map(at).map(|at| Padded::around([at, at.map(|c| c + 1e-6), at])).collect()
}

#[test]
fn chunks_are_a_partition_below_a_tree() {
    let boxes = crowd(70_000);
    let Cut { nodes, chunks } = cut(&boxes, 3);
    let mut all: Vec<u32> = chunks.concat();
    all.sort_unstable();
    assert!(all.into_iter().eq(0..70_000));
    assert!(chunks.iter().all(|ids| (1..=CHUNK).contains(&ids.len()) && ids.is_sorted()));
    // Each node but the root has one parent, before it; each chunk has one place.
    let mut parents = vec![0; nodes.len()];
    let mut places = vec![0; chunks.len()];
    for (place, &node) in nodes.iter().enumerate() {
        match node {
            Top::Inner(first) => {
                assert!(first as usize > place);
                parents[first as usize] += 1;
                parents[first as usize + 1] += 1;
            }
            Top::Chunk(chunk) => places[chunk as usize] += 1,
        }
    }
    assert!(parents[0] == 0 && parents[1..].iter().all(|&count| count == 1) && places.iter().all(|&count| count == 1));
}

#[test]
fn few_or_identical_primitives_stay_together() {
    assert_eq!(cut(&crowd(CHUNK), 2).nodes, [Top::Chunk(0)]);
    let same = vec![Padded::around([[0.5; 3]; 3]); 2 * CHUNK];
    assert_eq!(cut(&same, 2).chunks.len(), 1);
}
