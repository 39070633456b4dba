//! M4: searches find truncated photons exactly as they find full ones.

use std::collections::BTreeMap;

use photon_core::{
    Backend, Batch, Direct, Estimate, EstimateParams, IndexKind, MapKind, MediaDeposits, Pass, PerMap, Photon,
    PhotonFormat, PhotonRay, Query, RandomKind, Requirements, Search, Settings, TransportBackend,
};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

use crate::harness::{TestBackend, Uniform, query_at};

/// Number of photons that share a Morton code: more than a workgroup sorts, on a software device too.
const HEAP: u32 = 70_000;

/// Number of other photons.
const SPREAD: u32 = 3000;

/// Rays with prescribed end points: a cluster within one cell of 2⁻²¹, many of them at the same point, and others
/// spread over a floor and a wall. Successive photons have different powers.
fn rays(colour: [f32; 3], heap: u32) -> Vec<PhotonRay> {
    let mut uniform = Uniform::new(4);
    let mut side = |half: f64| (half * (2.0 * uniform.draw() - 1.0)) as f32;
    let mut ray = |path: u32| {
        let half = if path < heap { 2e-8 } else { 0.45 };
        let (a, b) = (side(half), side(half));
        let (origin, direction) = if path < heap {
            ([0.2 + a, 0.1 + b, 0.25], [0.0, 0.0, -1.0])
        } else if path.is_multiple_of(3) {
            ([0.25, a, 0.25 + 0.5 * b], [-1.0, 0.0, 0.0])
        } else {
            ([a, b, 0.25], [0.0, 0.0, -1.0])
        };
        let power = colour.map(|c| c * (1 + path % 7) as f32);
        PhotonRay { origin, direction, power, path, ..PhotonRay::default() }
    };
    (0..heap + SPREAD).map(&mut ray).collect()
}

/// Queries within the cluster, around it, and anywhere on the floor.
fn queries() -> Vec<Query> {
    let mut uniform = Uniform::new(5);
    let mut query = |i: u32| {
        let (x, y, half, radius) = match i {
            0..4 => (0.2, 0.1, 3e-8, 1e-6),
            4..8 => (0.2, 0.1, 1e-3, 2e-3),
            _ => (0.0, 0.0, 0.45, 0.1),
        };
        let mut near = |middle: f64| (middle + half * (2.0 * uniform.draw() - 1.0)) as f32;
        query_at([near(x), near(y), 0.0], radius)
    };
    (0..48).map(&mut query).collect()
}

/// A buffer of the photons of those rays, in the given format.
fn landed<B: TransportBackend>(
    on: &mut B,
    scene: &Scene,
    rays: &[PhotonRay],
    photon_format: PhotonFormat,
) -> B::Buffer<Photon> {
    let settings = Settings { direct: Direct::Photons, max_bounces: 1, ..Settings::default() };
    let mut required = Requirements::of(&scene.view(), &settings);
    required.photon_format = photon_format;
    let prepared = on.prepare(&scene.view(), &required).unwrap();
    let mut stages = on.stages(&required, &settings).unwrap();
    let mut photons = on.alloc_photons("photons", rays.len() as u64, photon_format).unwrap();
    let there = on.upload("rays", rays).unwrap();
    let batch = Batch {
        pass: Pass { seed: 1, index: 0, random: RandomKind::Counter, sample: 0, samples: 1 },
        paths: 0..rays.len() as u32,
    };
    let deposits = PerMap::only(MapKind::Direct, &mut photons);
    stages.tracer.trace(on, &prepared, &batch, &there, deposits, MediaDeposits::default()).unwrap();
    assert_eq!(stages.tracer.take_tally(on).unwrap().surfaces, rays.len() as u64);
    photons
}

/// Estimates from a map of the photons, with every search that does not need directions.
fn found<B: TransportBackend>(on: &mut B, photons: B::Buffer<Photon>, kind: IndexKind) -> Vec<Estimate> {
    let queries = queries();
    let mut stages = on.map_stages(kind).unwrap();
    let map = stages.builder.build(on, photons).unwrap();
    let asked = on.upload("queries", &queries).unwrap();
    let mut estimates = on.alloc("estimates", queries.len() as u64).unwrap();
    let ask = |search| {
        let gather = EstimateParams { min_normal_cosine: 0.5, ..EstimateParams::new(search) };
        stages.estimator.estimate(on, &map, &asked, &gather, &mut estimates).unwrap();
        let mut found = Vec::new();
        on.download(&estimates, &mut found).unwrap();
        found
    };
    [Search::NearestPhoton, Search::Radius, Search::KNearest { k: 12 }].map(ask).concat()
}

/// Number of photons in the fullest cell of a grid with 2²¹ cells per side around all of them.
fn fullest_cell(photons: &[Photon]) -> usize {
    let sides = [0, 1, 2].map(|axis| {
        let along = photons.iter().map(|photon| f64::from(photon.position[axis]));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    });
    let longest = sides.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let mut cells = BTreeMap::<[u64; 3], usize>::new();
    for photon in photons {
        let away = |axis: usize| (f64::from(photon.position[axis]) - sides[axis].0) / longest;
        *cells.entry([0, 1, 2].map(|axis| (away(axis) * 2_097_152.0) as u64)).or_default() += 1;
    }
    cells.into_values().max().unwrap_or(0)
}

/// Every search finds the same, to the bit: including the single nearest photon, and in a cluster of photons that
/// share a code, most of which lie at the same few points.
pub fn m4_the_same_photons_are_found<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let h = 0.5;
    builder.quad("floor", [[-h, -h, 0.0], [h, -h, 0.0], [h, h, 0.0], [-h, h, 0.0]], grey);
    builder.quad("wall", [[-h, -h, -h], [-h, h, -h], [-h, h, h], [-h, -h, h]], grey);
    builder.light("bulb", LightDesc::Point { position: [0.0, 0.0, 0.3], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let mut on = T::make(2);
    for (photon_format, colour, kind, heap) in [
        (PhotonFormat::Mono, [1.0; 3], IndexKind::Morton, HEAP),
        (PhotonFormat::NoDirection, [1.0, 0.5, 0.25], IndexKind::Morton, HEAP),
        (PhotonFormat::NoDirection, [1.0, 0.5, 0.25], IndexKind::Vvh, SPREAD),
    ] {
        let mut rays = rays(colour, heap);
        let mut whole = Vec::new();
        let there = landed(&mut on, &scene, &rays, PhotonFormat::Full);
        on.download(&there, &mut whole).unwrap();
        assert!(whole.len() == rays.len() && fullest_cell(&whole) as u32 > heap - heap / 20);
        let expected = found(&mut on, there, kind);
        // The nearest photon of a query in the cluster belongs to it.
        assert!(expected[..4].iter().all(|e| e.photons == 1 && e.radius_squared < 1e-12), "{expected:?}");
        let short = landed(&mut on, &scene, &rays, photon_format);
        assert!(found(&mut on, short, kind) == expected, "{photon_format:?}, {kind:?}");
        // Negative control: one photon of the cluster with twice the power.
        rays[1].power = rays[1].power.map(|power| 2.0 * power);
        let other = landed(&mut on, &scene, &rays, photon_format);
        assert!(found(&mut on, other, kind) != expected, "{photon_format:?}, {kind:?}");
    }
}
