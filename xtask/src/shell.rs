//! Runs external programs: prints the command first, and names it in errors.

use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The top of the workspace that this program was started in.
///
/// Read at run time: a target folder that was moved must not point back at the old checkout.
pub(crate) fn root() -> PathBuf {
    match std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) {
        Some(manifest) if manifest.ends_with("xtask") => manifest.join(".."),
        _ => PathBuf::from("."),
    }
}

/// Runs a command in the root of the workspace, with inherited output.
///
/// # Errors
///
/// The command cannot be started, or ends with a status other than 0.
pub(crate) fn run(command: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
    let shown: String = variables.iter().map(|(name, value)| format!("{name}={value:?} ")).collect();
    let line = command.join(" ");
    eprintln!("$ {shown}{line}");
    let status = prepare(command)?
        .envs(variables.iter().copied())
        .status()
        .map_err(|error| format!("`{line}` cannot be started: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{line}` failed ({status})")) }
}

/// Runs a command in the root of the workspace and returns what it wrote to standard output.
///
/// # Errors
///
/// As [`run`], and output that is not UTF-8.
pub(crate) fn capture(command: &[&str]) -> Result<String, String> {
    let line = command.join(" ");
    let output = prepare(command)?
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("`{line}` cannot be started: {error}"))?;
    if !output.status.success() {
        return Err(format!("`{line}` failed ({})", output.status));
    }
    String::from_utf8(output.stdout).map_err(|_| format!("`{line}` wrote something that is not UTF-8"))
}

/// Like [`capture`], but a failing command is not an error: also returns whether it succeeded.
///
/// # Errors
///
/// The command cannot be started, and output that is not UTF-8.
pub(crate) fn capture_all(command: &[&str]) -> Result<(String, bool), String> {
    let line = command.join(" ");
    let output = prepare(command)?
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("`{line}` cannot be started: {error}"))?;
    let text = String::from_utf8(output.stdout).map_err(|_| format!("`{line}` wrote something that is not UTF-8"))?;
    Ok((text, output.status.success()))
}

/// Whether a program is installed: it responds when asked for its version.
pub(crate) fn present(command: &[&str]) -> bool {
    prepare(command)
        .and_then(|mut command| {
            command.stdout(Stdio::null()).stderr(Stdio::null()).status().map_err(|error| error.to_string())
        })
        .is_ok_and(|status| status.success())
}

fn prepare(command: &[&str]) -> Result<Command, String> {
    let (program, arguments) = command.split_first().ok_or("an empty command")?;
    let mut prepared = Command::new(program);
    prepared.args(arguments).current_dir(root());
    Ok(prepared)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_command_is_named() {
        let failure = run(&["cargo", "no-such-subcommand"], &[]).unwrap_err();
        assert!(failure.contains("no-such-subcommand"), "{failure}");
    }

    #[test]
    fn an_absent_program_is_absent() {
        assert!(present(&["cargo", "--version"]));
        assert!(!present(&["no-such-program-anywhere", "--version"]));
        assert!(run(&["no-such-program-anywhere"], &[]).is_err());
        assert!(capture(&["no-such-program-anywhere"]).is_err());
    }
}
