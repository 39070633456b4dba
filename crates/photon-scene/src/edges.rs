//! Topology of triangle meshes: open edges.

/// Number of directed edges without a counterpart in the opposite direction; 0 for those of a closed mesh. Ends of edges are the
/// same vertex if their keys are equal.
pub(crate) fn open_edges<K: Copy + Ord>(edges: impl IntoIterator<Item = (K, K)>) -> usize {
    // Each edge in canonical vertex order, and the direction in which the triangle traverses it.
    let mut edges: Vec<(K, K, i32)> =
        edges.into_iter().map(|(from, to)| if from < to { (from, to, 1) } else { (to, from, -1) }).collect();
    edges.sort_unstable();
    edges
        .chunk_by(|left, right| (left.0, left.1) == (right.0, right.1))
        .map(|same| same.iter().map(|edge| edge.2).sum::<i32>().unsigned_abs() as usize)
        .sum()
}

/// The directed edges of triangles, in the order of their corners.
pub(crate) fn edges_of<K: Copy>(triangles: impl IntoIterator<Item = [K; 3]>) -> impl Iterator<Item = (K, K)> {
    triangles.into_iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)])
}

/// The edges of which [`open_edges`] gives the number, for corners that are indices below `vertices`: in linear time, as long as
/// few edges meet at each vertex.
pub(crate) fn unmatched_edges(vertices: usize, triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let edges = || edges_of(triangles.iter().copied());
    // The edges of each vertex to those with higher indices: first their number, then where they begin.
    let mut starts = vec![0_u32; vertices + 1];
    edges().for_each(|(from, to)| starts[from.min(to) as usize + 1] += 1);
    for i in 0..vertices {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    // The other vertex, and in the lowest bit whether the triangle traverses the edge towards it.
    let mut others = vec![0_u64; 3 * triangles.len()];
    for (from, to) in edges() {
        let place = &mut next[from.min(to) as usize];
        others[*place as usize] = u64::from(from.max(to)) << 1 | u64::from(from < to);
        *place += 1;
    }
    let mut unmatched = Vec::new();
    for vertex in 0..vertices {
        let own = &mut others[starts[vertex] as usize..starts[vertex + 1] as usize];
        own.sort_unstable();
        for same in own.chunk_by(|a, b| a >> 1 == b >> 1) {
            let balance = same.iter().map(|edge| 2 * (edge & 1) as i64 - 1).sum::<i64>();
            let (low, high) = (vertex as u32, (same[0] >> 1) as u32);
            let open = if balance > 0 { (low, high) } else { (high, low) };
            unmatched.extend((0..balance.unsigned_abs()).map(|_| open));
        }
    }
    unmatched
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_counted_alike_by_key_and_by_index() {
        let tetrahedron = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let turned = [[0, 2, 1], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let twice = [tetrahedron, tetrahedron].concat();
        let degenerate = [[0, 0, 1], [1, 0, 0]];
        let cases: [(&[[u32; 3]], usize); 7] = [
            (&tetrahedron, 0),
            (&turned, 6),
            (&tetrahedron[..3], 3),
            (&twice, 0),
            (&twice[..7], 3),
            (&degenerate, 2),
            (&[], 0),
        ];
        for (triangles, expected) in cases {
            let unmatched = unmatched_edges(5, triangles);
            assert_eq!(unmatched.len(), expected, "{triangles:?}");
            assert_eq!(open_edges(unmatched), expected, "{triangles:?}");
            assert_eq!(open_edges(edges_of(triangles.iter().copied())), expected, "{triangles:?}");
        }
    }
}
