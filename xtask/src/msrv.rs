//! The minimum Rust version: dependencies must support the version that the workspace declares.
//!
//! Three checks of different strength. Declared versions are always compared; the lint
//! `clippy::incompatible_msrv` (step `clippy`) checks our own use of the standard library; and
//! if the declared compiler version is installed, it compiles the libraries.

use crate::graph::{Graph, Kind};
use crate::shell;

/// Compares declared versions, and compiles the libraries with the declared version if it is installed.
pub(crate) fn step() -> Result<(), String> {
    let graph = Graph::of_workspace()?;
    let promised = check(&graph)?;
    eprintln!("every dependency of the libraries declares Rust {promised} or older, or declares nothing");
    let Some(toolchain) = installed(&shell::capture(&["rustup", "toolchain", "list"]).unwrap_or_default(), &promised)
    else {
        eprintln!("SKIPPED: Rust {promised} is not installed, so the libraries were not compiled with it");
        return Ok(());
    };
    let plus = format!("+{toolchain}");
    let mut command = vec!["cargo", plus.as_str(), "check", "--locked", "--target-dir", "target/msrv"];
    for (_, package) in graph.libraries() {
        command.extend(["--package", &package.name]);
    }
    // Set by the proxy that started us; it would win over `+toolchain` in nested calls of rustc.
    shell::run(&command, &[("RUSTUP_TOOLCHAIN", &toolchain)])
}

/// Returns the version that the libraries declare.
///
/// # Errors
///
/// The libraries declare none or different ones; a dependency declares a newer one.
fn check(graph: &Graph) -> Result<String, String> {
    let mut promised: Option<(&str, &str)> = None;
    for (_, package) in graph.libraries() {
        let declared = package
            .rust_version
            .as_deref()
            .ok_or_else(|| format!("{} declares no rust-version: add `rust-version.workspace = true`", package.name))?;
        match promised {
            Some((version, other)) if version != declared => {
                return Err(format!("{} declares Rust {declared}, {other} declares {version}", package.name));
            }
            _ => promised = Some((declared, &package.name)),
        }
    }
    let (promised, _) = promised.ok_or("no package under crates/")?;
    let limit = parse(promised)?;
    let mut too_new = Vec::new();
    for package in graph.reached(graph.libraries().map(|(id, _)| id), &[Kind::Normal, Kind::Build]) {
        if let Some(declared) = &package.rust_version
            && parse(declared)? > limit
        {
            too_new.push(format!("  {} {} needs Rust {declared}", package.name, package.version));
        }
    }
    if too_new.is_empty() {
        return Ok(promised.to_owned());
    }
    Err(format!("the workspace promises Rust {promised}, but\n{}", too_new.join("\n")))
}

/// `1.89` and `1.89.0` are the same version.
fn parse(version: &str) -> Result<[u32; 3], String> {
    let mut parts = [0; 3];
    let numbers = version.split('.');
    if numbers.clone().count() > 3 {
        return Err(format!("{version:?} is not a version of Rust"));
    }
    for (part, number) in parts.iter_mut().zip(numbers) {
        *part = number.parse().map_err(|_| format!("{version:?} is not a version of Rust"))?;
    }
    Ok(parts)
}

/// The name of the installed toolchain of this version, from the output of `rustup toolchain list`.
fn installed(list: &str, version: &str) -> Option<String> {
    let names = list.lines().filter_map(|line| line.split_whitespace().next());
    let mut ours = names.filter(|name| {
        name.strip_prefix(version).is_some_and(|rest| {
            let rest =
                rest.strip_prefix('.').map_or(rest, |patch| patch.trim_start_matches(|c: char| c.is_ascii_digit()));
            rest.is_empty() || rest.starts_with('-')
        })
    });
    ours.next().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::sample;

    fn with_dependency(declared: Option<&str>, kind: Option<&str>) -> Graph {
        sample::graph(
            &[("core", "0.1.0", "crates", Some("1.89")), ("png", "0.18.0", "registry", declared)],
            &[(0, 1, kind)],
        )
    }

    #[test]
    fn a_dependency_that_needs_a_newer_compiler_fails() {
        let failure = check(&with_dependency(Some("1.90"), None)).unwrap_err();
        assert!(failure.contains("png 0.18.0 needs Rust 1.90"), "{failure}");
        assert!(check(&with_dependency(Some("1.89.1"), Some("build"))).is_err());
    }

    #[test]
    fn older_equal_undeclared_and_dev_dependencies_pass() {
        for (declared, kind) in
            [(Some("1.56"), None), (Some("1.89.0"), None), (None, None), (Some("1.90"), Some("dev"))]
        {
            assert_eq!(check(&with_dependency(declared, kind)).unwrap(), "1.89");
        }
    }

    #[test]
    fn libraries_that_promise_nothing_or_differ_fail() {
        let package = |name, version| (name, "0.1.0", "crates", version);
        assert!(check(&sample::graph(&[package("a", None)], &[])).is_err());
        assert!(check(&sample::graph(&[package("a", Some("1.89")), package("b", Some("1.90"))], &[])).is_err());
        assert!(check(&sample::graph(&[], &[])).is_err());
    }

    #[test]
    fn versions_are_numbers() {
        assert!(parse("1.100").unwrap() > parse("1.89.3").unwrap());
        assert!(parse("1.x").is_err());
        assert!(parse("1.2.3.4").is_err());
    }

    #[test]
    fn installed_toolchains_are_recognised() {
        let list = "stable-x86_64-unknown-linux-gnu (active, default)\n1.89.0-x86_64-unknown-linux-gnu\n";
        assert_eq!(installed(list, "1.89").unwrap(), "1.89.0-x86_64-unknown-linux-gnu");
        assert_eq!(installed(list, "1.8"), None);
        assert_eq!(installed("", "1.89"), None);
    }
}
