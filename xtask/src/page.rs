//! The page of a running render, in headless Chromium.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::shell;

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

const RENDER: &str = "render cornell-glass --backend cpu --size 64x48 --photons 20000 --errors --time 120 --serve";

/// Names of Chromium.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// The page loads its data while the time of the browser passes at once.
const HEADLESS: [&str; 4] = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=8000"];

/// By how many bytes the picture of a page with a visible picture is larger, at least: 64 × 48 pixels of noise have 9 kB, and
/// black ones nearly none.
const PICTURE: u64 = 3000;

/// Opens the page of a running render. It must show passes and all layers, and draw the picture; with the exposure at its
/// lowest, the picture is black; and the map of errors is another picture.
pub(crate) fn step() -> Result<(), String> {
    let Some(browser) = BROWSERS.into_iter().find(|name| shell::present(&[name, "--version"])) else {
        return Err("Chromium is not installed; Debian: chromium".to_owned());
    };
    shell::run(&["cargo", "build", "--locked", "-p", "photonmap-cli"], &[])?;
    let root = shell::root();
    let render = Command::new(root.join("target/debug/photonmap"))
        .args(RENDER.split(' '))
        .args([ADDRESS, "-o"])
        .arg(root.join("target/page.png"))
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| format!("photonmap: {error}"))?;
    let _render = Ended(render);
    wait_for_passes(browser)?;

    let dark = screenshot(browser, "layer=picture&exposure=-10")?;
    for (what, address) in [("picture", "layer=picture&exposure=0"), ("map of errors", "layer=claimed&exposure=4")] {
        let bright = screenshot(browser, address)?;
        if bright < dark + PICTURE {
            return Err(format!(
                "the {what} is not visible: {bright} bytes at #{address}, {dark} with a black picture"
            ));
        }
        eprintln!("{what}: {bright} bytes, {dark} with a black picture");
    }
    let text = dump(browser, "layer=claimed&exposure=2.5")?;
    if !text.contains("<output id=\"stops\">2.5</output>") {
        return Err(format!("the exposure is not that of the address:\n{text}"));
    }
    Ok(())
}

/// Opens the page until it shows passes, all layers and a picture of the right size.
fn wait_for_passes(browser: &str) -> Result<(), String> {
    let begun = Instant::now();
    let mut text = String::new();
    while begun.elapsed() < Duration::from_secs(60) {
        // The server may not be there yet.
        text = dump(browser, "").unwrap_or_default();
        let layers = ["picture", "direct", "caustic", "indirect", "error", "claimed"];
        let listed = layers.iter().all(|layer| text.contains(&format!("value=\"{layer}\"")));
        if listed && text.contains("passes: ") && text.contains("width=\"64\" height=\"48\"") {
            return Ok(());
        }
    }
    Err(format!("the page shows no render:\n{text}"))
}

/// The page after its scripts have run.
fn dump(browser: &str, fragment: &str) -> Result<String, String> {
    let url = format!("http://{ADDRESS}/#{fragment}");
    shell::capture(&[&[browser], &HEADLESS[..], &["--dump-dom", &url]].concat())
}

/// Bytes of a picture of the page.
fn screenshot(browser: &str, fragment: &str) -> Result<u64, String> {
    let file = shell::root().join("target/page-screen.png");
    // It may not be there.
    let _ = fs::remove_file(&file);
    let (to, url) = (format!("--screenshot={}", file.display()), format!("http://{ADDRESS}/#{fragment}"));
    shell::capture(&[&[browser], &HEADLESS[..], &["--window-size=600,300", &to, &url]].concat())?;
    fs::metadata(&file).map(|found| found.len()).map_err(|error| format!("{}: {error}", file.display()))
}
