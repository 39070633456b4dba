//! Chores of this workspace: `cargo xtask ci`, or any of its steps by name.
#![forbid(unsafe_code)]

mod book;
mod ci;
mod constants;
mod deny;
mod extremes;
mod full;
mod graph;
mod kills;
mod links;
mod listed;
mod loaders;
mod msrv;
mod outside;
mod package;
mod page;
mod python;
mod requirements;
mod shaders;
mod shell;
mod tidy;
mod wasm;

use std::process::ExitCode;

fn main() -> ExitCode {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let steps = match ci::choose(&names) {
        Ok(steps) => steps,
        Err(message) => {
            eprintln!("error: {message}\n\n{}", ci::usage());
            return ExitCode::from(2);
        }
    };
    if ci::run(&steps) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
