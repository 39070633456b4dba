//! The libraries without files and threads of their own also compile for browsers.

use crate::shell;

const TARGET: &str = "wasm32-unknown-unknown";
/// By package: the shared part, scenes without loaders, the CPU backend, and the facade with these.
const CHECKED: [&[&str]; 4] = [
    &["photonmap-core", "--features", "serde"],
    &["photonmap-scene", "--no-default-features", "--features", "sky"],
    &["photonmap-cpu"],
    &["photonmap", "--no-default-features", "--features", "cpu"],
];

/// Checks the libraries for WebAssembly, where its standard library is installed.
pub(crate) fn step() -> Result<(), String> {
    // `rustc` knows the folder whether or not rustup is there.
    let folder = shell::capture(&["rustc", "--print", "target-libdir", "--target", TARGET])?;
    if !std::path::Path::new(folder.trim()).is_dir() {
        eprintln!("SKIPPED: the target is not installed: rustup target add {TARGET}");
        return Ok(());
    }
    for package in CHECKED {
        // A folder of its own: dependencies with other features would displace those of the tests.
        let command = ["cargo", "check", "--locked", "--target", TARGET, "--target-dir", "target/wasm", "-p"];
        shell::run(&[&command, package].concat(), &[])?;
    }
    Ok(())
}
