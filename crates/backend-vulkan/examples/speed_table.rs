//! Performance targets of this backend on a large GPU, in one table: medians of device time, each beside the
//! target and the fastest known competitor.
//!
//! `speed_table [--small] [--no-cpu]`: `--small` for a software device; without `--no-cpu`, whole passes are
//! also rendered on the CPU, which takes a minute on 16 cores.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

#[path = "bench/points.rs"]
mod points;
#[path = "bench/room.rs"]
mod room;

use std::error::Error;
use std::f32::consts::PI;
use std::process::ExitCode;
use std::time::Instant;

use backend_cpu::Cpu;
use backend_vulkan::low_level::{self, RayPlan};
use backend_vulkan::{Vulkan, VulkanMap};
use photon_core::{
    Backend, Estimate, EstimateParams, IndexKind, PassEnd, Photon, Pipeline, Render, Requirements, Search, Settings,
    Stage, TransportBackend, View,
};

const KINDS: [IndexKind; 3] = [IndexKind::Morton, IndexKind::Median, IndexKind::Vvh];
/// Measured runs, and warm-up runs before them: while the host works, the device lowers its clocks.
const RUNS: usize = 9;
const WARM: usize = 4;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    let has = |name: &str| std::env::args().any(|argument| argument == name);
    match run(has("--small"), !has("--no-cpu")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(small: bool, cpu: bool) -> Outcome<()> {
    let mut on = Vulkan::new()?;
    println!("{}, {}", on.limits().name, on.limits().driver);
    println!("\n| work | asked | rival | Morton | median | VVH |\n|---|--:|--:|--:|--:|--:|");
    // Targets, and figures of competitors (named in docs/studies/performance.md): at 1 M, at 10 M.
    let sizes = if small { [2_000, 10_000] } else { [1_000_000, 10_000_000] };
    for (at, count) in sizes.into_iter().enumerate() {
        maps(&mut on, count, at, if small { (64, 36) } else { (1920, 1080) })?;
    }
    println!("\n| work | asked | rival | seen |\n|---|--:|--:|--:|");
    let counts = if small { [1_000, 4_000, 16_000] } else { [100_000, 1_000_000, 10_000_000] };
    for (count, asked) in counts.into_iter().zip([("1000", "964"), ("800", "664"), ("400", "270")]) {
        rays(&mut on, count, asked, if small { 10_000 } else { 8_000_000 })?;
    }
    passes(on, small, cpu)
}

/// Builds, k-NN and radius searches for one number of photons.
fn maps(on: &mut Vulkan, count: usize, at: usize, picture: (usize, usize)) -> Outcome<()> {
    let asked = |both: [&'static str; 2]| both[at];
    for (set, photons) in [("walls", points::walls(count)), ("caustic", points::caustic(count))] {
        // On the caustic set, the radius would hold thousands of photons.
        let searches = if set == "walls" { 3 } else { 2 };
        let (mut build, mut fifty, mut many, mut radius) = (vec![], vec![], vec![], vec![]);
        for kind in KINDS {
            let figures = map(on, &photons, kind, picture, searches)?;
            build.push(format!("{:.2} ms", figures[0]));
            for (column, figure) in [&mut fifty, &mut many, &mut radius].into_iter().zip(&figures[1..]) {
                column.push(format!("{figure:.1} M/s"));
            }
        }
        let goals = asked(["1 / 5 / – ms", "8 / 40 / – ms"]);
        let rows = [
            ("build", goals, asked(["10.4 ms", "78.6 ms"]), &build),
            ("k-NN, k = 50", ask(set, [260, 140], at), asked(["130", "69"]), &fifty),
            ("k-NN, k = 200", ask(set, [60, 30], at), asked(["9.7", "3.2"]), &many),
            ("radius, about 50 inside", "600 M/s", "–", &radius),
        ];
        for (what, goal, rival, seen) in rows.into_iter().take(1 + searches) {
            let rival = if set == "walls" { rival } else { "–" };
            println!("| {what}, {set}, {count} | {goal} | {rival} | {} |", seen.join(" | "));
        }
    }
    Ok(())
}

/// The target; on the caustic set, half of the target on walls.
fn ask(set: &str, all: [u32; 2], at: usize) -> &'static str {
    match (set == "walls", all[at]) {
        (true, 260) => "260 M/s",
        (true, 140) => "140 M/s",
        (true, 60) => "60 M/s",
        (true, _) => "30 M/s",
        (false, 260) => "130 M/s",
        (false, 140) => "70 M/s",
        (false, 60) => "30 M/s",
        (false, _) => "15 M/s",
    }
}

/// Milliseconds of a build, then millions of queries per second for the first `searches` of: k = 50, k = 200,
/// radius.
fn map(
    on: &mut Vulkan,
    photons: &[Photon],
    kind: IndexKind,
    (width, height): (usize, usize),
    searches: usize,
) -> Outcome<[f64; 4]> {
    let mut stages = on.map_stages(kind)?;
    let mut build = Vec::new();
    let mut map: Option<VulkanMap> = None;
    for _ in 0..WARM + RUNS {
        // Dropping the previous map frees its memory.
        drop(map.take());
        let uploaded = on.upload("photons: global", photons)?;
        let _ = on.timings()?;
        on.mark(Some(Stage::Build));
        map = Some(stages.builder.build(on, uploaded)?);
        on.mark(None);
        build.push(on.timings()?.get(Stage::Build) * 1e3);
    }
    let map = map.ok_or("no map")?;
    let radius = (50.0 / (PI * photons.len() as f32 / 5.0)).sqrt();
    let queries = points::rows(width, height, radius);
    let queries = on.upload("queries", &queries)?;
    let mut estimates = on.alloc::<Estimate>("estimates", queries.capacity())?;
    let mut figures = [median(&mut build[WARM..]), 0.0, 0.0, 0.0];
    let nearest = |k| (Search::KNearest { k }, 10.0 / radius);
    for (figure, (search, radius_scale)) in
        figures[1..].iter_mut().zip([nearest(50), nearest(200), (Search::Radius, 1.0)]).take(searches)
    {
        let gather = EstimateParams { radius_scale, ..EstimateParams::new(search) };
        let mut all = Vec::new();
        for _ in 0..WARM + RUNS {
            let _ = on.timings()?;
            on.mark(Some(Stage::Estimate));
            stages.estimator.estimate(on, &map, &queries, &gather, &mut estimates)?;
            on.mark(None);
            all.push(on.timings()?.get(Stage::Estimate));
        }
        *figure = queries.capacity() as f64 / median(&mut all[WARM..]) / 1e6;
    }
    Ok(figures)
}

fn rays(on: &mut Vulkan, count: usize, (asked, rival): (&str, &str), rays: u32) -> Outcome<()> {
    let mesh = room::scene(count);
    let scene = room::with_view(&mesh, |view| on.prepare(view, &Requirements::everything(&Settings::default())))?;
    let plan = RayPlan::for_subgroups(on.limits().subgroup_size);
    // Runs for a third of a second, so that clocks recover after the BVH build on the host.
    let rounds = if rays < 1_000_000 { 3 } else { 200 };
    let mut seconds = low_level::time_rays(on, &scene, &room::rays(rays), &[plan], rounds)?.swap_remove(0);
    let seen = f64::from(rays) / median(&mut seconds[rounds as usize / 2..]) / 1e6;
    println!("| closest hit, {} triangles | {asked} M/s | {rival} | {seen:.0} M/s |", mesh.1.len());
    Ok(())
}

/// Whole passes on both backends.
fn passes(on: Vulkan, small: bool, cpu: bool) -> Outcome<()> {
    let (width, height) = if small { (96, 54) } else { (1920, 1080) };
    let scene = photon_scene::builtin("cornell-glass").ok_or("no built-in scene is named cornell-glass")?.build()?;
    let view = View { camera: scene.camera(None, width, height)?, width, height };
    let settings = Settings { photons: if small { 10_000 } else { 1_000_000 }, ..Settings::default() };
    let mut there = Pipeline::new(on, &scene.view(), view, settings.clone())?;
    let (device, wall) = timed(&mut there, if small { 3 } else { 50 })?;
    println!("| passes of cornell-glass, device's clock | 60/s | – | {:.1}/s |", 1.0 / device);
    println!("| the same, clock on the wall | 60/s | – | {:.1}/s |", 1.0 / wall);
    if cpu {
        let processor = Cpu::new()?;
        let threads = processor.threads();
        let mut here = Pipeline::new(processor, &scene.view(), view, settings)?;
        let (_, here) = timed(&mut here, 3)?;
        println!("| the same by the processor, {threads} threads | – | – | {:.2}/s |", 1.0 / here);
        println!("| how many times as fast | 20 | – | {:.1} |", here / wall);
    }
    Ok(())
}

/// Median seconds of all stages, and wall-clock seconds, per pass, after as many warm-up passes.
fn timed<B: TransportBackend>(pipeline: &mut Pipeline<B>, passes: u32) -> Outcome<(f64, f64)> {
    for index in 0..passes {
        pipeline.pass(index, &mut ())?;
    }
    let mut stages = Vec::new();
    let start = Instant::now();
    for index in passes..2 * passes {
        if let PassEnd::Done(report) | PassEnd::Last(report) = pipeline.pass(index, &mut ())? {
            stages.push(report.seconds.total());
        }
    }
    let wall = start.elapsed().as_secs_f64() / f64::from(passes);
    Ok((median(&mut stages), wall))
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
