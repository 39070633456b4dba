//! Checks that backends are built without the parsers of scene files.

use crate::shell;

/// The backends, which take a scene as slices.
const BACKENDS: [&str; 2] = ["photonmap-cpu", "photonmap-vulkan"];

/// The dependencies of photonmap-scene's loaders (feature `files`), and of film files.
const LOADERS: [&str; 10] =
    ["earcut", "exr", "flate2", "gltf", "image-webp", "png", "serde", "toml", "zip", "zune-jpeg"];

/// Fails if a backend, built by itself, depends on a loader.
pub(crate) fn step() -> Result<(), String> {
    for backend in BACKENDS {
        // Not `cargo metadata`: that unifies the features of all members, and the programs have `files`. For this
        // platform only: `--target all` also lists what rdst, a dependency of obvhs, needs for its own measurements,
        // under a `cfg(tuning)` that is never set.
        let tree = ["cargo", "tree", "--locked", "-p", backend, "-e", "normal", "--prefix", "none"];
        check(backend, &shell::capture(&tree)?)?;
    }
    eprintln!("no {} in {}", LOADERS.join(", "), BACKENDS.join(", "));
    Ok(())
}

/// Looks for loaders in the output of `cargo tree --prefix none`: one package per line, its name first.
fn check(backend: &str, tree: &str) -> Result<(), String> {
    let mut names = tree.lines().filter_map(|line| line.split_whitespace().next());
    if names.next() != Some(backend) {
        return Err(format!("cargo tree does not begin with {backend}, but so:\n{tree}"));
    }
    // Also matches families by their first word: serde_core, gltf-json, toml_edit.
    let family = |name: &str, loader: &str| {
        name.strip_prefix(loader).is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '_']))
    };
    match names.find(|name| LOADERS.iter().any(|loader| family(name, loader))) {
        Some(name) => Err(format!(
            "{backend} depends on {name}, which only loaders of scene files need: `cargo tree -p {backend} -e normal \
             --invert {name}` shows who asks for it; keep the feature `files` of photonmap-scene off there"
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEAN: &str = "photonmap-cpu v0.1.0 (/a/b)\nglam v0.34.0\nphotonmap-scene v0.1.0 (/a/c)\nobvhs v0.4.0\n";

    #[test]
    fn a_backend_without_loaders_passes() {
        check("photonmap-cpu", CLEAN).unwrap();
        // Only the whole name counts, or its first word.
        check("photonmap-cpu", &format!("{CLEAN}pngtools v1.0.0\n")).unwrap();
    }

    #[test]
    fn every_loader_fails_and_is_named() {
        for name in ["earcut", "gltf", "gltf-json", "png", "serde", "serde_core", "toml", "toml_parser"] {
            let failure = check("photonmap-cpu", &format!("{CLEAN}{name} v1.0.0\n")).unwrap_err();
            assert!(failure.contains(&format!("photonmap-cpu depends on {name},")), "{failure}");
        }
    }

    #[test]
    fn what_is_not_the_tree_of_the_backend_fails() {
        assert!(check("photonmap-vulkan", CLEAN).is_err());
        assert!(check("photonmap-cpu", "").is_err());
    }
}
