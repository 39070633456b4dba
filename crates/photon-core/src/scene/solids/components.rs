//! Groups triangles into connected boundaries, by union-find over their vertices.

use glam::Vec3;

use super::{Solid, boxes_meet};
use crate::scene::SceneView;

/// Joins triangles that share a vertex index. If bounding boxes of the resulting groups overlap, also joins those with
/// vertices at equal positions.
pub(super) fn group(scene: &SceneView<'_>, boundary: &[(u32, u32)]) -> Vec<Solid> {
    let mut media: Vec<u32> = boundary.iter().map(|&(_, medium)| medium).collect();
    media.dedup();
    media.sort_unstable();
    media.dedup();
    // Union-find parent of each vertex; `u32::MAX` if no boundary uses it.
    let mut parents = vec![u32::MAX; scene.positions.len()];
    let by_index = components(scene, boundary, &media, &mut parents, false);
    if boxes_meet(&by_index) { components(scene, boundary, &media, &mut parents, true) } else { by_index }
}

fn components(
    scene: &SceneView<'_>,
    boundary: &[(u32, u32)],
    media: &[u32],
    parents: &mut [u32],
    by_place: bool,
) -> Vec<Solid> {
    let mut solids = Vec::new();
    for &medium in media {
        let triangles = || {
            boundary
                .iter()
                .filter(|of| of.1 == medium)
                .map(|&(triangle, _)| (triangle, scene.triangles[triangle as usize]))
        };
        let mut used = Vec::new();
        for (_, [a, b, c]) in triangles() {
            for vertex in [a, b, c] {
                if parents[vertex as usize] == u32::MAX {
                    parents[vertex as usize] = vertex;
                    used.push(vertex);
                }
            }
            unite(parents, a, b);
            unite(parents, a, c);
        }
        if by_place {
            let place = |vertex: u32| scene.positions[vertex as usize].map(|x| (x + 0.0).to_bits());
            let mut places: Vec<([u32; 3], u32)> = used.iter().map(|&vertex| (place(vertex), vertex)).collect();
            places.sort_unstable();
            for pair in places.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                unite(parents, pair[0].1, pair[1].1);
            }
        }
        let mut by_root: Vec<(u32, u32)> =
            triangles().map(|(triangle, [a, ..])| (root(parents, a), triangle)).collect();
        by_root.sort_unstable();
        solids.extend(by_root.chunk_by(|a, b| a.0 == b.0).map(|same| solid(scene, medium, same)));
        for vertex in used {
            parents[vertex as usize] = u32::MAX;
        }
    }
    solids
}

fn unite(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

/// The representative of the component of `node`.
fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let above = parents[parents[node as usize] as usize];
        parents[node as usize] = above;
        node = above;
    }
    node
}

fn solid(scene: &SceneView<'_>, medium: u32, triangles: &[(u32, u32)]) -> Solid {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &(_, triangle) in triangles {
        for vertex in scene.triangles[triangle as usize] {
            let corner = Vec3::from(scene.positions[vertex as usize]);
            (low, high) = (low.min(corner), high.max(corner));
        }
    }
    Solid { medium, triangles: triangles.iter().map(|&(_, triangle)| triangle).collect(), low, high }
}
