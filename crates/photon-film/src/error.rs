//! Errors of film files, each with its file, its cause and a remedy.

use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why a film file cannot be read, written or merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmFileError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file is truncated, altered, or no film at all.
    #[error("{}: is not a whole film file: {why}; use a copy of it, or render it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The file is of another kind.
    #[error("{}: is no film file: it {}", path.display(), found(kind))]
    OtherKind {
        /// The file.
        path: PathBuf,
        /// The kind that it is of, with the remedy.
        kind: photon_core::FileKind,
    },
    /// A later version of this library wrote the file.
    #[error("{}: has format {found}, but this version reads formats up to {known}; use a newer version", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u64,
        /// The newest format that this version reads.
        known: u64,
    },
    /// Its passes belong to another picture.
    #[error(
        "{}: its {what} is {found}, not {expected}; a film is continued or merged only with the same scene, view and \
         settings",
        path.display()
    )]
    OtherKey {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: String,
        /// The value in the file.
        found: String,
        /// The value of the render, or of the other films.
        expected: String,
    },
    /// A pass would count twice.
    #[error(
        "{}: passes {}..{} of seed {seed} are in another of the films too; leave one of the two out",
        path.display(),
        passes.start,
        passes.end
    )]
    PassTwice {
        /// The file.
        path: PathBuf,
        /// Seed of the passes.
        seed: u64,
        /// Their indices.
        passes: Range<u32>,
    },
    /// A film with a pass that was cut short, or whose passes are not known, is not stored.
    #[error("{}: cannot be written: {why}", path.display())]
    NotStorable {
        /// The file.
        path: PathBuf,
        /// What is wrong with the film.
        why: &'static str,
    },
    /// The file cannot be written.
    #[error("{}: cannot be written: {why}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The cause.
        why: String,
    },
    /// The film is invalid, or there is not enough memory for it.
    #[error("{}: {source}", path.display())]
    Film {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: photon_core::Error,
    },
    /// No films to merge.
    #[error("no films to merge; name at least one")]
    NoFilms,
}

impl FilmFileError {
    pub(crate) fn damaged(path: &Path, why: impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), why: shown(&why.to_string()) }
    }

    pub(crate) fn write(path: &Path, why: impl ToString) -> Self {
        Self::Write { path: path.to_owned(), why: why.to_string() }
    }

    pub(crate) fn film(path: &Path, source: photon_core::Error) -> Self {
        Self::Film { path: path.to_owned(), source }
    }
}

/// A text from a file as it is shown: without control characters, which a terminal would obey, and cut at 300 characters.
#[must_use]
pub fn shown(text: &str) -> String {
    const MOST: usize = 300;
    let mut shown = String::new();
    for (count, letter) in text.chars().enumerate() {
        if count == MOST {
            shown.push('…');
            break;
        }
        match letter {
            _ if letter.is_control() => shown.extend(letter.escape_default()),
            _ => shown.push(letter),
        }
    }
    shown
}

/// The kind of a file, with a remedy if files of its kind are of no use here.
fn found(kind: &photon_core::FileKind) -> String {
    if kind.extension.is_some() { format!("is {}", kind.name) } else { kind.to_string() }
}
