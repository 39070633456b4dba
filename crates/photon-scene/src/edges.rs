//! Topology of triangle meshes: open edges.

/// Number of directed edges without a counterpart in the opposite direction; 0 for a closed mesh. Corners are the
/// same vertex if their keys are equal.
pub(crate) fn open_edges<K: Copy + Ord>(triangles: impl IntoIterator<Item = [K; 3]>) -> usize {
    // Each edge in canonical vertex order, and the direction in which the triangle traverses it.
    let mut edges: Vec<(K, K, i32)> = triangles
        .into_iter()
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(from, to)| if from < to { (from, to, 1) } else { (to, from, -1) })
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|left, right| (left.0, left.1) == (right.0, right.1))
        .map(|same| same.iter().map(|edge| edge.2).sum::<i32>().unsigned_abs() as usize)
        .sum()
}
