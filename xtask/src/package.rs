//! The packages for a registry: what their manifests say, what their archives contain, and that each compiles from its
//! archive alone. Tests within the archives may need files of a checkout; they are not run from there.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::shell;

/// Prefix of all names on the registry, where general names belong to others.
const PREFIX: &str = "photonmap";
/// Registries reject larger archives; see the section on limits of doc.rust-lang.org/cargo/reference/publishing.html.
const MAX_BYTES: u64 = 10 << 20;
/// Files that every archive contains.
const NEEDED: [&str; 3] = ["LICENSE-APACHE", "LICENSE-MIT", "README.md"];

/// Checks manifests and contents of all packages, then packs them and compiles the archives.
pub(crate) fn step() -> Result<(), String> {
    let root = shell::root();
    let text = shell::capture(&["cargo", "metadata", "--format-version", "1", "--no-deps", "--locked"])?;
    let metadata: Value = serde_json::from_str(&text).map_err(|error| format!("cargo metadata: {error}"))?;
    let packages = published(&metadata);
    if packages.is_empty() {
        return Err("no package is for a registry: `publish = false` stands everywhere".to_owned());
    }
    let mut faults = Vec::new();
    let mut all = vec!["cargo", "package", "--locked", "--allow-dirty"];
    for package in &packages {
        let name = package["name"].as_str().unwrap_or_default();
        faults.extend(faults_of_manifest(package));
        let listed = shell::capture(&["cargo", "package", "--locked", "--allow-dirty", "--list", "-p", name])?;
        let folder = package["manifest_path"].as_str().map(Path::new).and_then(Path::parent).unwrap_or(Path::new("."));
        faults.extend(faults_of_contents(name, &listed, &needed(folder)?));
        for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
            // Links, which git may have written as text files.
            if fs::read(folder.join(licence)).ok() != fs::read(root.join(licence)).ok() {
                faults.push(format!("{name}: {licence} is not that of the project"));
            }
        }
        all.extend(["-p", name]);
    }
    if !faults.is_empty() {
        return Err(format!("\n  {}", faults.join("\n  ")));
    }
    shell::run(&all, &[])?;
    for package in &packages {
        let part = |key: &str| package[key].as_str().unwrap_or_default();
        let archive = format!("target/package/{}-{}.crate", part("name"), part("version"));
        let bytes = fs::metadata(root.join(&archive)).map_err(|error| format!("{archive}: {error}"))?.len();
        if bytes > MAX_BYTES {
            return Err(format!("{archive}: {bytes} bytes, at most {MAX_BYTES} are accepted"));
        }
        eprintln!("{archive}: {} KiB", bytes.div_ceil(1024));
    }
    Ok(())
}

/// The packages of a workspace that are not excluded from registries, from the output of `cargo metadata`.
pub(crate) fn published(metadata: &Value) -> Vec<&Value> {
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    // `publish = false` is an empty list of registries.
    packages.iter().filter(|package| package["publish"].as_array().is_none_or(|list| !list.is_empty())).collect()
}

/// What a manifest lacks that readers of a registry look for.
fn faults_of_manifest(package: &Value) -> Vec<String> {
    let name = package["name"].as_str().unwrap_or_default();
    let mut faults = Vec::new();
    if name != PREFIX && !name.starts_with(&format!("{PREFIX}-")) {
        faults.push(format!("{name}: names on the registry begin with `{PREFIX}-`; or add `publish.workspace = true`"));
    }
    for key in ["description", "documentation", "license", "readme", "rust_version"] {
        if package[key].as_str().is_none_or(str::is_empty) {
            faults.push(format!("{name}: no {key}"));
        }
    }
    for key in ["keywords", "categories"] {
        if package[key].as_array().is_none_or(Vec::is_empty) {
            faults.push(format!("{name}: no {key}"));
        }
    }
    if !package["metadata"]["docs"]["rs"].is_object() {
        faults.push(format!("{name}: no [package.metadata.docs.rs]"));
    }
    faults
}

/// Files that the archive of the package in `folder` must contain: the shaders of a GPU backend, too, compiled and as source.
fn needed(folder: &Path) -> Result<Vec<String>, String> {
    let mut names: Vec<String> = NEEDED.map(str::to_owned).into();
    for shaders in ["spirv", "glsl"] {
        if folder.join(shaders).is_dir() {
            add_files(folder, shaders, &mut names)?;
        }
    }
    Ok(names)
}

/// Every file in a folder and its folders, by its path from `root`.
fn add_files(root: &Path, folder: &str, names: &mut Vec<String>) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("{folder}: {error}");
    for entry in fs::read_dir(root.join(folder)).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            add_files(root, &name, names)?;
        } else {
            names.push(name);
        }
    }
    Ok(())
}

/// The files of `needed` that an archive lacks; `listed` is the output of `cargo package --list`.
fn faults_of_contents(name: &str, listed: &str, needed: &[String]) -> Vec<String> {
    // Windows separates by backslashes.
    let listed: Vec<String> = listed.lines().map(|line| line.replace('\\', "/")).collect();
    let missing = needed.iter().filter(|file| !listed.contains(file));
    missing.map(|file| format!("{name}: its archive lacks {file}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn good() -> Value {
        json!({
            "name": "photonmap-core", "publish": null, "description": "d", "documentation": "https://docs.rs/x",
            "license": "MIT", "readme": "README.md", "rust_version": "1.89", "keywords": ["k"], "categories": ["c"],
            "metadata": {"docs": {"rs": {"targets": []}}}
        })
    }

    #[test]
    fn a_complete_manifest_passes() {
        assert_eq!(faults_of_manifest(&good()), Vec::<String>::new());
        let facade = json!("photonmap");
        let mut package = good();
        package["name"] = facade;
        assert_eq!(faults_of_manifest(&package), Vec::<String>::new());
    }

    #[test]
    fn everything_missing_is_named() {
        let keys = ["description", "documentation", "license", "readme", "rust_version", "keywords", "categories"];
        for key in keys.into_iter().chain(["metadata"]) {
            let mut package = good();
            package[key] = Value::Null;
            let faults = faults_of_manifest(&package);
            assert_eq!(faults.len(), 1, "{key}: {faults:?}");
        }
        for name in ["photon-core", "photonmapper"] {
            let mut package = good();
            package["name"] = json!(name);
            assert!(faults_of_manifest(&package)[0].contains("begin with"));
        }
    }

    #[test]
    fn packages_without_publication_are_not_checked() {
        let mut metadata = json!({"packages": [good(), good()]});
        metadata["packages"][1]["publish"] = json!([]);
        assert_eq!(published(&metadata).len(), 1);
    }

    #[test]
    fn missing_files_are_named() {
        let needed = ["LICENSE-MIT".to_owned(), "spirv/a.spv".to_owned()];
        assert!(faults_of_contents("p", "Cargo.toml\nLICENSE-MIT\nspirv\\a.spv\n", &needed).is_empty());
        assert_eq!(faults_of_contents("p", "LICENSE-MIT\n", &needed), ["p: its archive lacks spirv/a.spv"]);
    }

    #[test]
    fn shaders_are_needed_as_source_too() {
        let names = needed(&shell::root().join("crates/backend-vulkan")).unwrap();
        for file in ["README.md", "spirv/stages_trace.spv", "glsl/stages/trace.comp", "glsl/shading/bsdf.glsl"] {
            assert!(names.iter().any(|name| name == file), "{file}");
        }
    }
}
