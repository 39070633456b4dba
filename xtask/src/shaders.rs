//! The compiled shaders. The compiler is C++, and therefore a package of its own.

use std::fs;

use crate::{constants, shell};

const COMPILE: [&str; 7] = ["cargo", "run", "--quiet", "--locked", "--release", "-p", "xtask-shaders"];

/// Compiles and writes.
pub(crate) fn write() -> Result<(), String> {
    constants::write()?;
    shell::run(&COMPILE, &[])
}

/// Compiles, compares with what is committed, and has the validator look at it.
pub(crate) fn fresh() -> Result<(), String> {
    constants::fresh()?;
    shell::run(&[&COMPILE, ["--", "--check"].as_slice()].concat(), &[])?;
    shell::run(&["cargo", "test", "--quiet", "--locked", "--release", "-p", "xtask-shaders"], &[])?;
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
