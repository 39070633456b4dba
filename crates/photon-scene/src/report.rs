//! Reports on what a loader could not represent exactly.

use photon_core::shown;
use std::fmt;

/// How a loader handled the subject of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReportKind {
    /// It is rendered, but not exactly as in the file.
    Approximated,
    /// It is not rendered.
    LeftOut,
    /// Nothing is lost; information for the user.
    Note,
}

/// One message of a loader.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReportLine {
    /// How the subject was handled.
    pub kind: ReportKind,
    /// Name of the material, mesh, node or light.
    pub subject: String,
    /// What was changed, and what the user can do about it.
    pub text: String,
}

impl fmt::Display for ReportLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            ReportKind::Approximated => "approximated",
            ReportKind::LeftOut => "left out",
            ReportKind::Note => "note",
        };
        write!(f, "{kind}: {}: {}", self.subject, self.text)
    }
}

/// All messages of a loader, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadReport {
    /// The lines.
    pub lines: Vec<ReportLine>,
}

impl LoadReport {
    /// Adds [`ReportKind::Approximated`].
    pub fn approximated(&mut self, subject: impl Into<String>, text: impl Into<String>) {
        self.push(ReportKind::Approximated, subject.into(), text.into());
    }

    /// Adds [`ReportKind::LeftOut`].
    pub fn left_out(&mut self, subject: impl Into<String>, text: impl Into<String>) {
        self.push(ReportKind::LeftOut, subject.into(), text.into());
    }

    /// Adds [`ReportKind::Note`].
    pub fn note(&mut self, subject: impl Into<String>, text: impl Into<String>) {
        self.push(ReportKind::Note, subject.into(), text.into());
    }

    /// Whether the scene is rendered exactly as in its file: the report contains only notes.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.lines.iter().all(|line| line.kind == ReportKind::Note)
    }

    /// Appends the lines of another report.
    #[cfg(feature = "files")]
    pub(crate) fn extend(&mut self, other: Self) {
        for ReportLine { kind, subject, text } in other.lines {
            self.push(kind, subject, text);
        }
    }

    pub(crate) fn push(&mut self, kind: ReportKind, subject: String, text: String) {
        // Both may contain names of the file, of any length.
        let line = ReportLine { kind, subject: shown(&subject).into_owned(), text: shown(&text).into_owned() };
        // Repeated lines on the same subject are reported once; only the last 100 lines are compared, so that a file
        // with a million materials does not take quadratic time.
        if !self.lines.iter().rev().take(100).any(|known| *known == line) {
            self.lines.push(line);
        }
    }
}

impl fmt::Display for LoadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, line) in self.lines.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{line}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_said_once_and_name_their_subject() {
        let mut report = LoadReport::default();
        assert!(report.is_exact());
        report.note("file", "no camera");
        assert!(report.is_exact());
        for _ in 0..2 {
            report.left_out("wall", "its texture; give an albedo");
        }
        assert!(!report.is_exact());
        assert_eq!(report.to_string(), "note: file: no camera\nleft out: wall: its texture; give an albedo");
        report.note("wall \u{1b}[31m", "a".repeat(1000));
        let line = report.lines.last().expect("a line").to_string();
        assert!(line.starts_with("note: wall \\u{1b}[31m: aaa") && line.len() < 350, "{line}");
    }
}
