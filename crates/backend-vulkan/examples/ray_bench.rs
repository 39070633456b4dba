//! Times closest hits on the device: rays in random directions, half from the walls of a room and half from a
//! bumpy sphere inside it, 8 M of them, in scenes of 0.1, 1 and 10 M triangles.
//!
//! `ray_bench [--small] [--rays N] [--triangles N]...`: median device time for each way of distributing rays
//! over invocations.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

#[path = "bench/room.rs"]
mod room;

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use backend_vulkan::Vulkan;
use backend_vulkan::low_level::{self, RayPlan};
use photon_core::{Backend, Requirements, Settings, TransportBackend};
use room::{rays, scene, with_view};

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
        let mesh = scene(size);
        let start = Instant::now();
        let everything = Requirements::everything(&Settings::default());
        let scene = with_view(&mesh, |view| on.prepare(view, &everything))?;
        let triangles = &mesh.1;
        let bytes: u64 = on.memory(&scene).iter().map(|(_, bytes)| bytes).sum();
        println!(
            "{} triangles: prepared in {:.2?}, BVH build {:.2} s; {} MB",
            triangles.len(),
            start.elapsed(),
            scene.build_seconds,
            bytes / 1_000_000
        );
        let sample = &rays[..rays.len().min(1_000_000)];
        let first = low_level::cast_rays(&mut on, &scene, sample, plans[0])?;
        for &plan in &plans[1..] {
            let apart =
                low_level::cast_rays(&mut on, &scene, sample, plan)?.iter().zip(&first).filter(|(a, b)| a != b).count();
            if apart > 0 {
                return Err(format!("{plan:?}: {apart} of {} rays have different hits", sample.len()).into());
            }
        }
        let hits = first.iter().flatten().count();
        println!("{hits} of {} rays hit, identical for all plans", sample.len());
        for (plan, mut seconds) in plans.iter().zip(low_level::time_rays(&mut on, &scene, &rays, &plans, rounds)?) {
            seconds.sort_by(f64::total_cmp);
            let rate = f64::from(count) / seconds[seconds.len() / 2] / 1e6;
            let RayPlan { group, shared_groups, busy, workgroups } = plan;
            println!("{:>10} {group:>7} {shared_groups:>7} {busy:>6} {workgroups:>8} {rate:>9.1}", triangles.len());
        }
    }
    Ok(())
}

/// One ray per invocation, and persistent invocations.
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
