//! Photon maps larger than the 128 MiB that some devices can bind at once.

use backend_cpu::Cpu;
use backend_vulkan::low_level;
use photon_core::{Backend, Estimate, EstimateParams, IndexKind, Photon, Query, Result, Search};

const BINDING: u64 = 128 << 20;

/// A lattice on the unit square; the photons have different powers, which sum exactly in `f32`.
fn photons(side: u32) -> Vec<Photon> {
    let at = |i: u32| (i as f32 + 0.5) / side as f32;
    let photon = |i: u32| Photon {
        position: [at(i % side), 0.0, at(i / side)],
        power: [(i % 7) as f32, 1.0, (i >> 20) as f32],
        direction: 0,
        normal: 0,
    };
    (0..side * side).map(photon).collect()
}

/// Near both ends and in between; each radius holds about ten photons.
fn queries(side: u32) -> Vec<Query> {
    let places = [0.0, 0.001, 0.3, 0.5, 0.77, 0.999, 1.0];
    let query = |i: usize| Query {
        position: [places[i % 7], 0.0, places[i / 7]],
        radius: 2.3 / side as f32,
        normal: [0.0, 1.0, 0.0],
        ..Query::default()
    };
    (0..49).map(query).collect()
}

fn ask<B: Backend>(on: &mut B, kind: IndexKind, photons: &[Photon], queries: &[Query]) -> Result<Vec<Estimate>> {
    let mut stages = on.map_stages(kind)?;
    let there = on.upload("photons", photons)?;
    let asked = on.upload("queries", queries)?;
    let mut estimates = on.alloc("estimates", queries.len() as u64)?;
    let map = stages.builder.build(on, there)?;
    let mut found = Vec::new();
    for search in [Search::Radius, Search::KNearest { k: 30 }] {
        let gather = EstimateParams::new(search);
        stages.estimator.estimate(on, &map, &asked, &gather, &mut estimates)?;
        let mut some = Vec::new();
        on.download(&estimates, &mut some)?;
        found.extend(some);
    }
    Ok(found)
}

#[test]
fn maps_larger_than_a_binding_are_whole() {
    let Some(mut on) = low_level::for_tests() else { return };
    let mut cpu = Cpu::with_threads(2).expect("threads start");
    let (side, kind) = (2900, IndexKind::Morton);
    let (photons, queries) = (photons(side), queries(side));
    // Both the slot positions alone and the photons themselves exceed the limit.
    assert!(photons.len() as u64 * 16 > BINDING);
    let expected = ask(&mut cpu, kind, &photons, &queries).expect("the CPU's estimates");
    let found = ask(&mut on, kind, &photons, &queries).expect("the device's estimates");
    assert!(expected[..49].iter().all(|estimate| estimate.photons > 2));
    for (number, (a, b)) in expected.iter().zip(&found).enumerate() {
        assert_eq!((a.photons, a.radius_squared.to_bits()), (b.photons, b.radius_squared.to_bits()), "query {number}");
        // Sums of small integers are exact.
        assert_eq!(a.flux, b.flux, "query {number}");
    }
    assert_eq!(expected.len(), found.len());
}
