//! Folders into which `pip install pyoidn` puts Open Image Denoise.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The library in the packages of Python, of the given environment and the active one first; those that exist.
pub(super) fn by_pip(environment: Option<&Path>) -> Vec<PathBuf> {
    found(environment, &|name| std::env::var_os(name))
}

fn found(environment: Option<&Path>, variable: &dyn Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let of = |name: &str| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let given = environment.map(Path::to_path_buf);
    let prefixes = [given, of("VIRTUAL_ENV"), of("CONDA_PREFIX"), of("HOME").map(|home| home.join(".local"))];
    let system = ["/usr/local", "/usr"].map(PathBuf::from);
    prefixes.into_iter().flatten().chain(system).flat_map(|prefix| within(&prefix)).collect()
}

/// The library in the packages of any Python 3 below a prefix, of the last version first.
fn within(prefix: &Path) -> Vec<PathBuf> {
    let versions = std::fs::read_dir(prefix.join("lib")).into_iter().flatten().flatten();
    let is_python = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python3"));
    let mut versions: Vec<PathBuf> = versions.map(|entry| entry.path()).filter(is_python).collect();
    versions.sort_by(|a, b| b.cmp(a));
    let packages =
        versions.iter().flat_map(|version| ["site-packages", "dist-packages"].map(|name| version.join(name)));
    let library = packages.map(|folder| folder.join("pyoidn/oidn/lib/libOpenImageDenoise.so"));
    library.filter(|path| path.is_file()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_of_an_environment_comes_first() {
        let folder = tempfile::tempdir().unwrap();
        let [given, active, home] = ["given", "active", "home"].map(|name| folder.path().join(name));
        let place = |prefix: &Path| {
            let lib = prefix.join("lib/python3.11/site-packages/pyoidn/oidn/lib");
            std::fs::create_dir_all(&lib).unwrap();
            let file = lib.join("libOpenImageDenoise.so");
            std::fs::write(&file, "").unwrap();
            file
        };
        let expected = [place(&active), place(&home.join(".local"))];
        let variable = |name: &str| match name {
            "VIRTUAL_ENV" => Some(active.clone().into_os_string()),
            "HOME" => Some(home.clone().into_os_string()),
            _ => None,
        };
        assert_eq!(found(None, &variable)[..2], expected);
        let first = place(&given);
        assert_eq!(found(Some(&given), &variable)[..3], [&[first], &expected[..]].concat());
        assert!(within(&folder.path().join("nowhere")).is_empty());
    }
}
