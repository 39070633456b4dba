//! Writes the committed files: the SPIR-V modules and their table in Rust.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::sources::Shader;

/// Paths below the backend's folder, and contents.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// All files: the compiled modules, and the table of all of them by name.
pub(crate) fn files(modules: &[(&Shader, Vec<u32>)], names: &[&str]) -> Files {
    let mut files: Files = modules
        .iter()
        .map(|(kernel, words)| {
            (format!("spirv/{}.spv", kernel.name), words.iter().flat_map(|word| word.to_le_bytes()).collect())
        })
        .collect();
    files.push(("src/shaders.rs".to_owned(), table(names).into_bytes()));
    files
}

/// Kernels of tests and of an example: not in a release, where an edited one would invalidate the users' pipeline caches.
fn is_test(name: &str) -> bool {
    name.starts_with("probe_") || name.starts_with("example_")
}

fn table(names: &[&str]) -> String {
    let mut text =
        "//! The compiled shaders. Written by `cargo xtask shaders`.\n\nuse crate::device::Module;\n".to_owned();
    for name in names {
        // Formatted as rustfmt does: wrapped if a line would be longer than 120.
        let item = format!("pub(crate) static {}: Module =", name.to_uppercase());
        let value = format!("Module {{ name: \"{name}\", bytes: include_bytes!(\"../spirv/{name}.spv\") }};");
        let between = if item.len() + 1 + value.len() <= 120 { " " } else { "\n    " };
        let only = if is_test(name) { "#[cfg(test)]\n" } else { "" };
        let _ = write!(text, "\n{only}{item}{between}{value}\n");
    }
    let (tests, kernels): (Vec<&str>, Vec<&str>) = names.iter().partition(|name| is_test(name));
    list(&mut text, "/// Those of the pipeline.", "KERNELS", &kernels);
    list(&mut text, "/// Those of tests and of the example.\n#[cfg(test)]", "TEST_KERNELS", &tests);
    text
}

fn list(text: &mut String, head: &str, name: &str, modules: &[&str]) {
    let _ = writeln!(text, "\n{head}\npub(crate) static {name}: [&Module; {}] = [", modules.len());
    for module in modules {
        let _ = writeln!(text, "    &{},", module.to_uppercase());
    }
    text.push_str("];\n");
}

/// Writes files that differ, and removes modules without a source.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write(output: &Path, files: &Files) -> Result<(), String> {
    for (name, bytes) in files {
        let path = output.join(name);
        if fs::read(&path).is_ok_and(|old| old == *bytes) {
            continue;
        }
        fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        eprintln!("wrote {name}");
    }
    Ok(())
}

/// Number of files that are stale or have no source.
pub(crate) fn compare(output: &Path, files: &Files) -> usize {
    let mut stale = 0;
    for (name, bytes) in files {
        if fs::read(output.join(name)).map_or(true, |old| old != *bytes) {
            eprintln!("{name} is stale: run `cargo xtask shaders` and commit what it writes");
            stale += 1;
        }
    }
    for entry in fs::read_dir(output.join("spirv")).into_iter().flatten().flatten() {
        let name = format!("spirv/{}", entry.file_name().to_string_lossy());
        if name.ends_with(".spv") && !files.iter().any(|(known, _)| *known == name) {
            eprintln!("{name} has no source: remove it");
            stale += 1;
        }
    }
    stale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doctored_module_is_stale() {
        let folder = std::env::temp_dir().join(format!("photon-shaders-{}", std::process::id()));
        for part in ["spirv", "src"] {
            fs::create_dir_all(folder.join(part)).unwrap();
        }
        let kernel = Shader { path: "a/b.comp".into(), name: "a_b".to_owned(), text: String::new() };
        let files = files(&[(&kernel, vec![0x0723_0203, 1])], &["a_b"]);
        write(&folder, &files).unwrap();
        assert_eq!(compare(&folder, &files), 0);
        fs::write(folder.join("spirv/a_b.spv"), [3, 2, 0x23, 7, 2, 0, 0, 0]).unwrap();
        assert_eq!(compare(&folder, &files), 1);
        fs::write(folder.join("spirv/left_over.spv"), []).unwrap();
        assert_eq!(compare(&folder, &files), 2);
        fs::remove_dir_all(&folder).unwrap();
    }
}
