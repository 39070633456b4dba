//! What is wrong with a file, before the file's own name is put in front of it.

use std::fmt;
use std::path::Path;

use crate::error::SceneError;

/// The mend of most damage: nothing in the file itself can be trusted to be what was meant.
pub(super) const AGAIN: &str = "export the file again";
/// The mend of what has been cut off.
pub(super) const COPY_AGAIN: &str = "it is truncated; copy or export it again";

/// A defect of a glTF file.
#[derive(Debug)]
pub(super) struct Fault {
    /// The culprit and what is wrong with it: "accessor 7: has 3 elements, but …".
    what: String,
    /// What would be right.
    hint: String,
    /// Where in the JSON text, from 1, where that is known.
    line: Option<u64>,
}

impl Fault {
    pub(super) fn new(part: impl AsRef<str>, why: impl AsRef<str>, hint: impl Into<String>) -> Self {
        let what = format!("{}: {}", part.as_ref(), why.as_ref());
        Self { what, hint: hint.into(), line: None }
    }

    /// A reference to something that the file does not have.
    pub(super) fn dangling(part: &str, kind: &str, index: usize, len: usize) -> Self {
        let there = match len {
            0 => format!("the file has no {kind}"),
            1 => format!("the only {kind} is number 0"),
            _ => format!("the last {kind} is number {}", len - 1),
        };
        Self::new(part, format!("refers to {kind} {index}, but {there}"), AGAIN)
    }

    /// The same, known to be at a line of the JSON text.
    pub(super) fn at_line(self, line: usize) -> Self {
        Self { line: (line > 0).then_some(line as u64), ..self }
    }

    /// With the name of the file.
    pub(super) fn in_file(self, path: &Path) -> SceneError {
        let Self { what, hint, line } = self;
        SceneError::Content { path: path.to_owned(), line, what, hint }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.what, self.hint)
    }
}

/// How a thing of the file is called in messages: its number, and its name if it has one.
pub(super) fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} '{name}'"),
        _ => format!("{kind} {index}"),
    }
}

/// Its name, or its kind and number where it has none.
pub(super) fn name_or_number(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("{kind} {index}"),
    }
}
