//! What can go wrong, each naming its culprit and its mend.

use crate::features::Features;

/// The result of everything that can fail here.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Stages were built for less than the scene needs.
    #[error("the scene needs {missing}, which the stages were not built for; derive the requirements from this scene")]
    MissingFeatures {
        /// What is lacking.
        missing: Features,
    },
    /// More elements than a buffer holds.
    #[error(
        "{label}: {needed} elements do not fit a buffer of {capacity}; allow {needed}, or emit fewer photons per pass"
    )]
    CapacityExceeded {
        /// The buffer.
        label: &'static str,
        /// How many there are.
        needed: u64,
        /// How many fit.
        capacity: u64,
    },
    /// Memory ran out.
    #[error("out of memory: {bytes} bytes for {label}")]
    OutOfMemory {
        /// The buffer.
        label: &'static str,
        /// Its size.
        bytes: u64,
    },
    /// A setting that makes no sense.
    #[error("{name} is {value}, but {mend}")]
    InvalidSetting {
        /// The setting.
        name: &'static str,
        /// What it was set to.
        value: String,
        /// What it may be.
        mend: &'static str,
    },
    /// Data of the caller's that make no sense.
    #[error("{what} {index}: {why}")]
    InvalidInput {
        /// What kind of thing.
        what: &'static str,
        /// Which of them.
        index: u64,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// Nothing gives light.
    #[error("no light gives any power; add an emissive material or a light, in the file or in an override file")]
    NoLight,
    /// Nothing keeps a photon.
    #[error("no surface can keep a photon: every material is specular or black; give one a diffuse albedo above 0")]
    NoReceiver,
    /// No device can do it.
    #[error("no usable device among {}", rejected.len())]
    NoDevice {
        /// Each device's name, and what it lacks.
        rejected: Vec<(String, String)>,
    },
    /// The device stopped answering.
    #[error("the device was lost; what earlier passes gave is kept")]
    DeviceLost,
    /// The observer asked to stop before there was anything to show.
    #[error("cancelled before there was a picture")]
    Cancelled,
    /// Something beneath the backend.
    #[error("{backend}")]
    Backend {
        /// Which backend, and what it was doing.
        backend: &'static str,
        /// The cause.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}
