//! The Python package: built as `pip install ./python` does, installed in a bare virtual environment, and tested.

use std::fs;

use crate::shell;

/// What the build and the tests need; the package itself needs only NumPy.
const NEEDED: [&str; 8] = ["maturin>=1.9,<2", "numpy", "pytest", "scipy", "mypy", "tqdm", "nbclient", "ipykernel"];

/// Tests of workers of Dask, with the package that `step` has installed.
pub(crate) fn dask() -> Result<(), String> {
    let python = format!("{}/target/python/bin/python", shell::root().to_string_lossy());
    if !shell::present(&[&python, "-c", "import photonmap"]) {
        return Err("the package is not installed: run the step python first".to_owned());
    }
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "distributed"];
    shell::run(&[&[python.as_str()], &install[..]].concat(), &[])?;
    // Without it, the tests would be skipped.
    shell::run(&[&python, "-c", "import distributed"], &[])?;
    let tests = ["-m", "pytest", "--quiet", "-rs", "-p", "no:cacheprovider", "-k", "dask", "python/tests"];
    shell::run(&[&[python.as_str()], &tests[..]].concat(), &[])
}

/// Builds with the profile of the other tests, in the same target folder, so that dependencies are compiled once.
pub(crate) fn step() -> Result<(), String> {
    let check = "import sys; sys.exit(sys.version_info < (3, 11))";
    if !shell::present(&["python3", "-c", check]) {
        return Err("python3 3.11 or later is needed, with the module venv (Debian: python3-venv)".to_owned());
    }
    let format = ["cargo", "fmt", "--check", "--manifest-path", "python/Cargo.toml"];
    shell::run(&format, &[])?;
    let target = fs::canonicalize(shell::root()).map_err(|error| error.to_string())?.join("target");
    let target = target.to_str().ok_or("the path of the workspace is not UTF-8")?;
    let venv = format!("{target}/python");
    let python = format!("{venv}/bin/python");
    shell::run(&["python3", "-m", "venv", "--clear", &venv], &[])?;
    let install = [python.as_str(), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    shell::run(&[&install[..], &NEEDED].concat(), &[])?;
    let variables = [
        ("CARGO_TARGET_DIR", target),
        ("MATURIN_PEP517_ARGS", "--profile=dev --locked"),
        // Where maturin is found.
        ("PATH", &format!("{venv}/bin:{}", std::env::var("PATH").unwrap_or_default())),
    ];
    shell::run(&[&install[..], &["--no-build-isolation", "--no-deps", "./python"]].concat(), &variables)?;
    shell::run(&[&python, "-m", "mypy", "python/photonmap"], &[])?;
    // Where the notebook is left with its pictures.
    let notebooks = format!("{target}/notebooks");
    let tests = ["-m", "pytest", "--quiet", "-rs", "-p", "no:cacheprovider", "python/tests"];
    shell::run(&[&[python.as_str()], &tests[..]].concat(), &[("PHOTONMAP_NOTEBOOKS", &notebooks)])
}
