//! A shared test runs only if a list of `tests/` names it; the compiler accepts a public function that nobody calls.

use std::fs;
use std::path::{Path, PathBuf};

use crate::shell;

/// The shared tests that no list names, one fault each.
///
/// # Errors
/// A folder or file that cannot be read.
pub(crate) fn faults() -> Result<Vec<String>, String> {
    let tests = shell::root().join("tests");
    let lists: String = files(&tests.join("tests"))?.into_iter().map(|(_, text)| text).collect();
    let sources = files(&tests.join("src"))?;
    let (suite, modules): (Vec<_>, Vec<_>) = sources.into_iter().partition(|(path, _)| path.ends_with("src/lib.rs"));
    let lists = suite.into_iter().fold(lists, |lists, (_, text)| lists + &text);
    Ok(modules.iter().flat_map(|(path, text)| unlisted(path, text, &lists)).collect())
}

/// The Rust files of a folder, without those of folders in it: shared tests are in none.
fn files(folder: &Path) -> Result<Vec<(PathBuf, String)>, String> {
    let wrong = |error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            found.push((path, text));
        }
    }
    found.sort();
    Ok(found)
}

/// The tests of the module in the file `path`, functions without parameters that are generic over the backend, that `lists`
/// has in none of the forms `module::{ test }`, `module: test` and `module::test()`.
fn unlisted(path: &Path, text: &str, lists: &str) -> Vec<String> {
    let tests = text.lines().filter_map(|line| {
        let (test, rest) = line.strip_prefix("pub fn ")?.split_once('<')?;
        (rest.contains(": TestBackend") && rest.ends_with(">() {")).then_some(test)
    });
    let is_part = |character: char| character.is_alphanumeric() || character == '_';
    let module = format!("{}:", path.file_stem().unwrap_or_default().to_string_lossy());
    // What follows each mention of the module: a list, or one name.
    let after = lists.match_indices(&module).filter(|(at, _)| !lists[..*at].ends_with(is_part));
    let named: Vec<&str> = after
        .flat_map(|(at, found)| {
            let rest = lists[at + found.len()..].trim_start_matches([':', ' ', '{', '\n']);
            let list = &rest[..rest.find(['}', '(', ';']).unwrap_or(rest.len())];
            list.split(|character| !is_part(character))
        })
        .collect();
    tests
        .filter(|test| !named.contains(test))
        .map(|test| {
            let path = path.display();
            format!("{path}: no list names the test `{test}`: add it to `whole_suite` in tests/src/lib.rs")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_that_no_list_names_are_found() {
        let text = "pub fn one<T: TestBackend>() {\n}\npub fn two<A: TestBackend, B: TestBackend>() {\n}\n\
                    pub fn helper<T: TestBackend>(scene: &Scene) {\n}\npub fn plain() {\n}\n";
        let unlisted = |lists: &str| unlisted(Path::new("a.rs"), text, lists);
        assert!(unlisted("a::{ one, two }").is_empty());
        assert!(unlisted("a::{ one }\na::two::<Cpu, Vulkan>();").is_empty());
        for lists in ["a::{ one, two_more }", "a::{ one } b::{ two }", "a::one::<Cpu>(); ba::{ two }"] {
            let faults = unlisted(lists);
            assert!(matches!(&faults[..], [fault] if fault.contains("a.rs") && fault.contains("`two`")), "{faults:?}");
        }
    }

    #[test]
    fn the_tests_of_this_repository_are_found() {
        let lib = fs::read_to_string(shell::root().join("tests/src/sun.rs")).unwrap();
        assert!(unlisted(Path::new("sun.rs"), &lib, "").len() >= 5);
        assert!(faults().unwrap().is_empty());
    }
}
