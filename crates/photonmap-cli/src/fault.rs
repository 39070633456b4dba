//! Errors of the programs ([`photon_image::fault`]), printed, and exit codes.

use std::process::ExitCode;

pub use photon_image::fault::{Fault, chain, check_regular};

/// Runs `program`; prints an error to stderr and returns its exit code.
pub fn run(program: impl FnOnce() -> Result<(), Fault>) -> ExitCode {
    program().map_or_else(|fault| ExitCode::from(report(&fault)), |()| ExitCode::SUCCESS)
}

/// Prints a fault; returns its exit code.
fn report(fault: &Fault) -> u8 {
    match fault {
        Fault::Several(faults) => faults.iter().map(report).collect::<Vec<_>>().first().copied().unwrap_or(1),
        Fault::Interrupted(line) => {
            say!("{line}");
            INTERRUPTED
        }
        Fault::Input(_) | Fault::OverMemory(_) => {
            say!("error: {fault}");
            2
        }
        Fault::Failure(_) => {
            say!("error: {fault}");
            1
        }
    }
}

/// The exit code of a program that was interrupted, as shells give it: 128 and the number of SIGINT.
pub const INTERRUPTED: u8 = 130;
