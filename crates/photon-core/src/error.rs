//! What can go wrong, each naming its culprit and its mend.

use crate::requirements::features::Features;

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
    /// One buffer is more than the device gives in one piece, whatever memory is free.
    #[error(
        "{label}: {bytes} bytes, but the device gives at most {limit} in one piece; render fewer photons per pass, or \
         fewer pixels"
    )]
    AllocationTooLarge {
        /// The buffer.
        label: &'static str,
        /// Its size.
        bytes: u64,
        /// What the device allows.
        limit: u64,
    },
    /// More memory would be needed than is allowed, however small the passes.
    #[error(
        "at least {needed} bytes are needed for the scene, the picture and a few photons, but only {allowed} are allowed; \
         allow more, or make the picture smaller"
    )]
    OverMemory {
        /// The least that would do, bytes.
        needed: u64,
        /// What is allowed, bytes.
        allowed: u64,
    },
    /// A setting that makes no sense.
    #[error("{name} is {value}, but {hint}")]
    InvalidSetting {
        /// The setting.
        name: &'static str,
        /// What it was set to.
        value: String,
        /// What it may be.
        hint: &'static str,
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
    /// A scene view that is wrong as a whole: [`crate::SceneView::validate`].
    #[error("scene view: {what} is {value}; {hint}")]
    InvalidScene {
        /// The member, or what is counted.
        what: &'static str,
        /// What it is.
        value: String,
        /// What it must be.
        hint: &'static str,
    },
    /// Nothing gives light.
    #[error("no light gives any power; add an emissive material or a light, in the file or in an override file")]
    NoLight,
    /// Nothing keeps a photon.
    #[error("no surface can keep a photon: every material is specular or black; give one a diffuse albedo above 0")]
    NoReceiver,
    /// No device can do it.
    #[error("no suitable device: {}; update its driver, choose another device, or use the CPU backend", each(rejected))]
    NoDevice {
        /// Each device's name, and what it lacks.
        rejected: Vec<(String, String)>,
    },
    /// The device stopped answering, and took with it what it held, films included.
    #[error(
        "the device was lost, and the picture with it; render again, and if it is lost again, with fewer photons per \
         pass or a newer driver"
    )]
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

fn each(rejected: &[(String, String)]) -> String {
    if rejected.is_empty() {
        return "none is there".to_owned();
    }
    rejected.iter().map(|(name, why)| format!("{name} {why}")).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rejected_device_is_named_with_its_fault_and_a_mend() {
        let rejected = [("Old card", "lacks shaderInt64"), ("Soft", "is slow")];
        let rejected = rejected.map(|(name, why)| (name.to_owned(), why.to_owned())).to_vec();
        let text = Error::NoDevice { rejected }.to_string();
        assert!(text.contains("Old card lacks shaderInt64; Soft is slow") && text.contains("CPU backend"), "{text}");
        let text = Error::NoDevice { rejected: Vec::new() }.to_string();
        assert!(text.contains("none is there"), "{text}");
    }

    #[test]
    fn memory_names_the_buffer_and_the_limit() {
        let text = Error::AllocationTooLarge { label: "queries", bytes: 5000, limit: 4096 }.to_string();
        assert!(["queries", "5000", "4096", "fewer"].iter().all(|part| text.contains(part)), "{text}");
    }
}
