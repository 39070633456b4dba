//! Lists the Vulkan devices of this machine, and what each one lacks. Exit code 1 if none is suitable.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

use std::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    let devices = match backend_vulkan::devices() {
        Ok(devices) => devices,
        Err(error) => {
            eprintln!("{error}: {}", error.source().map_or_else(String::new, ToString::to_string));
            return ExitCode::FAILURE;
        }
    };
    for device in &devices {
        let (major, minor) = device.version;
        let verdict = if device.lacks.is_empty() { "suitable".to_owned() } else { device.lacks.join(", ") };
        println!("{}: {}, {}, Vulkan {major}.{minor}: {verdict}", device.index, device.name, device.kind);
    }
    if devices.iter().any(|device| device.lacks.is_empty()) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
