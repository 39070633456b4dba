//! Compiles `shaders-glsl/**/*.comp` to `crates/backend-vulkan/spirv/*.spv`.
//!
//! Called by `cargo xtask shaders`, and writes; with `--check` it only compares. A shader that does not
//! compile is named, and the others are still compiled.
#![forbid(unsafe_code)]

mod apart;
mod compile;
mod instructions;
mod no_contraction;
mod parameters;
mod sources;
mod write;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let check = std::env::args().skip(1).any(|argument| argument == "--check");
    if let Some(kernel) = apart::asked_for() {
        return apart::answer(&kernel);
    }
    // Read at run time: a target folder that was moved must not point back at the old checkout.
    let root = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| ".".into(), |dir| Path::new(&dir).join(".."));
    match run(&root, check) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(failed) => {
            eprintln!("error: {failed} of the shaders failed");
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the number of shaders that failed.
fn run(root: &Path, check: bool) -> Result<usize, String> {
    let shaders = sources::shaders(&root.join("shaders-glsl"))?;
    let mut modules = Vec::new();
    let mut failed = 0;
    for kernel in &shaders {
        match apart::compile(kernel, &root.join("shaders-glsl")) {
            Ok(words) => modules.push((kernel, words)),
            Err(message) => {
                eprintln!("{}:\n{message}", kernel.path.display());
                failed += 1;
            }
        }
    }
    let output = root.join("crates/backend-vulkan");
    // A kernel that fails now keeps its previous module, so that the rest can be used meanwhile.
    let known = |kernel: &&sources::Shader| {
        modules.iter().any(|(done, _)| done.name == kernel.name)
            || output.join(format!("spirv/{}.spv", kernel.name)).exists()
    };
    let names: Vec<&str> = shaders.iter().filter(known).map(|kernel| kernel.name.as_str()).collect();
    let files = write::files(&modules, &names);
    if check { Ok(failed + write::compare(&output, &files)) } else { write::write(&output, &files).map(|()| failed) }
}
