//! Times closest hits on the device: rays in random directions, half from the walls of a room and
//! half from a bumpy sphere inside it, 8 M of them, in scenes of 0.1, 1 and 10 M triangles.
//!
//! `ray_bench [--small] [--rays N] [--triangles N]...`: medians of the device's time, for each way of
//! sharing rays out among invocations.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use backend_vulkan::{RayPlan, Vulkan};
use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    Backend, Facet, Material, RandomKind, Ray, Requirements, SceneView, Settings, TransportBackend, Units, sampling,
};

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> Result<(), Box<dyn Error>> {
    let (mut count, mut rounds, mut sizes) = (8_000_000_u32, 9, Vec::new());
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--small" => (count, rounds, sizes) = (20_000, 1, vec![2_000, 50_000]),
            "--rays" => count = value()?.parse()?,
            "--triangles" => sizes.push(value()?.parse()?),
            other => return Err(format!("{other}? ray_bench [--small] [--rays N] [--triangles N]...").into()),
        }
    }
    if sizes.is_empty() {
        sizes = vec![100_000, 1_000_000, 10_000_000];
    }
    let plans = plans();
    let mut on = Vulkan::new()?;
    println!("{}: {count} rays, medians of {rounds}, M rays/s", on.device());
    println!("{:>10} {:>7} {:>7} {:>6} {:>8} {:>9}", "triangles", "group", "shared", "busy", "groups", "M rays/s");
    let rays = rays(count);
    for size in sizes {
        let (positions, triangles) = scene(size);
        let facets = vec![Facet { normal: [0.0, 0.0, 1.0], material: 0 }; triangles.len()];
        let view = SceneView {
            positions: &positions,
            triangles: &triangles,
            facets: &facets,
            materials: &[Material { albedo: [0.5; 3], ..Material::default() }],
            lights: &[],
            light_starts: &[],
            radius: 1.0,
            units: Units::default(),
        };
        let start = Instant::now();
        let scene = on.prepare(&view, &Requirements::everything(&Settings::default()))?;
        let bytes: u64 = on.memory(&scene).iter().map(|(_, bytes)| bytes).sum();
        println!(
            "{} triangles: prepared in {:.2?}, of which the tree {:.2} s; {} MB",
            triangles.len(),
            start.elapsed(),
            scene.build_seconds,
            bytes / 1_000_000
        );
        let sample = &rays[..rays.len().min(1_000_000)];
        let first = on.cast_rays_by(&scene, sample, plans[0])?;
        for &plan in &plans[1..] {
            let apart = on.cast_rays_by(&scene, sample, plan)?.iter().zip(&first).filter(|(a, b)| a != b).count();
            if apart > 0 {
                return Err(format!("{plan:?}: {apart} of {} rays hit something else", sample.len()).into());
            }
        }
        let hits = first.iter().flatten().count();
        println!("{hits} of {} rays hit, the same by all plans", sample.len());
        for (plan, mut seconds) in plans.iter().zip(on.time_rays(&scene, &rays, &plans, rounds)?) {
            seconds.sort_by(f64::total_cmp);
            let rate = f64::from(count) / seconds[seconds.len() / 2] / 1e6;
            let RayPlan { group, shared_groups, busy, workgroups } = plan;
            println!("{:>10} {group:>7} {shared_groups:>7} {busy:>6} {workgroups:>8} {rate:>9.1}", triangles.len());
        }
    }
    Ok(())
}

/// One invocation a ray, and persistent ones.
fn plans() -> Vec<RayPlan> {
    let plain = RayPlan { group: 128, shared_groups: 0, busy: 0, workgroups: 0 };
    let mut plans = vec![plain, RayPlan { group: 64, ..plain }, RayPlan { group: 64, shared_groups: 4, ..plain }];
    for busy in [16, 24, 28, 31] {
        for (group, workgroups) in [(64, 2112), (64, 4224), (128, 1056), (128, 1584), (128, 2112), (256, 528)] {
            plans.push(RayPlan { group, busy, workgroups, ..plain });
        }
    }
    plans
}

/// A room of 12 triangles with a bumpy sphere of about `count` in it.
fn scene(count: usize) -> Mesh {
    let rings = ((count as f64) / 4.0).sqrt() as u32;
    let segments = 2 * rings;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for ring in 0..=rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let r = 0.25 * (1.0 + 0.1 * (20.0 * theta).sin() * (24.0 * phi).sin());
            let at = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            positions.push(at.map(|c| (r * c) as f32));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let at = |r: u32, s: u32| r * segments + s % segments;
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    let base = positions.len() as u32;
    for corner in 0..8_u8 {
        positions.push([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 }));
    }
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        triangles.extend([[base + a, base + b, base + c], [base + a, base + c, base + d]]);
    }
    (positions, triangles)
}

/// Half from the walls, half from the sphere, in random directions.
fn rays(count: u32) -> Vec<Ray> {
    (0..count)
        .map(|path| {
            let mut sampler = Sampler::new(RandomKind::Counter, 1, 0, Domain::Photon, path);
            let [a, b, c, d] = sampler.words(0).map(unit_f32);
            let outward = sampling::uniform_sphere(a, b);
            let (origin, normal) = if path % 2 == 0 {
                let m = outward.abs().max_element();
                let axis = if outward.x.abs() == m {
                    Vec3::X
                } else if outward.y.abs() == m {
                    Vec3::Y
                } else {
                    Vec3::Z
                };
                (outward / m * 0.499_99, -axis * outward.dot(axis).signum())
            } else {
                (outward * 0.28, outward)
            };
            Ray { origin, direction: sampling::cosine_hemisphere(normal, c, d), t_max: f32::INFINITY }
        })
        .collect()
}
