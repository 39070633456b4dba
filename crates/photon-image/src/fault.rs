//! Errors of the programs: one line that names the cause, and an exit code for the kind of error.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use photon_core::FileKind;

/// Why the program ends early.
// Exhaustive: each has an exit code.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// A user error: a wrong option or a wrong file. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// Any other error. Exit code 1.
    #[error("{0}")]
    Failure(String),
    /// `--memory` is too low: the library needs so many bytes. Exit code 2.
    #[error("the scene, the picture and a few photons need {}; allow more memory", bytes_text(*.0))]
    OverMemory(u64),
    /// The user stopped it; the line says what is written. Exit code 130.
    #[error("{0}")]
    Interrupted(String),
    /// Several faults, each with a line of its own. The exit code is that of the first.
    #[error("{}", lines(.0))]
    Several(Vec<Fault>),
}

/// The faults, line by line.
fn lines(faults: &[Fault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

impl Fault {
    /// A user error.
    pub fn input(message: impl ToString) -> Self {
        Self::Input(message.to_string())
    }

    /// Any other error.
    pub fn failure(message: impl ToString) -> Self {
        Self::Failure(message.to_string())
    }

    /// All of the faults, or success if there are none.
    ///
    /// # Errors
    /// The only fault, or [`Self::Several`].
    pub fn all(mut faults: Vec<Self>) -> Result<(), Self> {
        match faults.len() {
            0 => Ok(()),
            1 => Err(faults.remove(0)),
            _ => Err(Self::Several(faults)),
        }
    }

    /// In terms of the option `--memory`, if that is too low; the process needs `besides` bytes for other things.
    #[must_use]
    pub fn within(self, memory: Option<u64>, besides: u64) -> Self {
        match (self, memory) {
            (Self::OverMemory(needed), Some(cap)) => Self::Input(format!(
                "--memory {}: the scene, the picture and a few photons need at least {}; allow more, or make the picture smaller",
                bytes_text(cap),
                bytes_text(besides.saturating_add(needed))
            )),
            (other, _) => other,
        }
    }

    /// A file could not be written.
    pub fn writing(path: &Path, why: impl ToString) -> Self {
        Self::Failure(format!("{}: cannot be written: {}", path.display(), why.to_string()))
    }
}

/// Refuses a pipe or a device, which could be read without end, and a folder; a file that does not exist is left to its reader.
///
/// # Errors
/// [`Fault::Input`], which names the file.
pub fn check_regular(path: &Path) -> Result<(), Fault> {
    match std::fs::metadata(path) {
        Ok(data) if !data.is_file() => {
            Err(Fault::input(format!("{}: is not a regular file; write it to a file first", path.display())))
        }
        _ => Ok(()),
    }
}

/// Refuses a file of another known kind than `wanted`, which has this extension; a file that does not exist is left to its
/// reader.
///
/// # Errors
/// [`Fault::Input`], which names the file, what it is, and the remedy.
pub fn check_kind(path: &Path, extension: &str, wanted: &str) -> Result<(), Fault> {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(FileKind::START as u64).read_to_end(&mut start));
    let Some(kind) = FileKind::other_than(&[extension], &start).filter(|_| read.is_ok()) else { return Ok(()) };
    let text = if kind.extension.is_some() { format!("is {}, not {wanted}", kind.name) } else { kind.to_string() };
    Err(Fault::input(format!("{}: {text}", path.display())))
}

impl From<photon_core::Error> for Fault {
    fn from(error: photon_core::Error) -> Self {
        use photon_core::Error as E;
        let text = chain(&error);
        match error {
            E::InvalidSetting { .. }
            | E::InvalidInput { .. }
            | E::InvalidScene { .. }
            | E::NoTriangles
            | E::NoLight
            | E::NoReceiver
            | E::OutOfMemory { .. }
            | E::AllocationTooLarge { .. } => Self::Input(text),
            E::OverMemory { needed, .. } => Self::OverMemory(needed),
            E::Cancelled => Self::Interrupted("interrupted before a pass was finished: nothing is written".to_owned()),
            _ => Self::Failure(text),
        }
    }
}

impl From<photon_scene::SceneError> for Fault {
    fn from(error: photon_scene::SceneError) -> Self {
        match error {
            // Twice what is missing, since loading may take half.
            photon_scene::SceneError::Memory { needed, left, .. } => Self::Input(format!(
                "{error}: at least {} more, of which loading may take half, by --memory or on a machine that has them free",
                bytes_text(needed.saturating_sub(left).saturating_mul(2))
            )),
            other => Self::input(other),
        }
    }
}

impl From<photon_film::FilmFileError> for Fault {
    fn from(error: photon_film::FilmFileError) -> Self {
        use photon_film::FilmFileError as E;
        match error {
            E::Write { .. } => Self::failure(error),
            _ => Self::input(error),
        }
    }
}

/// An error and its causes, in one line.
#[must_use]
pub fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// A size in bytes or MiB, rounded up, so that it is enough.
#[must_use]
pub fn bytes_text(bytes: u64) -> String {
    match bytes {
        0..1_000_000 => bytes.to_string(),
        _ => format!("{}MiB", bytes.div_ceil(1 << 20)),
    }
}
