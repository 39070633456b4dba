//! Which modules the sources name in a checking macro, so that none is forgotten.

use std::fs;
use std::path::Path;

/// The names of the modules listed between `=>` and `end` in each call of a macro in the sources of this crate; `call` is the
/// beginning of a call.
pub(super) fn listed(call: &str, end: char) -> Vec<String> {
    // Read at run time: a moved target folder must not refer to the old checkout.
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| "crates/backend-vulkan".into());
    let mut names = Vec::new();
    collect(&Path::new(&folder).join("src"), (&format!("\n{call}"), end), &mut names);
    names
}

fn collect(folder: &Path, (call, end): (&str, char), names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, (call, end), names);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            for arguments in fs::read_to_string(&path).unwrap().split(call).skip(1) {
                let modules = arguments.split_once("=>").and_then(|(_, rest)| rest.split_once(end));
                names.extend(modules.map_or("", |it| it.0).split_whitespace().map(str::to_lowercase));
            }
        }
    }
}
