//! The rows of `docs/extremes.md` and `docs/extremes-long.md`, written from a run on every backend.

use std::fs;

use crate::shell;

/// What stands before this line is written by hand and kept.
const MARK: &str = "<!-- rows: written by `cargo xtask extremes` -->\n";

const RUN: [&str; 7] = ["cargo", "run", "--quiet", "--locked", "-p", "photon-tests", "--example"];

/// The quick extent, a minute or two.
pub(crate) fn quick() -> Result<(), String> {
    write("docs/extremes.md", &[])
}

/// Everything, the better part of an hour.
pub(crate) fn long() -> Result<(), String> {
    write("docs/extremes-long.md", &["--long"])
}

fn write(file: &str, extent: &[&str]) -> Result<(), String> {
    let path = shell::root().join(file);
    let text = fs::read_to_string(&path).map_err(|error| format!("{file}: {error}"))?;
    let head = head(&text).ok_or_else(|| format!("{file} has no line {MARK:?}, behind which the rows stand"))?;
    let (rows, all) = shell::capture_all(&[&RUN, ["extremes", "--"].as_slice(), extent].concat())?;
    fs::write(&path, format!("{head}{MARK}\n{}\n", rows.trim_end())).map_err(|error| format!("{file}: {error}"))?;
    if all { Ok(()) } else { Err(format!("{file} is written, and has rows that fail")) }
}

fn head(text: &str) -> Option<&str> {
    text.find(MARK).map(|at| &text[..at])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_by_hand_is_kept() {
        assert_eq!(head(&format!("prose\n{MARK}| row |\n")), Some("prose\n"));
        assert_eq!(head("prose\n"), None);
    }
}
