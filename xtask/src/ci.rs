//! The steps of `cargo xtask ci`, each of which can be run by name.

use std::fmt::Write as _;
use std::time::Instant;

use crate::{
    book, constants, deny, extremes, full, kills, loaders, msrv, outside, package, page, python, requirements, shaders,
    shell, tidy, wasm,
};

/// A check that passes or fails.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    name: &'static str,
    what: &'static str,
    run: fn() -> Result<(), String>,
}

/// In this order: the fastest checks come first; the tests come last, so that the closing line of
/// their runner ends the output.
const STEPS: [Step; 12] = [
    Step { name: "fmt", what: "formatting", run: fmt },
    Step { name: "tidy", what: "rules for the files themselves", run: tidy::step },
    Step { name: "links", what: "links and table of contents of the documentation", run: book::links },
    Step { name: "loaders", what: "backends are built without the parsers of scene files", run: loaders::step },
    Step { name: "msrv", what: "the oldest compiler promised", run: msrv::step },
    Step {
        name: "shaders-fresh",
        what: "committed SPIR-V is what the GLSL compiles to, and valid",
        run: shaders::fresh,
    },
    Step { name: "clippy", what: "lints, warnings are errors", run: clippy },
    Step { name: "features", what: "the libraries without their optional parts", run: features },
    Step { name: "doc", what: "documentation, warnings are errors", run: doc },
    Step { name: "doctest", what: "examples in the documentation", run: doctest },
    Step {
        name: "outside",
        what: "examples of the README, with `photonmap` as the only dependency",
        run: outside::step,
    },
    Step { name: "test", what: "all other tests", run: test },
];

/// Steps of `full`: they compile other programs, need Python, Dask, MPI, a browser or sanitizers, or take long.
const FULL: [Step; 11] = [
    Step { name: "deny", what: "licences, versions and sources of the dependencies", run: deny::step },
    Step { name: "book", what: "docs/ as a book in target/book", run: book::step },
    Step { name: "python", what: "the Python package, in a virtual environment", run: python::step },
    Step { name: "dask", what: "workers of Dask, after the step python", run: python::dask },
    Step { name: "mpi", what: "photonmap-mpi with processes of this host", run: full::mpi },
    Step { name: "page", what: "the page of a running render, in headless Chromium", run: page::step },
    Step { name: "kills", what: "a render that is killed up to fifty times", run: kills::step },
    Step {
        name: "sanitizer",
        what: "programs in C and C++ under the sanitizers of the compiler",
        run: full::sanitizer,
    },
    Step { name: "powerset", what: "every combination of features of the facade", run: full::powerset },
    Step { name: "wasm", what: "the libraries for WebAssembly, if its target is installed", run: wasm::step },
    Step { name: "package", what: "the packages for a registry, compiled from their archives", run: package::step },
];

/// Steps that write instead of checking.
const WRITERS: [Step; 6] = [
    Step { name: "constants", what: "write the numbers that GLSL shares with Rust", run: constants::write },
    Step { name: "shaders", what: "the same, then compile the GLSL, write the SPIR-V", run: shaders::write },
    Step { name: "extremes", what: "write docs/studies/extremes.csv from a run, two minutes", run: extremes::quick },
    Step { name: "extremes-long", what: "write docs/studies/extremes-long.csv, most of an hour", run: extremes::long },
    Step {
        name: "extremes-rows",
        what: "write it from out/extremes-long.md, printed by `extremes --long` on another machine",
        run: extremes::elsewhere,
    },
    Step {
        name: "requirements",
        what: "write docs/studies/data/requirements.txt, some minutes",
        run: requirements::write,
    },
];

/// A check of the day, by `.github/workflows/nightly.yml`.
const NIGHTLY: [Step; 1] = [Step {
    name: "advisories",
    what: "known vulnerabilities of the dependencies, from the network",
    run: deny::advisories,
}];

/// The steps with the given names, in that order; `ci` stands for all that a change must pass, `full` for those that are run
/// before a release.
///
/// # Errors
///
/// No name, or one that is not a step.
pub(crate) fn choose(names: &[String]) -> Result<Vec<Step>, String> {
    if names.is_empty() {
        return Err("no step named".to_owned());
    }
    let mut chosen = Vec::new();
    for name in names {
        if name == "ci" {
            chosen.extend(STEPS);
        } else if name == "full" {
            chosen.extend(FULL);
        } else {
            let known = STEPS.iter().chain(&FULL).chain(&WRITERS).chain(&NIGHTLY).find(|step| step.name == name);
            chosen.push(*known.ok_or_else(|| format!("no step is named {name:?}"))?);
        }
    }
    Ok(chosen)
}

/// The usage text.
pub(crate) fn usage() -> String {
    let mut text = "usage: cargo xtask STEP...\n\n  ci            all of the following, in this order\n".to_owned();
    let full: Vec<&str> = FULL.iter().map(|step| step.name).collect();
    let _ = writeln!(text, "  full          {}", full.join(", "));
    for step in STEPS.iter().chain(&FULL).chain(&WRITERS).chain(&NIGHTLY) {
        let _ = writeln!(text, "  {:<13} {}", step.name, step.what);
    }
    text
}

/// Runs every step, also after a failure, and returns whether all passed.
pub(crate) fn run(steps: &[Step]) -> bool {
    let mut table = String::new();
    let mut passed = true;
    for (index, step) in steps.iter().enumerate() {
        eprintln!("\n=== {} ({} of {}): {}", step.name, index + 1, steps.len(), step.what);
        let start = Instant::now();
        let result = (step.run)();
        let seconds = start.elapsed().as_secs_f64();
        let verdict = if result.is_ok() { "ok" } else { "FAILED" };
        let _ = writeln!(table, "  {:<13} {seconds:>7.1} s  {verdict}", step.name);
        if let Err(message) = result {
            passed = false;
            eprintln!("error: {}: {message}", step.name);
        }
        // The time of the last step is in the table, or irrelevant if it ran alone.
        if index + 1 < steps.len() {
            eprintln!("    {} {verdict} after {seconds:.1} s", step.name);
        }
    }
    if steps.len() > 1 {
        eprint!("\n{table}");
    }
    passed
}

fn fmt() -> Result<(), String> {
    shell::run(&["cargo", "fmt", "--all", "--check"], &[])
}

fn clippy() -> Result<(), String> {
    shell::run(&["cargo", "clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"], &[])
}

fn features() -> Result<(), String> {
    // One call each: cargo unifies the features of packages that it builds together.
    for package in ["photonmap-core", "photonmap-scene", "photonmap-cpu", "photonmap-vulkan", "photonmap"] {
        let command = ["cargo", "clippy", "--locked", "--no-default-features", "-p", package, "--", "-D", "warnings"];
        shell::run(&command, &[])?;
    }
    Ok(())
}

fn doc() -> Result<(), String> {
    shell::run(&["cargo", "doc", "--workspace", "--no-deps", "--locked"], &[("RUSTDOCFLAGS", "-D warnings")])
}

// The benchmarks are linted, but neither built nor run here: the libraries they compare with take longer to compile
// than everything else.

fn doctest() -> Result<(), String> {
    shell::run(
        &[
            "cargo",
            "test",
            "--doc",
            "--workspace",
            "--exclude",
            "photon-benches",
            "--exclude",
            "xtask-shaders",
            "--locked",
        ],
        &[],
    )
}

fn test() -> Result<(), String> {
    let selection = ["--workspace", "--exclude", "photon-benches", "--exclude", "xtask-shaders", "--locked"];
    let vulkan = vulkan_is_here();
    if shell::present(&["cargo", "nextest", "--version"]) {
        let without = ["-E", "not (package(photonmap-vulkan) or binary(vulkan) or binary(equivalence))"];
        let without: &[&str] = if vulkan { &[] } else { &without };
        return shell::run(&[&["cargo", "nextest", "run"], selection.as_slice(), without].concat(), &[]);
    }
    eprintln!("cargo-nextest is not installed: cargo test runs the same tests");
    let targets = ["--lib", "--bins", "--tests", "--no-fail-fast"];
    shell::run(&[&["cargo", "test"], selection.as_slice(), &targets].concat(), &[])
}

/// Whether tests of Vulkan can run. If not, and they are not required, they are skipped: nextest counts
/// them as skipped, and under `cargo test` each prints a message.
fn vulkan_is_here() -> bool {
    let devices = ["cargo", "run", "--quiet", "--locked", "-p", "photonmap-vulkan", "--example", "devices"];
    let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
    let here = shell::run(&devices, &[]).is_ok();
    if !here && !required {
        eprintln!(
            "SKIPPED: no Vulkan here, so the tests of photonmap-vulkan are not run (the lines above say what it lacks)"
        );
    }
    here || required
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(asked: &[&str]) -> Result<Vec<&'static str>, String> {
        let asked: Vec<String> = asked.iter().map(|&name| name.to_owned()).collect();
        choose(&asked).map(|steps| steps.iter().map(|step| step.name).collect())
    }

    #[test]
    fn steps_are_chosen_by_name() {
        assert_eq!(names(&["test", "fmt"]).unwrap(), ["test", "fmt"]);
        assert_eq!(names(&["ci"]).unwrap().len(), STEPS.len());
        assert_eq!(names(&["ci"]).unwrap().last(), Some(&"test"));
    }

    #[test]
    fn an_unknown_step_is_named() {
        assert!(names(&["fmt", "formt"]).unwrap_err().contains("formt"));
        assert!(names(&[]).is_err());
    }

    #[test]
    fn one_failure_fails_the_run_but_stops_nothing() {
        let good = Step { name: "good", what: "", run: || Ok(()) };
        let bad = Step { name: "bad", what: "", run: || Err("for the test".to_owned()) };
        assert!(run(&[good, good]));
        assert!(!run(&[bad, good]));
        assert!(!run(&[good, bad]));
        assert!(!run(&[bad]));
    }
}
