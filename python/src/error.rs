//! Errors, as exceptions of the module `photonmap`.

use photon_image::fault::{Fault, chain};
use photonmap::film::FilmFileError;
use photonmap::scene::SceneError;
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// A class of exceptions in `photonmap._errors`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Input,
    File,
    Device,
    Memory,
    Fork,
}

/// An error to be raised.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: Kind,
    text: String,
}

impl Failure {
    fn new(kind: Kind, text: impl Into<String>) -> Self {
        Self { kind, text: text.into() }
    }

    /// An argument is wrong.
    pub(crate) fn input(text: impl Into<String>) -> Self {
        Self::new(Kind::Input, text)
    }

    /// A file cannot be read or written.
    pub(crate) fn file(text: impl Into<String>) -> Self {
        Self::new(Kind::File, text)
    }

    /// A device or the system fails.
    pub(crate) fn device(text: impl Into<String>) -> Self {
        Self::new(Kind::Device, text)
    }

    /// Something of the parent is used in a forked child.
    pub(crate) fn fork(text: impl Into<String>) -> Self {
        Self::new(Kind::Fork, text)
    }

    /// Memory for `what` cannot be allocated.
    pub(crate) fn memory(what: &str, bytes: u128) -> Self {
        Self::new(Kind::Memory, format!("out of memory: {bytes} bytes for {what}"))
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl From<photonmap::Error> for Failure {
    fn from(error: photonmap::Error) -> Self {
        use photonmap::Error as E;
        let kind = match error {
            E::OutOfMemory { .. } | E::AllocationTooLarge { .. } => Kind::Memory,
            E::NoDevice { .. } | E::UnknownDevice { .. } | E::DeviceLost | E::Cancelled | E::Backend { .. } => {
                Kind::Device
            }
            _ => Kind::Input,
        };
        Self::new(kind, chain(&error))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        let kind = match error {
            SceneError::Read { .. } => Kind::File,
            SceneError::Memory { .. } | SceneError::OutOfMemory(_) => Kind::Memory,
            _ => Kind::Input,
        };
        Self::new(kind, chain(&error))
    }
}

impl From<FilmFileError> for Failure {
    fn from(error: FilmFileError) -> Self {
        let kind = match error {
            FilmFileError::Read { .. } | FilmFileError::Write { .. } => Kind::File,
            _ => Kind::Input,
        };
        Self::new(kind, chain(&error))
    }
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Input(text) => Self::input(text),
            other => Self::file(other.to_string()),
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        static CLASSES: [PyOnceLock<Py<PyType>>; 5] = [const { PyOnceLock::new() }; 5];
        let name = match failure.kind {
            Kind::Input => "InputError",
            Kind::File => "FileError",
            Kind::Device => "DeviceError",
            Kind::Memory => "OutOfMemoryError",
            Kind::Fork => "ForkError",
        };
        Python::attach(|py| match CLASSES[failure.kind as usize].import(py, "photonmap._errors", name) {
            Ok(class) => PyErr::from_type(class.clone(), failure.text),
            Err(_) => PyErr::from_type(PyRuntimeError::type_object(py), failure.text),
        })
    }
}
