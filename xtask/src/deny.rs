//! Licences, duplicate versions, banned packages and sources of dependencies: cargo-deny, by the rules of `deny.toml`.
//!
//! Advisories are a step of their own for every night, since they need a database from the network, whose entries of tomorrow
//! would fail the code of today.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell;

/// The checks that depend on the code alone.
const RULES: [&str; 3] = ["bans", "licenses", "sources"];

/// Where cargo-deny is installed if it is not there already.
const FOLDER: &str = "target/cargo-deny";

const INSTALL: [&str; 8] = [
    "cargo",
    "install",
    "cargo-deny",
    "--version=0.20.2",
    "--locked",
    // Compiles faster, and is fast enough.
    "--debug",
    "--root",
    FOLDER,
];

/// A workspace that breaks the rules, and the errors of cargo-deny that show it.
const BROKEN: [(&str, &str); 5] = [
    (
        "Cargo.toml",
        "\
[package]
name = 'broken'
version = '0.1.0'
license = 'GPL-3.0-only'
[workspace]
exclude = ['new', 'old']
[dependencies]
rand = { path = 'rand', version = '0.1.0' }
new = { path = 'new', version = '0.2.0', package = 'glam' }
old = { path = 'old', version = '0.1.0', package = 'glam' }
",
    ),
    ("rand/Cargo.toml", "package = { name = 'rand', version = '0.1.0', license = 'MIT' }\n"),
    ("new/Cargo.toml", "package = { name = 'glam', version = '0.2.0', license = 'MIT' }\n"),
    ("old/Cargo.toml", "package = { name = 'glam', version = '0.1.0', license = 'MIT' }\n"),
    ("src/lib.rs", ""),
];
const ERRORS: [&str; 3] = ["error[rejected]", "error[banned]", "error[duplicate]"];

/// Checks the dependencies of the workspace, and beforehand that the rules refuse what they should.
pub(crate) fn step() -> Result<(), String> {
    let root = shell::root();
    let program = program(&root)?;
    let broken = root.join(FOLDER).join("broken");
    write(&broken).map_err(|error| format!("{}: {error}", broken.display()))?;
    let (report, passed) = check(&program, &root, &broken, &RULES)?;
    if let Some(missed) = ERRORS.iter().find(|&&error| passed || !report.contains(error)) {
        return Err(format!("deny.toml accepts a workspace that should fail with {missed}:\n{report}"));
    }
    of_workspace(&program, &root, &root, &RULES)
}

/// Workspaces with lock files of their own.
const WORKSPACES: [&str; 4] = [".", "mpi", "python", "xtask-book"];

/// Looks for known vulnerabilities of the dependencies, in a database that is fetched.
pub(crate) fn advisories() -> Result<(), String> {
    let root = shell::root();
    let program = program(&root)?;
    // All of them, also after a failure.
    let failed =
        WORKSPACES.map(|workspace| of_workspace(&program, &root, &root.join(workspace), &["advisories"]).err());
    let failed: Vec<String> = failed.into_iter().flatten().collect();
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

fn of_workspace(program: &Path, root: &Path, workspace: &Path, rules: &[&str]) -> Result<(), String> {
    let (report, passed) = check(program, root, workspace, rules)?;
    if !passed {
        return Err(format!("\n{report}"));
    }
    eprintln!("{}", report.trim());
    Ok(())
}

/// The installed cargo-deny; installs it if there is none.
fn program(root: &Path) -> Result<PathBuf, String> {
    if shell::present(&["cargo-deny", "--version"]) {
        return Ok("cargo-deny".into());
    }
    let own = root.join(FOLDER).join("bin").join(format!("cargo-deny{}", std::env::consts::EXE_SUFFIX));
    if !own.exists() {
        shell::run(&INSTALL, &[("CARGO_PROFILE_DEV_DEBUG", "0")])?;
    }
    Ok(own)
}

/// What cargo-deny says about a workspace, and whether it passes.
fn check(program: &Path, root: &Path, workspace: &Path, rules: &[&str]) -> Result<(String, bool), String> {
    let output = Command::new(program)
        .arg("--manifest-path")
        .arg(workspace.join("Cargo.toml"))
        .arg("--config")
        .arg(root.join("deny.toml"))
        .args(["--color", "never", "check"])
        .args(rules)
        .output()
        .map_err(|error| format!("{} cannot be started: {error}", program.display()))?;
    let text = [output.stdout, output.stderr].concat();
    Ok((String::from_utf8_lossy(&text).into_owned(), output.status.success()))
}

fn write(folder: &Path) -> std::io::Result<()> {
    for (name, text) in BROKEN {
        let file = folder.join(name);
        fs::create_dir_all(file.parent().unwrap_or(folder))?;
        fs::write(file, text)?;
    }
    for package in ["rand", "new", "old"] {
        fs::create_dir_all(folder.join(package).join("src"))?;
        fs::write(folder.join(package).join("src/lib.rs"), "")?;
    }
    Ok(())
}
