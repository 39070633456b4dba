//! Errors of a glTF file, before the path of the file is added.

use std::fmt;
use std::path::Path;

use crate::error::SceneError;
use crate::load::budget::Shortage;

/// Hint for most damage, which the user cannot repair in the file itself.
pub(super) const AGAIN: &str = "export the file again";
/// Hint for truncated data.
pub(super) const COPY_AGAIN: &str = "it is truncated; copy or export it again";

/// A defect of a glTF file.
#[derive(Debug)]
pub(super) struct Fault {
    /// The object at fault and what is wrong with it: "accessor 7: has 3 elements, but …".
    what: String,
    /// What would be valid.
    hint: String,
    /// Line of the JSON text, from 1, if known.
    line: Option<u64>,
    /// What needs too much memory, in place of all that.
    shortage: Option<Shortage>,
}

impl Fault {
    pub(super) fn new(part: impl AsRef<str>, why: impl AsRef<str>, hint: impl Into<String>) -> Self {
        let what = format!("{}: {}", part.as_ref(), why.as_ref());
        Self { what, hint: hint.into(), line: None, shortage: None }
    }

    /// A reference to an object that the file does not have.
    pub(super) fn dangling(part: &str, kind: &str, index: usize, len: usize) -> Self {
        let there = match len {
            0 => format!("the file has no {kind}"),
            1 => format!("the only {kind} is number 0"),
            _ => format!("the last {kind} is number {}", len - 1),
        };
        Self::new(part, format!("refers to {kind} {index}, but {there}"), AGAIN)
    }

    /// The same error with a line number of the JSON text.
    pub(super) fn at_line(self, line: usize) -> Self {
        Self { line: (line > 0).then_some(line as u64), ..self }
    }

    /// Whether memory is short.
    pub(super) fn is_shortage(&self) -> bool {
        self.shortage.is_some()
    }

    /// Adds the path of the file.
    pub(super) fn in_file(self, path: &Path) -> SceneError {
        let Self { what, hint, line, shortage } = self;
        if let Some(shortage) = shortage {
            return shortage.in_file(path);
        }
        SceneError::Content { path: path.to_owned(), line, what, hint }
    }
}

impl From<Shortage> for Fault {
    fn from(shortage: Shortage) -> Self {
        let none = Self::new("the file", "needs too much memory", "");
        Self { shortage: Some(shortage), ..none }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.what, self.hint)
    }
}

/// Name of an object in messages: its kind and number, and its name if it has one.
pub(super) fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} '{name}'"),
        _ => format!("{kind} {index}"),
    }
}

/// The name, or kind and number of an object without a name.
pub(super) fn name_or_number(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("{kind} {index}"),
    }
}
