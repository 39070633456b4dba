//! Finds the shaders.

use std::fs;
use std::path::{Path, PathBuf};

/// Source of a kernel.
#[derive(Debug)]
pub(crate) struct Shader {
    /// Path of the file.
    pub(crate) path: PathBuf,
    /// Folder and stem, joined by `_`: the name of the module.
    pub(crate) name: String,
    /// Source text.
    pub(crate) text: String,
}

/// All shaders below `folder`, by name.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn shaders(folder: &Path) -> Result<Vec<Shader>, String> {
    let mut found = Vec::new();
    for entry in entries(folder)? {
        if !entry.is_dir() {
            continue;
        }
        let group = stem(&entry);
        for path in entries(&entry)? {
            if path.extension().is_some_and(|extension| extension == "comp") {
                let text = read(&path)?;
                found.push(Shader { name: format!("{group}_{}", stem(&path)), path, text });
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// The text of a file.
///
/// # Errors
/// It cannot be read.
pub(crate) fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let listing = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    listing
        .map(|entry| entry.map(|entry| entry.path()).map_err(|error| format!("{}: {error}", folder.display())))
        .collect()
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
