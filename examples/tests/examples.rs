//! Runs the examples, each of which checks its own result.
#![expect(clippy::unwrap_used, reason = "test code")]

use std::process::{Command, Output};

fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program)
        .args(arguments)
        // Where the validation layer is installed, the loader enables it; it writes to standard output.
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .output()
        .unwrap()
}

#[test]
fn a_foreign_caster_gives_the_same_picture() {
    let output = run(env!("CARGO_BIN_EXE_own_caster"), &["cornell"]);
    assert!(output.status.success(), "{output:?}");
    let output = run(env!("CARGO_BIN_EXE_own_caster"), &["no-such-scene"]);
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("no-such-scene"));
}

#[test]
fn the_map_alone_estimates_irradiance() {
    let output = run(env!("CARGO_BIN_EXE_map_only"), &[]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 8);
}

#[test]
fn photons_of_a_host_never_leave_the_device_and_the_answer_is_the_closed_form() {
    let suitable = |found: &Vec<backend_vulkan::Candidate>| found.iter().any(|device| device.lacks.is_empty());
    if !backend_vulkan::devices().as_ref().is_ok_and(suitable) {
        let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
        assert!(!required, "Vulkan is required here");
        return eprintln!("skipped: no Vulkan");
    }
    for (photons, index) in [("100000", "morton"), ("20000", "median"), ("20000", "vvh")] {
        let output = run(env!("CARGO_BIN_EXE_host_device"), &[photons, index]);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{output:?}");
        assert!(!text.contains("Validation"), "{text}");
    }
    for bad in [&["5"][..], &["20000", "grid"]] {
        assert!(!run(env!("CARGO_BIN_EXE_host_device"), bad).status.success(), "{bad:?}");
    }
}
