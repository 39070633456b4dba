//! Packages that may occur in only one version, because their types occur in our interfaces.

use std::collections::BTreeSet;

use crate::graph::{Graph, Kind};

/// Vectors of two versions of glam, or handles of two versions of ash, are different types.
const SINGLE: [&str; 2] = ["glam", "ash"];

/// The benchmarks compare with other libraries, which may depend on any version.
const FREE: &str = "photon-benches";

/// Fails if a package that must be unique occurs in two versions.
pub(crate) fn step() -> Result<(), String> {
    check(&Graph::of_workspace()?)?;
    eprintln!("at most one version each: {}", SINGLE.join(", "));
    Ok(())
}

fn check(graph: &Graph) -> Result<(), String> {
    let members = graph.members().filter(|(_, package)| package.name != FREE).map(|(id, _)| id);
    let reached: Vec<_> = graph.reached(members, &[Kind::Normal, Kind::Build, Kind::Dev]).collect();
    for name in SINGLE {
        let versions: BTreeSet<&str> =
            reached.iter().filter(|package| package.name == name).map(|package| package.version.as_str()).collect();
        if versions.len() > 1 {
            let versions: Vec<_> = versions.into_iter().collect();
            return Err(format!(
                "{name} occurs in versions {}: `cargo tree --workspace --invert {name}@{}` shows who asks for the first",
                versions.join(" and "),
                versions[0],
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::sample;

    fn two_glams(second_asked_for_by: &str) -> Graph {
        sample::graph(
            &[
                ("core", "0.1.0", "crates", None, None),
                (second_asked_for_by, "0.1.0", "top", None, None),
                ("glam", "0.34.0", "registry", None, None),
                ("glam", "0.29.0", "registry", None, None),
            ],
            &[(0, 2, None), (1, 3, Some("dev"))],
        )
    }

    #[test]
    fn two_versions_fail() {
        let failure = check(&two_glams("examples")).unwrap_err();
        assert!(failure.contains("glam occurs in versions 0.29.0 and 0.34.0"), "{failure}");
    }

    #[test]
    fn one_version_passes_and_so_does_a_second_that_only_the_benchmarks_bring() {
        check(&two_glams(FREE)).unwrap();
    }
}
