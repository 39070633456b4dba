//! Rules for source files that no compiler checks.

use std::fs;
use std::path::Path;

use crate::{listed, shell};

/// Longer files should be split.
const MAX_LINES: usize = 500;
/// Larger pictures and meshes do not belong in the repository.
const MAX_BYTES: u64 = 2 << 20;

/// Handwritten files, to which the limit on lines applies. Lock files and licences are not.
const WRITTEN: [&str; 9] = ["rs", "glsl", "comp", "toml", "md", "yml", "sh", "py", "html"];

// Concatenated from halves, so that this file does not break its own rules.
/// Markers of unfinished work, in Rust files.
const UNDONE: [&str; 3] = [concat!("to", "do!("), concat!("unimple", "mented!("), concat!("#[ig", "nore")];
/// Paths specific to one machine; code that needs a temporary folder asks the system for it.
const MACHINE: [&str; 5] =
    [concat!("/ho", "me/"), concat!("/ro", "ot/"), concat!("/t", "mp/"), concat!("/wo", "rk/"), concat!("/Us", "ers/")];

/// Fails if a file of the repository breaks a rule; lists all that do.
pub(crate) fn step() -> Result<(), String> {
    let root = shell::root();
    // A checkout may belong to another user than the one who runs the checks.
    let any_owner = ["git", "-c", "safe.directory=*"];
    let listed =
        shell::capture(&[&any_owner[..], &["ls-files", "-z", "--cached", "--others", "--exclude-standard"]].concat())?;
    let mut faults = Vec::new();
    let mut count = 0;
    for name in listed.split('\0').filter(|name| !name.is_empty()) {
        let path = root.join(name);
        // A deleted file that is not committed yet is still listed.
        let Ok(found) = fs::symlink_metadata(&path) else { continue };
        if !found.is_file() {
            continue;
        }
        count += 1;
        if found.len() > MAX_BYTES {
            faults.push(format!("{name}: {} bytes, at most {MAX_BYTES} are kept in the repository", found.len()));
        }
        let bytes = fs::read(&path).map_err(|error| format!("{name}: {error}"))?;
        if let Ok(text) = std::str::from_utf8(&bytes) {
            faults.extend(faults_of(name, text));
        }
    }
    faults.extend(listed::faults()?);
    if faults.is_empty() {
        eprintln!("{count} files, all tidy");
        return Ok(());
    }
    Err(faults.join("\n"))
}

/// The faults of one text file, each with its line.
fn faults_of(name: &str, text: &str) -> Vec<String> {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let mut faults = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let place = format!("{name}:{}", index + 1);
        if extension == "rs" {
            for needle in UNDONE.iter().filter(|needle| line.contains(**needle)) {
                faults.push(format!("{place}: `{needle}`: finish it, or assert what happens at present"));
            }
        }
        for needle in MACHINE.iter().filter(|needle| begins_path(line, needle)) {
            faults.push(format!("{place}: `{needle}` exists on one machine only"));
        }
        if line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ") {
            faults.push(format!("{place}: a conflict that nobody resolved"));
        }
    }
    if WRITTEN.contains(&extension) {
        let lines = text.lines().count();
        if lines > MAX_LINES {
            faults.push(format!("{name}: {lines} lines, at most {MAX_LINES}: split it by idea"));
        }
        if !text.is_empty() && !text.ends_with('\n') {
            faults.push(format!("{name}: no line end at the end"));
        }
    }
    let member = name.ends_with("/Cargo.toml");
    if member && !text.contains("[lints]\nworkspace = true\n") && !text.contains("\nlints.workspace = true\n") {
        faults.push(format!("{name}: add `[lints]` with `workspace = true`, or no lint of the root holds here"));
    }
    faults
}

/// Whether a path that starts with `needle` occurs; `crates/work/` or an address does not count.
fn begins_path(line: &str, needle: &str) -> bool {
    line.match_indices(needle).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        !before.is_some_and(|before| before.is_alphanumeric() || matches!(before, '.' | '_' | '-' | '/' | '}' | ')'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The one fault of a file, which must contain `part`.
    #[track_caller]
    fn one_fault(name: &str, text: &str, part: &str) {
        let faults = faults_of(name, text);
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert!(faults[0].contains(part), "{faults:?}");
    }

    #[test]
    fn tidy_files_pass() {
        assert_eq!(faults_of("src/lib.rs", "//! Fine.\nfn f() {}\n"), Vec::<String>::new());
        assert_eq!(faults_of("empty.rs", ""), Vec::<String>::new());
        assert_eq!(faults_of("Cargo.lock", &"a line\n".repeat(MAX_LINES + 1)), Vec::<String>::new());
    }

    #[test]
    fn long_files_fail() {
        let text = "a line\n".repeat(MAX_LINES);
        assert!(faults_of("a.rs", &text).is_empty());
        one_fault("a.rs", &(text + "one more\n"), "501 lines");
    }

    #[test]
    fn undone_work_fails() {
        for needle in UNDONE {
            one_fault("a.rs", &format!("fn f() {{}}\n    {needle}\n"), "a.rs:2");
        }
        assert!(faults_of("a.md", &format!("{}\n", UNDONE[0])).is_empty(), "prose may speak of it");
    }

    #[test]
    fn paths_of_one_machine_fail() {
        for needle in MACHINE {
            one_fault("a.toml", &format!("path = \"{needle}me/x\"\n"), "one machine");
            assert!(faults_of("a.md", &format!("https://example.org{needle}\n")).is_empty());
        }
        one_fault("ci", &format!("cd {}x\n", MACHINE[0]), "ci:1");
    }

    #[test]
    fn conflicts_and_missing_line_ends_fail() {
        one_fault("a.md", "<<<<<<< ours\n", "conflict");
        one_fault("a.md", "text", "line end");
    }

    #[test]
    fn a_member_without_the_lints_of_the_workspace_fails() {
        one_fault("tests/Cargo.toml", "[package]\n", "[lints]");
        assert!(faults_of("tests/Cargo.toml", "[package]\n\n[lints]\nworkspace = true\n").is_empty());
        assert!(faults_of("Cargo.toml", "[workspace]\n").is_empty(), "the root is no member");
    }
}
