//! Cost of modelling more than a scene requires: the same scene with derived requirements, and
//! with everything that the settings allow. The pictures must be identical, bit for bit.
#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use backend_cpu::Cpu;
use photon_core::{Budget, Pipeline, Plan, Render, Requirements, Settings, Stage, StageTimings, View, render};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::args().any(|argument| argument == "--test");
    let (rounds, photons, size) = if quick { (1, 2_000, 16) } else { (9, 400_000, 256) };
    for name in ["cornell", "two-rooms", "ring", "cornell-glass"] {
        let scene = photon_scene::builtin(name).ok_or("no such scene")?.build()?;
        let view = View { camera: scene.camera(None, size, size)?, width: size, height: size };
        let settings = Settings { photons, ..Settings::default() };
        let derived = Requirements::of(&scene.view(), &settings);
        let everything = Requirements::everything(&settings);
        let mut renderers = Vec::new();
        for required in [derived, everything] {
            let cpu = Cpu::new()?;
            renderers.push(Pipeline::with_requirements(cpu, &scene.view(), view, settings.clone(), required)?);
        }
        let mut seconds: [Vec<StageTimings>; 2] = [Vec::new(), Vec::new()];
        for round in 0..rounds {
            for (renderer, seconds) in renderers.iter_mut().zip(&mut seconds) {
                let budget = Plan { first: round, ..Budget::Passes(1).into() };
                seconds.push(render(renderer, budget, &mut ())?.seconds);
            }
        }
        let median = |which: usize, of: &dyn Fn(&StageTimings) -> f64| {
            let mut all: Vec<f64> = seconds[which].iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let same = renderers[0].film()?.pixels == renderers[1].film()?.pixels;
        let bytes = |which: usize| -> u64 { renderers[which].facts().memory.iter().map(|(_, bytes)| bytes).sum() };
        println!("\n{name}: requires {}; same bits: {same}", derived.features);
        println!("            derived  everything  ratio");
        let trace = |t: &StageTimings| t.get(Stage::Trace);
        let all = |t: &StageTimings| Stage::ALL.into_iter().map(|stage| t.get(stage)).sum::<f64>();
        for (what, of) in [("trace, s", &trace as &dyn Fn(&StageTimings) -> f64), ("pass, s", &all)] {
            let (a, b) = (median(0, of), median(1, of));
            println!("  {what:<8} {a:9.4}  {b:9.4}  {:.3}", b / a);
        }
        let (a, b) = (bytes(0), bytes(1));
        println!("  bytes    {a:9}  {b:9}  {:.3}", b as f64 / a as f64);
        if !same {
            return Err("the pictures differ".into());
        }
    }
    Ok(())
}
