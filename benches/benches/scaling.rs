//! Two threads against one, stage by stage, and both ways of sharing photons out.
//!
//! Each round renders the same pass on one thread and on two, in turn, so that a drift of the
//! machine's speed touches both; medians over rounds are compared.
#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use backend_cpu::Cpu;
use photon_core::{Budget, Indirect, Pipeline, Settings, Sharing, Stage, StageTimings, View, render};

const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `cargo test --benches` runs this too, with `--test`: then one small round will do.
    let quick = std::env::args().any(|argument| argument == "--test");
    let (rounds, photons, size) = if quick { (1, 2_000, 16) } else { (ROUNDS, 400_000, 384) };
    let builder = photon_scene::builtin("cornell-glass").ok_or("no such scene")?;
    let scene = builder.build()?;
    for (name, indirect, sharing) in [
        ("map, dynamic sharing", Indirect::Map, Sharing::Dynamic),
        ("map, static sharing", Indirect::Map, Sharing::Static),
        ("final gather", Indirect::Gather, Sharing::Dynamic),
    ] {
        let settings = Settings { photons, indirect, sharing, gather_rays: 4, ..Settings::default() };
        let view = View { camera: scene.camera(None, size, size)?, width: size, height: size };
        let mut seconds: [Vec<StageTimings>; 2] = [Vec::new(), Vec::new()];
        let mut pipelines = Vec::new();
        for threads in 1..=2 {
            pipelines.push(Pipeline::new(Cpu::with_threads(threads)?, &scene.view(), view, settings.clone())?);
        }
        for round in 0..rounds {
            for (pipeline, seconds) in pipelines.iter_mut().zip(&mut seconds) {
                let budget = Budget { first: round as u32, passes: 1, time: None };
                seconds.push(render(pipeline, budget, &mut ())?.seconds);
            }
        }
        let median = |threads: usize, stage: Stage| {
            let mut all: Vec<f64> = seconds[threads - 1].iter().map(|s| s.get(stage)).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let total: f64 = Stage::ALL.into_iter().map(|stage| median(1, stage)).sum();
        println!("\n{name}: {photons} paths, {size}x{size}\n  stage      1 thread  2 threads  ratio  share");
        for stage in Stage::ALL {
            let (one, two) = (median(1, stage), median(2, stage));
            if one > 0.0 {
                println!(
                    "  {:<9} {one:8.4} s {two:8.4} s  {:5.2}  {:4.1} %",
                    stage.name(),
                    one / two,
                    100.0 * one / total
                );
            }
        }
    }
    Ok(())
}
