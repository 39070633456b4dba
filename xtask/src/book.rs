//! The documentation as a book: links and table of contents are checked here, mdBook renders it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::{links, shell};

/// Markdown outside of `docs/` whose links are checked too.
const OTHERS: [&str; 7] = [
    "README.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "CHANGELOG.md",
    "tests/README.md",
    "fuzz/README.md",
    "python/README.md",
];

/// A package with its own target folder: see its manifest.
const RENDER: [&str; 10] = [
    "cargo",
    "run",
    "--quiet",
    "--locked",
    "--manifest-path",
    "xtask-book/Cargo.toml",
    "--target-dir",
    "target/xtask-book",
    "--",
    "docs",
];

/// Renders the pages into `target/book`.
pub(crate) fn step() -> Result<(), String> {
    links()?;
    shell::run(&[&RENDER, ["target/book"].as_slice()].concat(), &[])
}

/// Checks links, and that the table of contents has all pages.
pub(crate) fn links() -> Result<(), String> {
    let root = shell::root();
    let mut pages = BTreeMap::new();
    read(&root, "docs", &mut pages)?;
    for name in OTHERS {
        let text = fs::read_to_string(root.join(name)).map_err(|error| format!("{name}: {error}"))?;
        pages.insert(name.to_owned(), text);
    }
    let faults = links::faults(&pages, &|file| root.join(file).exists());
    if !faults.is_empty() {
        return Err(format!("\n  {}", faults.join("\n  ")));
    }
    eprintln!("{} pages, no dead link", pages.len());
    Ok(())
}

/// Every Markdown file in a folder, by its path from the root.
fn read(root: &Path, folder: &str, pages: &mut BTreeMap<String, String>) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("{folder}: {error}");
    for entry in fs::read_dir(root.join(folder)).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.file_type().map_err(wrong)?.is_dir() {
            read(root, &name, pages)?;
        } else if name.ends_with(".md") {
            let text = fs::read_to_string(entry.path()).map_err(|error| format!("{name}: {error}"))?;
            pages.insert(name, text);
        }
    }
    Ok(())
}
