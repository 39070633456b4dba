//! Compiles the Rust examples of the README and the user guide as somebody outside of this workspace would: in a package
//! whose only dependency is the crate `photonmap`.

use std::fs;
use std::path::Path;

use crate::shell;

/// Pages with complete examples.
const PAGES: [&str; 2] = ["README.md", "docs/getting-started.md"];

/// Where the package is made.
const FOLDER: &str = "target/outside";

pub(crate) fn step() -> Result<(), String> {
    let root = shell::root();
    let wrong = |path: &Path| {
        let path = path.display().to_string();
        move |error: std::io::Error| format!("{path}: {error}")
    };
    let folder = root.join(FOLDER);
    let programs = folder.join("src/bin");
    if programs.exists() {
        fs::remove_dir_all(&programs).map_err(wrong(&programs))?;
    }
    fs::create_dir_all(&programs).map_err(wrong(&programs))?;
    let mut count = 0;
    for page in PAGES {
        let path = root.join(page);
        let text = fs::read_to_string(&path).map_err(wrong(&path))?;
        for code in examples(&text) {
            count += 1;
            let file = programs.join(format!("example_{count}.rs"));
            fs::write(&file, program(&code)).map_err(wrong(&file))?;
        }
    }
    if count < PAGES.len() {
        return Err(format!("{} have {count} examples", PAGES.join(" and ")));
    }
    let manifest = root.join("Cargo.toml");
    let manifest = fs::read_to_string(&manifest).map_err(wrong(&manifest))?;
    // The same profiles, so that what the workspace has compiled is used.
    let profiles = manifest.find("[profile.").map_or("", |at| &manifest[at..]);
    let text = format!(
        "[package]\nname = \"outside\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
         [dependencies]\nphotonmap = {{ path = \"../../crates/photonmap\" }}\n\n{profiles}"
    );
    let manifest = folder.join("Cargo.toml");
    fs::write(&manifest, text).map_err(wrong(&manifest))?;
    let lock = folder.join("Cargo.lock");
    fs::copy(root.join("Cargo.lock"), &lock).map_err(wrong(&lock))?;
    let manifest = format!("{FOLDER}/Cargo.toml");
    shell::run(&["cargo", "check", "--quiet", "--offline", "--manifest-path", &manifest, "--target-dir", "target"], &[])
}

/// The blocks of Rust of a page.
fn examples(text: &str) -> Vec<String> {
    let blocks = text.split("```rust\n").skip(1);
    blocks.filter_map(|block| block.split_once("```").map(|(code, _)| code.to_owned())).collect()
}

/// An example as a program.
fn program(code: &str) -> String {
    if code.contains("fn main()") { code.to_owned() } else { format!("fn main() {{\n{code}}}\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_rust_become_programs() {
        let page = "a\n```rust\nlet x = 1;\n```\nb\n```sh\nls\n```\n```rust\nfn main() {}\n```\n";
        let found = examples(page);
        assert_eq!(found, ["let x = 1;\n", "fn main() {}\n"]);
        assert_eq!(program(&found[0]), "fn main() {\nlet x = 1;\n}\n");
        assert_eq!(program(&found[1]), found[1]);
    }
}
