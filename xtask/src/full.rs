//! Steps of `cargo xtask full`: they need more than Rust and a C compiler, or take long.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

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

/// Ends a process in any case.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The address of the page; unlikely to be in use.
const ADDRESS: &str = "127.0.0.1:48217";

/// Opens the page of a running render in headless Chromium, which must show passes and all layers, and draw the picture.
pub(crate) fn page() -> Result<(), String> {
    let browser = ["chromium", "chromium-browser", "google-chrome"];
    let Some(browser) = browser.into_iter().find(|name| shell::present(&[name, "--version"])) else {
        return Err("Chromium is not installed; Debian: chromium".to_owned());
    };
    shell::run(&["cargo", "build", "--locked", "-p", "photonmap-cli"], &[])?;
    let root = shell::root();
    let arguments = "render cornell-glass --backend cpu --size 64x48 --photons 20000 --errors --time 120 --serve";
    let render = Command::new(root.join("target/debug/photonmap"))
        .args(arguments.split(' '))
        .args([ADDRESS, "-o"])
        .arg(root.join("target/page.png"))
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| format!("photonmap: {error}"))?;
    let _render = Ended(render);
    let begun = Instant::now();
    let dump = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=8000", "--dump-dom"];
    let url = format!("http://{ADDRESS}/");
    let mut text = String::new();
    while begun.elapsed() < Duration::from_secs(60) {
        text = shell::capture(&[&[browser], &dump[..], &[&url]].concat()).unwrap_or_default();
        let layers = ["picture", "direct", "caustic", "indirect", "error", "claimed"];
        let listed = layers.iter().all(|layer| text.contains(&format!("value=\"{layer}\"")));
        if listed && text.contains("passes: ") && text.contains("width=\"64\" height=\"48\"") {
            return Ok(());
        }
    }
    Err(format!("the page shows no render:\n{text}"))
}
