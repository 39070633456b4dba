//! Outputs of a command: each is tried, whatever becomes of the others.

use std::fmt;
use std::path::Path;

use crate::fault::Fault;
use crate::{atomic_write, stdout};

/// What was written, and what could not be.
#[derive(Debug, Default)]
pub struct Outputs {
    written: Vec<String>,
    faults: Vec<Fault>,
}

impl Outputs {
    /// Checks a path for a report.
    ///
    /// # Errors
    /// As [`atomic_write::check`].
    pub fn check_report(path: &Path) -> Result<(), Fault> {
        if stdout::is_meant(path) { Ok(()) } else { atomic_write::check(path) }
    }

    /// Adds a file, or the fault that prevents it.
    pub fn file(&mut self, path: &Path, result: Result<(), Fault>) {
        self.named(path.display().to_string(), result);
    }

    /// As [`Self::file`], with another name.
    pub fn named(&mut self, name: String, result: Result<(), Fault>) {
        match result {
            Ok(()) => self.written.push(name),
            Err(fault) => self.faults.push(fault),
        }
    }

    /// Writes a report to a file, or to standard output if the path is `-`.
    pub fn report(&mut self, path: &Path, report: &serde_json::Value) {
        let text = format!("{report:#}\n");
        if stdout::is_meant(path) {
            self.keep(stdout::write(text.as_bytes()));
        } else {
            self.file(path, atomic_write::write_bytes(path, text.as_bytes()));
        }
    }

    /// Keeps a fault of something else.
    pub fn keep(&mut self, result: Result<(), Fault>) {
        self.faults.extend(result.err());
    }

    /// Whether a file was written.
    #[must_use]
    pub fn any(&self) -> bool {
        !self.written.is_empty()
    }

    /// The end of the command.
    ///
    /// # Errors
    /// All faults.
    pub fn result(self) -> Result<(), Fault> {
        Fault::all(self.faults)
    }
}

impl fmt::Display for Outputs {
    /// The names of the files that were written.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.any() { to.write_str(&self.written.join(", ")) } else { to.write_str("nothing") }
    }
}
