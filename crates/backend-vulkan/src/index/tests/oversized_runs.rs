//! Sets in which very many photons share a Morton code, a position, or one side of a splitting plane.

use backend_cpu::index::PointIndex;
use photon_core::random::SplitMix64;
use photon_core::{Backend, IndexKind, KdTreeBuilder};

use super::super::VulkanBuilder;
use super::super::oversized_runs::OVERSIZED;
use super::check::{Seen, check};
use super::{KINDS, photons};
use crate::vulkan::Vulkan;

/// Describes the difference from the CPU's map of the points, if any.
fn compare(on: &mut Vulkan, kind: IndexKind, points: &[[f32; 3]]) -> Result<(), String> {
    let photons = photons(points);
    let mut builder = VulkanBuilder::new(on, kind).unwrap();
    let buffer = on.upload("photons", &photons).unwrap();
    let map = builder.build(on, buffer).unwrap();
    let seen = Seen::of(on, &map);
    check(&seen, &photons, PointIndex::build(points, kind).unwrap().order())
}

/// One code for all photons, and no plane that separates them: as fast as any other million.
#[test]
fn a_million_photons_in_one_place() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut points = vec![[0.5, 0.25, -1.0]; 1_000_000];
    for kind in KINDS {
        compare(&mut on, kind, &points).unwrap_or_else(|why| panic!("{kind:?}: {why}"));
    }
    // With one point elsewhere, the bounding box is no longer a point.
    points[123_456] = [0.5, 0.25, 1.0];
    compare(&mut on, IndexKind::Morton, &points).unwrap();
}

/// Nested oversized runs: one photon is so far away that all others share a cell of the grid; two thirds of
/// these share a cell of the next grid, and half of those one position.
#[test]
fn cells_that_hold_too_many_for_a_workgroup() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let mut random = SplitMix64(4);
    let scales = [1.0, 1e-8, 0.0];
    let mut points: Vec<[f32; 3]> = (0..300_000).map(|i| [0; 3].map(|_| random.unit() * scales[i % 3])).collect();
    assert!(points.len() / 3 > OVERSIZED as usize);
    points[77] = [1e9, 0.0, 0.0];
    compare(&mut on, IndexKind::Morton, &points).unwrap();
}
