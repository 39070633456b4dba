//! The program `photonmap`.

use std::process::ExitCode;

fn main() -> ExitCode {
    photonmap_cli::command::main()
}
