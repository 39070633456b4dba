//! Shared helpers of the tests.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An empty folder for one test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// A command of the program.
pub(crate) fn photonmap(command: &str) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_photonmap"));
    program.arg(command);
    program
}

pub(crate) fn run(command: &str, arguments: &[&str]) -> Output {
    photonmap(command).args(arguments).output().unwrap()
}

pub(crate) fn render(arguments: &[&str]) -> Output {
    run("render", arguments)
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Fails with the program's output, unless it succeeded.
#[track_caller]
pub(crate) fn succeeded(output: &Output) {
    assert!(output.status.success(), "{output:?}");
}

/// Fails unless the program rejected its input with code 2 and one line that names the culprit.
#[track_caller]
pub(crate) fn refused(output: &Output, culprit: &str) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains(culprit), "{culprit}: {text}");
    assert!(!text.contains("panicked"), "{text}");
}

pub(crate) const SMALL: [&str; 6] = ["--size", "24x16", "--photons", "3000", "--passes", "3"];

/// Channels of an EXR file by name.
pub(crate) fn channels(path: &Path) -> BTreeMap<String, Vec<f32>> {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(path).unwrap();
    let list = image.layer_data.channel_data.list;
    list.into_iter().map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect()
}

pub(crate) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Whether a suitable device exists; prints a message if not.
pub(crate) fn has_vulkan() -> bool {
    let there = backend_vulkan::devices().is_ok_and(|found| found.iter().any(|device| device.lacks.is_empty()));
    if !there {
        let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
        assert!(!required, "Vulkan is required here");
        eprintln!("skipped: no Vulkan");
    }
    there
}

/// The passes that the page of a running render has.
pub(crate) fn passes(address: &str) -> u64 {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(b"GET /status HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let status: serde_json::Value = serde_json::from_str(text.split_once("\r\n\r\n").unwrap().1).unwrap();
    status["passes"].as_u64().unwrap()
}
