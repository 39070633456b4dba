//! Steps for the compiled shaders. The compiler is C++, and therefore used by a separate package.

use std::fs;

use crate::{constants, shell};

// Not in the release profile: clippy needs the compiler's build script in this one, and it takes minutes.
const COMPILE: [&str; 6] = ["cargo", "run", "--quiet", "--locked", "-p", "xtask-shaders"];

/// Compiles the shaders and writes the SPIR-V.
pub(crate) fn write() -> Result<(), String> {
    constants::write()?;
    shell::run(&COMPILE, &[])
}

/// Compiles the shaders, compares with the committed SPIR-V, and runs the validator on it.
pub(crate) fn fresh() -> Result<(), String> {
    constants::fresh()?;
    shell::run(&[&COMPILE, ["--", "--check"].as_slice()].concat(), &[])?;
    shell::run(&["cargo", "test", "--quiet", "--locked", "-p", "xtask-shaders"], &[])?;
    let folder = shell::root().join("crates/backend-vulkan/spirv");
    if !shell::present(&["spirv-val", "--version"]) {
        return Err("spirv-val is not installed; Debian has it in spirv-tools".to_owned());
    }
    let listing = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for entry in listing.flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == "spv") {
            let path = path.to_string_lossy();
            shell::run(&["spirv-val", "--target-env", "vulkan1.2", "--scalar-block-layout", &path], &[])?;
        }
    }
    Ok(())
}
