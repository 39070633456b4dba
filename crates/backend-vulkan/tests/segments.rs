//! Light of photons in a medium along segments that start at an oblique plane, on both backends.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use backend_cpu::Cpu;
use backend_vulkan::low_level;
use photon_core::glam::Vec3;
use photon_core::octahedral;
use photon_core::{
    BeamParams, Estimate, EstimateBuffers, Kernel, MediumStack, Photon, Query, Requirements, Segment, Settings,
    TransportBackend,
};
use photon_scene::{AmbientMedium, LightDesc, MaterialDesc, Scene, SceneBuilder};

/// Depth of the medium in mean free paths.
const DEPTH: f32 = 6.0;
const PHOTONS: u32 = 1 << 20;

fn scene() -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [0.5; 3]));
    builder.quad("wall", [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], wall);
    builder.light("bulb", LightDesc::Point { position: [0.5, 0.5, 1.0], intensity: [1.0; 3] });
    builder.medium(AmbientMedium::new([20.0; 3], [0.0; 3]));
    builder.build().unwrap()
}

/// Photons of equal power, spread evenly in a box below the plane z = 0, in mean free paths.
fn photons(free_path: f32) -> Vec<Photon> {
    // The additive sequence by the root of x⁴ = x + 1.
    let steps = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_969_6];
    let (low, size) = (Vec3::new(-1.0, -1.0, 0.0), Vec3::new(16.0, 6.0, DEPTH));
    let direction = octahedral::pack(Vec3::Y);
    let at = |index: u32| {
        let [x, y, z] = steps.map(|step: f64| (f64::from(index) * step).fract() as f32);
        (low + Vec3::new(x, y, z) * size) * free_path
    };
    (0..PHOTONS).map(|i| Photon { position: at(i).into(), normal: 0, power: [1.0; 3], direction }).collect()
}

/// Sums of the flux of segments that start at a square of the plane, at each of some angles.
fn flux<B: TransportBackend, const N: usize>(on: &mut B, angles: [f32; N]) -> [f64; N] {
    const SIDE: u16 = 16;
    let scene = scene();
    let view = scene.view();
    let free_path = 1.0 / view.media[0].extinction().max_element();
    let required = Requirements::of(&view, &Settings::default());
    let prepared = on.prepare(&view, &required).unwrap();
    let mut stages = on.stages(&required, &Settings::default()).unwrap();
    let there = on.upload("photons", &photons(free_path)).unwrap();
    let map = stages.map.builder.build(on, there).unwrap();
    let estimator = &mut stages.media.as_mut().unwrap().estimator;
    angles.map(|angle| {
        let direction = Vec3::new(angle.sin(), 0.0, angle.cos());
        let segments: Vec<Query> = (0..SIDE * SIDE)
            .map(|index| {
                let [x, y] = [index % SIDE, index / SIDE].map(|at| f32::from(at) * 0.25 * free_path);
                let (origin, length) = (Vec3::new(x, y, 0.0), DEPTH / angle.cos() * free_path);
                let (planes, media) = ([Vec3::Z; 2], MediumStack::VACUUM);
                Segment { origin, direction, length, planes, media, throughput: Vec3::ONE }.query(0, u32::from(index))
            })
            .collect();
        let segments = on.upload("segments", &segments).unwrap();
        let mut estimates = on.alloc::<Estimate>("estimates", u64::from(SIDE * SIDE)).unwrap();
        let params = BeamParams { kernel: Kernel::Epanechnikov, radius: 0.5 * free_path };
        let buffers = EstimateBuffers { estimates: &mut estimates, error_moments: None };
        estimator.estimate(on, &prepared, &map, &segments, &params, buffers).unwrap();
        let mut found = Vec::new();
        on.download(&estimates, &mut found).unwrap();
        found.iter().map(|estimate| f64::from(estimate.flux[0])).sum()
    })
}

/// In an even medium of optical depth d along the segment it scatters 1 − exp(−d) as much as an endless one, whatever the angle
/// to the plane. With the transmittance to the foot of each photon there would be 3 % more at 60 degrees.
fn is_even(flux: [f64; 3], angles: [f32; 3]) {
    let share = |angle: f32| 1.0 - (-f64::from(DEPTH / angle.cos())).exp();
    let [straight, ..] = flux;
    for (found, angle) in flux.into_iter().zip(angles) {
        let truth = straight * share(angle) / share(0.0);
        println!("{angle}: {:.5}", found / truth);
        assert!((found / truth - 1.0).abs() < 0.01, "{angle}: {found} instead of {truth}");
    }
}

#[test]
fn oblique_planes_show_the_same_light() {
    let angles = [0.0, 45.0_f32.to_radians(), 60.0_f32.to_radians()];
    let ours = flux(&mut Cpu::with_threads(2).unwrap(), angles);
    is_even(ours, angles);
    let Some(mut gpu) = low_level::for_tests() else { return };
    let theirs = flux(&mut gpu, angles);
    for (a, b) in ours.into_iter().zip(theirs) {
        assert!((a - b).abs() <= 1e-5 * a, "{a} {b}");
    }
}
