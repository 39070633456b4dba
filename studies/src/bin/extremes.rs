//! Runs the extreme cases on every available backend and prints the results in Markdown: `cargo xtask extremes`
//! writes them to `docs/studies/extremes.csv`. With `--long`, everything; `--only NAME` for one backend, `--group NAME` for
//! one group of cases.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "results go to stdout, progress to stderr")]

use std::process::ExitCode;
use std::time::Instant;

use photon_core::Backend;
use photon_tests::backends::{OnCpu, OnVulkan};
use photon_tests::extremes::{Extent, Sheet, groups};
use photon_tests::harness::TestBackend;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let extent = if arguments.iter().any(|argument| argument == "--long") { Extent::Long } else { Extent::Quick };
    let value =
        |name: &str| arguments.iter().position(|argument| argument == name).and_then(|at| arguments.get(at + 1));
    let (only, group) = (value("--only"), value("--group").map(String::as_str));
    let wanted = |name: &str| only.is_none_or(|only| only == name);
    let mut good = true;
    if wanted("cpu") {
        good &= backend::<OnCpu>("CPU", extent, group);
    }
    if wanted("vulkan") {
        if OnVulkan::available() {
            good &= backend::<OnVulkan>("Vulkan", extent, group);
        } else {
            eprintln!("no Vulkan device: its part is left out");
            good = false;
        }
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn backend<T: TestBackend>(name: &str, extent: Extent, only: Option<&str>) -> bool {
    let device = T::make(2).device();
    println!("## {name}: {device}\n");
    let mut good = true;
    for (group, run) in groups::<T>().into_iter().filter(|(group, _)| only.is_none_or(|only| only == *group)) {
        let start = Instant::now();
        let sheet = Sheet::run(run, extent);
        let seconds = start.elapsed().as_secs_f64();
        eprintln!("{name}, {group}: {} rows in {seconds:.1} s", sheet.rows.len());
        for fault in sheet.faults() {
            eprintln!("  fails: {fault}");
            good = false;
        }
        println!("### {group}\n\n{seconds:.0} s\n\n{}", sheet.table());
    }
    good
}
