//! `photonmap completions` and `photonmap man`

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Cli;
use crate::fault::Fault;
use crate::stdout;

/// Write a script that completes commands and options in a shell.
///
/// For bash: photonmap completions bash > ~/.local/share/bash-completion/completions/photonmap
#[derive(Clone, Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// All commands.
const COMMANDS: [&str; 12] = [
    "render",
    "map",
    "scenes",
    "devices",
    "explain",
    "compare",
    "export",
    "merge",
    "info",
    "picture",
    "completions",
    "man",
];

/// Write the manual page, of the program or of one command.
///
/// To read it: photonmap man > photonmap.1 && man ./photonmap.1
#[derive(Clone, Debug, Args)]
pub struct ManArgs {
    /// The command [default: the program as a whole].
    #[arg(value_parser = COMMANDS)]
    pub command: Option<String>,
}

/// Prints the completion script.
///
/// # Errors
/// [`Fault::Failure`] if standard output cannot be written.
pub fn completions(args: &CompletionsArgs) -> Result<(), Fault> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "photonmap", &mut script);
    stdout::write(&script)
}

/// Prints the manual page, in roff.
///
/// # Errors
/// [`Fault::Failure`] if standard output cannot be written.
pub fn man(args: &ManArgs) -> Result<(), Fault> {
    let mut cli = Cli::command();
    // Sets the full names of commands, such as photonmap-render.
    cli.build();
    let command = match &args.command {
        Some(name) => {
            let found = cli.find_subcommand(name).cloned();
            found.ok_or_else(|| Fault::input(format!("{name}: there is no such command")))?
        }
        None => cli,
    };
    // The manual describes all options, including those that help does not list.
    let command = command.mut_args(|argument| argument.hide_short_help(false).hide_long_help(false));
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page).map_err(Fault::failure)?;
    stdout::write(&page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_command_has_a_page() {
        let cli = Cli::command();
        let names: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(names, COMMANDS);
    }
}
