//! The rows of `docs/extremes.md` and `docs/extremes-long.md`, written from a run on every backend.

use std::fs;

use crate::shell;

/// What stands before this line is written by hand and kept.
const MARK: &str = "<!-- rows: written by `cargo xtask extremes` -->\n";

const RUN: [&str; 7] = ["cargo", "run", "--quiet", "--locked", "-p", "studies", "--bin"];

/// The quick extent, a minute or two.
pub(crate) fn quick() -> Result<(), String> {
    write("docs/extremes.md", &[])
}

/// Everything, the better part of an hour.
pub(crate) fn long() -> Result<(), String> {
    write("docs/extremes-long.md", &["--long"])
}

/// The rows of a long run on another machine, say one with a GPU: what the program printed there.
pub(crate) fn elsewhere() -> Result<(), String> {
    let from = "out/extremes-long.md";
    let rows = fs::read_to_string(shell::root().join(from)).map_err(|error| format!("{from}: {error}"))?;
    let bad = faults(&rows);
    put("docs/extremes-long.md", &rows)?;
    if bad == 0 { Ok(()) } else { Err(format!("{from} has {bad} rows that fail")) }
}

fn faults(rows: &str) -> usize {
    rows.lines().filter(|line| line.ends_with("| **FAILS** |")).count()
}

fn write(file: &str, extent: &[&str]) -> Result<(), String> {
    let (rows, all) = shell::capture_all(&[&RUN, ["extremes", "--"].as_slice(), extent].concat())?;
    put(file, &rows)?;
    if all { Ok(()) } else { Err(format!("{file} is written, and has rows that fail")) }
}

fn put(file: &str, rows: &str) -> Result<(), String> {
    let path = shell::root().join(file);
    let text = fs::read_to_string(&path).map_err(|error| format!("{file}: {error}"))?;
    let head = head(&text).ok_or_else(|| format!("{file} has no line {MARK:?}, behind which the rows stand"))?;
    fs::write(&path, format!("{head}{MARK}\n{}\n", rows.trim_end())).map_err(|error| format!("{file}: {error}"))
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

    #[test]
    fn rows_that_fail_are_counted() {
        assert_eq!(faults("| a | holds |\n| b | **does not hold** |\n"), 0);
        assert_eq!(faults("| a | **FAILS** |\n| b | holds |\n| c | **FAILS** |"), 2);
    }
}
