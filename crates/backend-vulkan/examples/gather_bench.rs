//! Queries per second of k-NN and radius searches, by device timestamps: medians of five runs, with minimum and
//! maximum in milliseconds. `--small` for a software device; or numbers of photons; `--only WORDS` runs only
//! the benchmarks whose description contains the words, as in `--only "Median, rows"`.
//!
//! Photons are distributed uniformly over five walls of a box ("walls"), or nine tenths of them in a disc of
//! radius 0.05 on the floor, with density 1/r ("caustic"). Queries are on the floor and the back wall, one per
//! pixel of an image, in row order or shuffled.
#![expect(clippy::print_stdout, reason = "a program's output")]

#[path = "bench/points.rs"]
mod points;

use std::f32::consts::PI;

use backend_vulkan::{Vulkan, VulkanBuffer, VulkanMap, low_level};
use photon_core::random::SplitMix64;
use photon_core::{
    Backend, Estimate, EstimateParams, IndexKind, Kernel, MapStages, Photon, Query, Result, Search, Stage,
};
use points::{caustic, rows, walls};

const WARM: usize = 1;
const RUNS: usize = 5;

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let small = arguments.iter().any(|argument| argument == "--small");
    let mut sizes: Vec<usize> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = if small { vec![10_000] } else { vec![1_000_000, 10_000_000] };
    }
    let (width, height) = if small { (64, 36) } else { (1920, 1080) };
    let only = arguments.iter().position(|argument| argument == "--only").and_then(|at| arguments.get(at + 1));
    let only = only.map_or("", String::as_str);
    let mut on = Vulkan::new()?;
    println!("{}, {}; {} queries", on.limits().name, on.limits().driver, width * height);
    println!("{:<52} {:>9} {:>10} {:>9} {:>9} {:>9}", "work", "photons", "M/s", "median ms", "least", "greatest");
    for count in sizes {
        for (set, photons) in [("walls", walls(count)), ("caustic", caustic(count))] {
            for kind in [IndexKind::Morton, IndexKind::Median, IndexKind::Vvh] {
                run(&mut on, &format!("{set}, {kind:?}"), &photons, kind, (width, height), only)?;
            }
        }
    }
    Ok(())
}

fn run(
    on: &mut Vulkan,
    map_name: &str,
    photons: &[Photon],
    kind: IndexKind,
    (width, height): (usize, usize),
    only: &str,
) -> Result<()> {
    let mut stages = on.map_stages(kind)?;
    let uploaded = on.upload("photons: global", photons)?;
    let map = stages.builder.build(on, uploaded)?;
    let radius = (50.0 / (PI * photons.len() as f32 / 5.0)).sqrt();
    let rows = rows(width, height, radius);
    let nearest = |k: u32, kernel: Kernel, min_normal_cosine: f32| EstimateParams {
        kernel,
        // The radius does not limit the search.
        radius_scale: 10.0 / radius,
        min_normal_cosine,
        ..EstimateParams::new(Search::KNearest { k })
    };
    let within = EstimateParams::new(Search::Radius);
    for (order, queries) in [("rows", rows.clone()), ("shuffled", shuffled(&rows))] {
        let queries = on.upload("queries", &queries)?;
        let mut work = vec![
            ("k = 50", nearest(50, Kernel::Constant, -1.0)),
            ("k = 200", nearest(200, Kernel::Constant, -1.0)),
            ("k = 50, Epanechnikov, normals", nearest(50, Kernel::Epanechnikov, 0.5)),
        ];
        if map_name.starts_with("walls") {
            let kernel = Kernel::Epanechnikov;
            work.push(("radius of 50", within));
            work.push((
                "radius of 50, Epanechnikov, normals",
                EstimateParams { kernel, min_normal_cosine: 0.5, ..within },
            ));
        }
        for (what, gather) in work {
            let name = format!("{map_name}, {order}: {what}");
            if name.contains(only) {
                estimates(on, &mut stages, &map, &queries, &gather, &name)?;
            }
            let name = format!("{map_name}, {order}, not sorted: {what}");
            if order == "rows" && name.contains(only) {
                let sorting = std::mem::replace(&mut stages.estimator, low_level::estimator_without_sorting());
                estimates(on, &mut stages, &map, &queries, &gather, &name)?;
                stages.estimator = sorting;
            }
        }
        for k in [50, 200] {
            let name = format!("{map_name}, {order}: rows of {k} ids");
            if kind != IndexKind::Vvh && name.contains(only) {
                time(on, &name, map.length(), queries.capacity(), |on| on.nearest(&map, &queries, k, 10.0).map(drop))?;
            }
        }
    }
    Ok(())
}

/// Times estimates, and prints the mean number of photons found.
fn estimates(
    on: &mut Vulkan,
    stages: &mut MapStages<Vulkan>,
    map: &VulkanMap,
    queries: &VulkanBuffer<Query>,
    gather: &EstimateParams,
    name: &str,
) -> Result<()> {
    let mut estimates = on.alloc::<Estimate>("estimates", queries.capacity())?;
    stages.estimator.estimate(on, map, queries, gather, &mut estimates)?;
    let mut found = Vec::new();
    on.download(&estimates, &mut found)?;
    let mean = found.iter().map(|estimate| f64::from(estimate.photons)).sum::<f64>() / found.len() as f64;
    let name = format!("{name} ({mean:.0})");
    time(on, &name, map.length(), queries.capacity(), |on| {
        stages.estimator.estimate(on, map, queries, gather, &mut estimates)
    })
}

fn time(
    on: &mut Vulkan,
    name: &str,
    photons: u32,
    queries: u64,
    mut work: impl FnMut(&mut Vulkan) -> Result<()>,
) -> Result<()> {
    let mut all = Vec::new();
    for turn in 0..WARM + RUNS {
        let _ = on.timings()?;
        on.mark(Some(Stage::Estimate));
        work(on)?;
        on.mark(None);
        let seconds = on.timings()?.get(Stage::Estimate);
        if turn >= WARM {
            all.push(seconds * 1e3);
        }
    }
    all.sort_unstable_by(f64::total_cmp);
    let (least, median, greatest) = (all[0], all[all.len() / 2], all[all.len() - 1]);
    let rate = queries as f64 / median / 1e3;
    println!("{name:<52} {photons:>9} {rate:>10.1} {median:>9.3} {least:>9.3} {greatest:>9.3}");
    Ok(())
}

/// The same queries in random order.
fn shuffled(rows: &[Query]) -> Vec<Query> {
    let mut random = SplitMix64(3);
    let mut all = rows.to_vec();
    for at in (1..all.len()).rev() {
        all.swap(at, (random.word() % (at as u64 + 1)) as usize);
    }
    all
}
