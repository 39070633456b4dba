//! Times photon emission and tracing on the device, for each way of distributing paths over invocations:
//! medians of device time.
//!
//! `trace_bench [SCENE] [--paths N] [--bounces N] [--small]`; without arguments `cornell-glass` with
//! 1 M paths.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

use std::error::Error;
use std::process::ExitCode;

use backend_vulkan::Vulkan;
use backend_vulkan::low_level::{self, TracePlan};
use photon_core::{
    Backend, Batch, MediaDeposits, Pass, PerMap, Photon, PhotonRay, RandomKind, Requirements, Scheduling, Settings,
    Stage, TransportBackend,
};

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
    let (mut name, mut paths, mut rounds) = ("cornell-glass".to_owned(), 1_000_000_u32, 9);
    let mut settings = Settings::default();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--paths" => paths = value()?.parse()?,
            "--bounces" => settings.max_bounces = value()?.parse()?,
            "--small" => (paths, rounds) = (20_000, 1),
            other if !other.starts_with('-') => other.clone_into(&mut name),
            other => return Err(format!("{other}? trace_bench [SCENE] [--paths N] [--bounces N] [--small]").into()),
        }
    }
    let scene = photon_scene::builtin(&name).ok_or_else(|| format!("no built-in scene is named {name:?}"))?.build()?;
    let view = scene.view();
    let required = Requirements::of(&view, &settings);
    let mut on = Vulkan::new()?;
    println!("{}: {name}, {paths} paths, medians of {rounds}", on.device());
    println!(
        "{:>8} {:>6} {:>8} {:>6} {:>5} {:>7} {:>9} {:>9} {:>12} {:>13}",
        "sharing", "group", "threads", "quota", "busy", "shared", "emit ms", "trace ms", "M paths/s", "M surfaces/s"
    );
    let prepared = on.prepare(&view, &required)?;
    let usual = low_level::trace_plan(&on);
    for (scheduling, plan) in plans(usual) {
        low_level::set_trace_plan(&mut on, plan);
        let settings = Settings { scheduling, ..settings.clone() };
        let mut stages = on.stages(&required, &settings)?;
        let mut rays = on.alloc::<PhotonRay>("photon rays", u64::from(paths))?;
        let capacity = u64::from(paths) * 4;
        let mut maps = PerMap::default();
        for (kind, _) in required.maps.iter().filter(|(_, required)| **required) {
            maps[kind] = Some(on.alloc::<Photon>(kind.label(), capacity)?);
        }
        let mut times = [Vec::new(), Vec::new()];
        let mut surfaces = 0;
        for round in 0..=rounds {
            for map in maps.values_mut().flatten() {
                on.clear(map)?;
            }
            on.timings()?;
            let pass = Pass { seed: 1, index: round, random: RandomKind::Counter, sample: 0, samples: 1 };
            let batch = Batch { pass, paths: 0..paths };
            on.mark(Some(Stage::Emit));
            stages.emitter.emit(&mut on, &prepared, &batch, &mut rays)?;
            on.mark(Some(Stage::Trace));
            let deposits = maps.each_mut().map(Option::as_mut);
            stages.tracer.trace(&mut on, &prepared, &batch, &rays, deposits, MediaDeposits::default())?;
            on.mark(None);
            let took = on.timings()?;
            let tally = stages.tracer.take_tally(&mut on)?;
            // The first round is a warm-up and is not counted.
            if round > 0 {
                times[0].push(took.get(Stage::Emit));
                times[1].push(took.get(Stage::Trace));
                surfaces = tally.surfaces;
            }
        }
        let [emit, trace] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        let TracePlan { group, threads, quota, busy, shared_groups, .. } = plan;
        println!(
            "{:>8} {group:>6} {threads:>8} {quota:>6} {busy:>5} {shared_groups:>7} {:>9.3} {:>9.3} {:>12.1} {:>13.1}",
            format!("{scheduling:?}").to_lowercase(),
            1e3 * emit,
            1e3 * trace,
            f64::from(paths) / (emit + trace) / 1e6,
            surfaces as f64 / trace / 1e6,
        );
    }
    Ok(())
}

/// The default plan with both schedulings, and other plans.
fn plans(usual: TracePlan) -> Vec<(Scheduling, TracePlan)> {
    let mut plans = vec![(Scheduling::Static, usual), (Scheduling::Dynamic, usual)];
    for busy in [0, 8, 16, 24] {
        for (group, threads, quota) in [(128, 1 << 17, 64), (64, 1 << 17, 64), (128, 1 << 16, 64), (128, 1 << 18, 64)] {
            plans.push((Scheduling::Dynamic, TracePlan { group, threads, quota, busy, ..usual }));
        }
    }
    plans
}
