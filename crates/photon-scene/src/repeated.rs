//! Triangles that repeat others: no ray ever meets them, but every ray through a pile of them tests all.

use std::collections::BTreeSet;

use photon_core::parallel;

use crate::describe::{AlphaMode, MaterialDesc};
use crate::normalise::Geometry;

/// Bits of the table for each triangle; more make fewer triangles share one by chance.
const PLACES: usize = 8;

/// Removes triangles that have exactly the corners of one of a lower index, which rays meet instead. Those that emit light,
/// bound solids or are partly there stay. Returns the number of those removed.
pub(crate) fn remove(geometry: &mut Geometry, materials: &[MaterialDesc]) -> usize {
    let plain: Vec<bool> = materials
        .iter()
        .map(|desc| !desc.is_emissive() && !desc.is_solid() && desc.alpha_mode == AlphaMode::Opaque)
        .collect();
    let found = find(geometry, |triangle| plain[geometry.primitives[triangle as usize].1 as usize]);
    if !found.is_empty() {
        geometry.remove(&found);
    }
    found.len()
}

fn find(geometry: &Geometry, may_go: impl Fn(u32) -> bool) -> BTreeSet<u32> {
    let corners = |triangle: u32| {
        geometry.triangles[triangle as usize].map(|vertex| geometry.positions[vertex as usize].map(f32::to_bits))
    };
    let hashes = parallel::collect_plain(geometry.triangles.len(), |triangle| hash(&corners(triangle as u32)));
    // Bits of places that one triangle has, and that several have.
    let words = (PLACES * hashes.len()).next_power_of_two().div_ceil(64);
    let place = |hash: u64| ((hash >> 6) as usize & (words - 1), 1_u64 << (hash & 63));
    let (mut taken, mut shared) = (vec![0_u64; words], vec![0_u64; words]);
    for (word, bit) in hashes.iter().map(|&hash| place(hash)) {
        shared[word] |= taken[word] & bit;
        taken[word] |= bit;
    }
    let is_shared = |&(hash, _): &(u64, u32)| {
        let (word, bit) = place(hash);
        shared[word] & bit != 0
    };
    let mut alike: Vec<(u64, u32)> = hashes.into_iter().zip(0..).filter(is_shared).collect();
    alike.sort_unstable();
    // Of different triangles with one hash, which are as good as impossible, those after the first stay.
    let repeats = |same: &[(u64, u32)]| {
        let first = same[0].1;
        let is_repeated = |&triangle: &u32| may_go(triangle) && corners(triangle) == corners(first);
        same[1..].iter().map(|&(_, triangle)| triangle).filter(is_repeated).collect::<Vec<_>>()
    };
    alike.chunk_by(|a, b| a.0 == b.0).flat_map(repeats).collect()
}

/// A hash of which all bits depend on all corners: multiply and rotate, then the finalizer of `MurmurHash3`.
fn hash(corners: &[[u32; 3]; 3]) -> u64 {
    let parts = corners.as_flattened().iter();
    let mut hash =
        parts.fold(0, |hash: u64, &part| (hash.rotate_left(5) ^ u64::from(part)).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    hash = (hash ^ hash >> 33).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
    hash ^ hash >> 33
}

#[cfg(test)]
mod tests {
    use crate::{AlphaMode, MaterialDesc, Scene, SceneBuilder};

    /// Two meshes of `piles` times the same triangle, of two materials, and of one that differs in the last bit.
    fn pile(repeats: usize, [first, second]: [&MaterialDesc; 2]) -> Scene {
        let mut scene = SceneBuilder::new();
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5 + 1e-7, 0.0]];
        for desc in [first, second] {
            let material = scene.material(desc.clone());
            let mut triangles = vec![[0, 1, 2]; repeats];
            triangles.push([0, 1, 3]);
            scene.mesh(desc.name.as_str(), corners.clone(), triangles, material);
        }
        scene.build().expect("a scene")
    }

    #[test]
    fn triangles_that_repeat_others_are_left_out_and_said() {
        let white = MaterialDesc::lambert("white", [0.5; 3]);
        let scene = pile(5000, [&white, &white]);
        assert_eq!((scene.view().triangles.len(), scene.dropped_triangles()), (2, 10_000));
        assert!(scene.triangle_sources().eq([(0, 0), (0, 5000)]));
        assert_eq!(
            scene.warnings(),
            ["10000 triangles repeat others exactly, which rays meet instead, and were left out"]
        );
        // Of those that differ only nearly, none goes.
        assert_eq!(pile(1, [&white, &white]).view().triangles.len(), 2);
    }

    #[test]
    fn triangles_that_count_more_than_once_stay() {
        let white = MaterialDesc::lambert("white", [0.5; 3]);
        let lamp = MaterialDesc::emissive("lamp", [0.5; 3], [1.0; 3]);
        let leaf = white.clone().with_alpha(AlphaMode::Blend, 0.5);
        for desc in [lamp, leaf, MaterialDesc::glass("glass", 1.5)] {
            assert_eq!(pile(3, [&desc, &desc]).view().triangles.len(), 8, "{}", desc.name);
        }
        // Sheets of two materials have been set apart.
        assert_eq!(pile(3, [&white, &MaterialDesc::lambert("grey", [0.2; 3])]).view().triangles.len(), 4);
    }
}
