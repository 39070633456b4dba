//! Many threads compared with one, stage by stage, with both scheduling modes of photon paths.
//!
//! Each round renders the same pass on one thread and on more, in turn, so that a drift of the
//! machine's speed affects all; medians over rounds are compared. Rounds in which other programs
//! used more than a fiftieth of the machine are repeated, since two threads on two cores would measure
//! the other load; when the maximum number of rounds is reached, the least disturbed ones are used, and the
//! table says so. `--threads N` measures powers of two up to N; default two. `--only
//! TEXT` runs the rows whose name contains it.
#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::time::Instant;

use backend_cpu::Cpu;
use photon_benches::load::Load;
use photon_core::{Budget, Indirect, Pipeline, Plan, Scheduling, Settings, Stage, StageTimings, View, render};

const ROUNDS: usize = 15;
/// Maximum number of rounds, disturbed ones included.
const PATIENCE: usize = 60;
/// Fraction of the machine that other programs may use.
const OTHERS: f64 = 0.02;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // `cargo test --benches` runs this too, with `--test`: then one small round is enough.
    let quick = std::env::args().any(|argument| argument == "--test");
    let (rounds, patience, photons, size) = if quick { (1, 1, 2_000, 16) } else { (ROUNDS, PATIENCE, 400_000, 384) };
    let after = |flag: &str| std::env::args().skip_while(|argument| argument != flag).nth(1);
    let most: usize = after("--threads").map_or(Ok(2), |number| number.parse())?;
    let only = after("--only").unwrap_or_default();
    let threads: Vec<usize> = (0..).map(|power| 1 << power).take_while(|&count| count <= most).collect();
    let builder = photon_scene::builtin("cornell-glass").ok_or("no such scene")?;
    let scene = builder.build()?;
    for (name, indirect, scheduling) in [
        ("map, dynamic sharing", Indirect::Map, Scheduling::Dynamic),
        ("map, static sharing", Indirect::Map, Scheduling::Static),
        ("final gather", Indirect::Gather, Scheduling::Dynamic),
    ]
    .into_iter()
    .filter(|(name, ..)| name.contains(&only))
    {
        let settings = Settings { photons, indirect, scheduling, gather_rays: 4, ..Settings::default() };
        let view = View { camera: scene.camera(None, size, size)?, width: size, height: size };
        let mut pipelines = Vec::new();
        for &count in &threads {
            pipelines.push(Pipeline::new(Cpu::with_threads(count)?, &scene.view(), view, settings.clone())?);
        }
        let mut tried: Vec<(f64, Vec<StageTimings>)> = Vec::new();
        while tried.len() < patience && tried.iter().filter(|(others, _)| *others <= OTHERS).count() < rounds {
            let (load, start) = (Load::now(), Instant::now());
            let mut round = Vec::new();
            for pipeline in &mut pipelines {
                let budget = Plan { first: tried.len() as u32, ..Budget::Passes(1).into() };
                round.push(render(pipeline, budget, &mut ())?.seconds);
            }
            let others = load.and_then(|load| load.others(start.elapsed().as_secs_f64()));
            tried.push((others.unwrap_or(0.0), round));
        }
        let count = tried.len();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.truncate(rounds);
        let worst = tried.last().map_or(0.0, |(others, _)| *others);
        let median = |column: usize, stage: Stage| {
            let mut all: Vec<f64> = tried.iter().map(|(_, round)| round[column].get(stage)).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        println!(
            "\n{name}: {photons} paths, {size}x{size}, the quietest {} of {count} rounds: others took up to {:.1} %",
            tried.len(),
            100.0 * worst
        );
        let columns: String = threads[1..].iter().map(|count| format!("  {count:>3} threads  ratio")).collect();
        println!("  stage      1 thread {columns}  share");
        let total: f64 = Stage::ALL.into_iter().map(|stage| median(0, stage)).sum();
        for stage in Stage::ALL {
            let one = median(0, stage);
            if one > 0.0 {
                let columns: String = (1..threads.len())
                    .map(|column| {
                        let more = median(column, stage);
                        format!("  {more:9.4} s  {:5.2}", one / more)
                    })
                    .collect();
                println!("  {:<9} {one:8.4} s{columns}  {:4.1} %", stage.name(), 100.0 * one / total);
            }
        }
    }
    Ok(())
}
