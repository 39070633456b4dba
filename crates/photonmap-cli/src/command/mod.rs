//! The commands of `photonmap`.

pub mod compare;
pub mod decided;
pub mod devices;
pub mod explain;
pub mod export;
pub mod info;
mod lost;
pub mod manual;
pub mod map;
mod map_scale;
mod map_search;
pub mod merge;
pub mod outlook;
pub mod picture;
mod refusal;
pub mod render;
mod render_blocks;
mod render_film;
mod render_passes;
pub mod scenes;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::args::{ExplainArgs, RenderArgs, set};
use crate::fault::{self, Fault};
use crate::signals;

/// Photon mapping: renders scenes, searches photon maps, compares pictures.
#[derive(Debug, Parser)]
#[command(name = "photonmap", version, propagate_version = true, arg_required_else_help = true, after_help = AFTER)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    command: Command,
}

const AFTER: &str = "Exit codes: 0 success, 1 failure, 2 wrong option or input, 130 interrupted.";

const AFTER_RENDER: &str = "\
The picture is written when rendering is done or interrupted with Ctrl-C, SIGTERM or SIGHUP. Progress and warnings go to standard error.

Examples:
  photonmap render                                       the default scene, to cornell-glass.png
  photonmap render ring --preset final -o ring.exr
  photonmap render room.glb --time 60 -o room.png
  photonmap render room.obj --overrides room.toml --target-error 0.03 -o room.exr
  photonmap render car.glb --environment studio.exr --environment-rotate 90 -o car.png
  photonmap render house.glb --environment sky:30,3 -o house.png
  photonmap render house.glb --passes 4096 --film house.film -o house.exr      again after an interruption: continues";

#[derive(Debug, Subcommand)]
enum Command {
    #[command(after_long_help = AFTER_RENDER)]
    Render(Box<RenderArgs>),
    Map(map::MapArgs),
    /// List the built-in scenes.
    Scenes,
    Devices(devices::DevicesArgs),
    Explain(Box<ExplainArgs>),
    Compare(compare::CompareArgs),
    Export(export::ExportArgs),
    Merge(merge::MergeArgs),
    Info(info::InfoArgs),
    Picture(picture::PictureArgs),
    Completions(manual::CompletionsArgs),
    Man(manual::ManArgs),
}

/// Runs the program with the arguments of the process; errors go to standard error.
#[must_use]
pub fn main() -> ExitCode {
    signals::ignore_file_size_limit();
    let given: Vec<OsString> = std::env::args_os().collect();
    let arguments = set::expanded(given.iter().cloned());
    match Cli::try_parse_from(&arguments) {
        Ok(cli) => fault::run(|| run(&cli.command)),
        Err(error) => refusal::report(error, &given, &arguments),
    }
}

fn run(command: &Command) -> Result<(), Fault> {
    match command {
        Command::Render(args) if args.list => scenes::run(),
        Command::Render(args) if args.devices => devices::run(&devices::DevicesArgs::default()),
        Command::Render(args) if args.explain => {
            let (scene, settings, machine) = (args.scene.clone(), args.settings.clone(), args.machine.clone());
            explain::run(&ExplainArgs { scene, settings, machine }, !render_blocks::in_blocks(args))
        }
        Command::Render(args) => render::run(args),
        Command::Map(args) => map::run(args),
        Command::Scenes => scenes::run(),
        Command::Devices(args) => devices::run(args),
        Command::Explain(args) => explain::run(args, !args.machine.several()),
        Command::Compare(args) => compare::run(args),
        Command::Export(args) => export::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Info(args) => info::run(args),
        Command::Picture(args) => picture::run(args),
        Command::Completions(args) => manual::completions(args),
        Command::Man(args) => manual::man(args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_declarations_are_consistent() {
        Cli::command().debug_assert();
    }

    /// `-h` is for a first picture, `--help` for most others; `--set` names the rest, and the manual page describes it.
    #[test]
    fn the_help_is_short() {
        let mut command = Cli::command();
        let render = command.find_subcommand_mut("render").unwrap();
        let (short, long) = (render.render_help().to_string(), render.render_long_help().to_string());
        let options =
            |text: &str| text.lines().filter(|line| line.starts_with("      --") || line.starts_with("  -")).count();
        // With --help and --version.
        assert!(options(&short) <= 15 && short.lines().count() <= 40, "{short}");
        assert!((20..=30).contains(&options(&long)), "{}: {long}", options(&long));
        for heading in ["Scene:", "Output:", "Photons:", "Machine:", "Further settings:"] {
            assert!(long.contains(heading), "{heading}: {long}");
        }
        let set = render.get_arguments().find(|argument| argument.get_id() == "set").unwrap();
        let rest = set.get_long_help().unwrap().to_string();
        for argument in render.get_arguments().filter(|argument| argument.is_hide_long_help_set()) {
            let name = argument.get_long().unwrap();
            assert!(rest.split([' ', ',', '.']).any(|word| word == name), "{name}: {rest}");
        }
        assert!(!short.contains("--paper-factor") && !long.contains("--paper-factor"));
        assert!(rest.contains("paper-factor"));
    }

    #[test]
    fn settings_are_set_by_name() {
        let parsed = |arguments: &[&str]| {
            let arguments = arguments.iter().map(std::ffi::OsString::from);
            Cli::try_parse_from(set::expanded(arguments)).map(|cli| match cli.command {
                Command::Render(args) => format!("{args:?}"),
                other => format!("{other:?}"),
            })
        };
        let set =
            parsed(&["photonmap", "render", "cornell", "--set", "gather-rays=3", "--set", "no-terminator-offset"]);
        let given = parsed(&["photonmap", "render", "cornell", "--gather-rays", "3", "--no-terminator-offset"]);
        assert_eq!(set.unwrap(), given.unwrap());
        assert!(
            parsed(&["photonmap", "render", "--set", "nonsense=1"]).unwrap_err().to_string().contains("--nonsense")
        );
        assert!(parsed(&["photonmap", "render", "--set"]).is_err());
    }
}
