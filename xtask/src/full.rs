//! Steps of `cargo xtask full`: they need more than Rust and a C compiler, or take long.

use crate::shell;

/// Tests of `mpi/`, which start real processes.
pub(crate) fn mpi() -> Result<(), String> {
    if !shell::present(&["mpirun", "--version"]) {
        return Err("mpirun is not installed; Debian: openmpi-bin libopenmpi-dev libclang-dev".to_owned());
    }
    let target = shell::root().join("target");
    let variables = [("CARGO_TARGET_DIR", &*target.to_string_lossy())];
    let manifest = ["--manifest-path", "mpi/Cargo.toml"];
    shell::run(&[&["cargo", "fmt", "--check"], &manifest[..]].concat(), &[])?;
    shell::run(
        &[&["cargo", "clippy", "--all-targets", "--locked"], &manifest[..], &["--", "-D", "warnings"]].concat(),
        &variables,
    )?;
    shell::run(&[&["cargo", "test", "--locked"], &manifest[..]].concat(), &variables)
}

/// Combinations of the facade's features; the default one is built by other steps.
pub(crate) fn powerset() -> Result<(), String> {
    const FEATURES: [&str; 4] = ["cpu", "vulkan", "files", "serde"];
    for chosen in 0..1_u32 << FEATURES.len() {
        let names = FEATURES.iter().enumerate().filter(|(index, _)| chosen >> index & 1 == 1);
        let features = names.map(|(_, name)| *name).collect::<Vec<_>>().join(",");
        shell::run(
            &["cargo", "check", "--locked", "-p", "photonmap", "--no-default-features", "--features", &features],
            &[],
        )?;
    }
    Ok(())
}

/// Programs in C and C++, which other steps compile without the sanitizers where there are none.
pub(crate) fn sanitizer() -> Result<(), String> {
    let test = ["cargo", "test", "--locked", "-p", "photonmap-c", "--test", "programs"];
    shell::run(&test, &[("PHOTON_REQUIRE_SANITIZERS", "1")])
}
