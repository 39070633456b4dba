//! Errors, each with its cause and a remedy.

use std::ops::Range;

use crate::memory::OutOfMemory;
use crate::requirements::features::Features;
use crate::shown;

/// The result type of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The errors of this crate and of backends.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The stages were built for fewer features than the scene needs.
    #[error("the scene needs {missing}, which the stages were not built for; derive the requirements from this scene")]
    MissingFeatures {
        /// The features that are missing.
        missing: Features,
    },
    /// More elements than a buffer can hold.
    #[error(
        "{label}: {needed} elements do not fit into a buffer of {capacity}; raise the capacity to {needed}, or emit \
         fewer photons per pass"
    )]
    CapacityExceeded {
        /// Label of the buffer.
        label: &'static str,
        /// Number of elements.
        needed: u64,
        /// Capacity of the buffer, elements.
        capacity: u64,
    },
    /// An allocation failed.
    #[error("out of memory: {bytes} bytes for {label}{}", remedy(label))]
    OutOfMemory {
        /// Label of the buffer.
        label: &'static str,
        /// Its size, bytes.
        bytes: u64,
    },
    /// One buffer is larger than the device can allocate in one piece, however much memory is free.
    #[error(
        "{label}: {bytes} bytes, but the device allocates at most {limit} in one piece; render fewer photons per pass, or \
         fewer pixels"
    )]
    AllocationTooLarge {
        /// Label of the buffer.
        label: &'static str,
        /// Its size, bytes.
        bytes: u64,
        /// Largest allocation that the device allows, bytes.
        limit: u64,
    },
    /// Even with the smallest passes, more memory is needed than is allowed.
    #[error(
        "at least {needed} bytes are needed for the scene, the picture and a few photons, but only {allowed} are allowed; \
         allow more, or make the picture smaller"
    )]
    OverMemory {
        /// The smallest sufficient limit, bytes.
        needed: u64,
        /// The limit, bytes.
        allowed: u64,
    },
    /// A setting has an invalid value.
    #[error("{name} is {value}, but {hint}")]
    InvalidSetting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: String,
        /// What is valid, or what to change.
        hint: &'static str,
    },
    /// Input data of the caller are invalid.
    #[error("{what} {index}: {why}")]
    InvalidInput {
        /// Kind of the invalid element.
        what: &'static str,
        /// Index of the invalid element.
        index: u64,
        /// What is wrong, and what would be valid.
        why: String,
    },
    /// A scene view is inconsistent: [`crate::SceneView::validate`].
    #[error("scene view: {what} is {value}; {hint}")]
    InvalidScene {
        /// The member, or what is counted.
        what: &'static str,
        /// Its value.
        value: String,
        /// What it has to be.
        hint: &'static str,
    },
    /// The scene has no triangles, and nothing else that can be seen.
    #[error(
        "the scene has no triangles, so that there is nothing to see; check that its file has meshes, and what the \
         report says is left out"
    )]
    NoTriangles,
    /// The scene has no light with power above 0.
    #[error("no light emits any power; add an emissive material or a light, in the file or in an override file")]
    NoLight,
    /// No surface can store photons, and no light can be seen.
    #[error(
        "no surface can store photons, and no light can be seen: every material is specular or black, and all lights are \
         points or directions; give a material a diffuse albedo above 0, or add an area light or an environment"
    )]
    NoReceiver,
    /// No device is suitable.
    #[error("no suitable device: {}; update its driver, choose another device, or use the CPU backend", each(rejected))]
    NoDevice {
        /// Name of each device, and what it lacks.
        rejected: Vec<(String, String)>,
    },
    /// No device has the requested number or name.
    #[error("there is no device '{}'; {}; give a number, or a part of a name", shown(wanted), known.join("; "))]
    UnknownDevice {
        /// The requested number, or part of a name.
        wanted: String,
        /// Number and name of each device, such as `number 0 is llvmpipe`.
        known: Vec<String>,
    },
    /// The device was lost, with all buffers and films on it.
    #[error(
        "the device was lost, and the picture with it; render again, and if it is lost again, with fewer photons per \
         pass or a newer driver"
    )]
    DeviceLost,
    /// The observer cancelled the render before there was a picture.
    #[error("cancelled before there was a picture")]
    Cancelled,
    /// A film would contain a pass twice.
    #[error(
        "passes {}..{} of seed {seed} would count twice; render other passes, or the same passes with another seed",
        passes.start,
        passes.end
    )]
    PassTwice {
        /// Seed of the passes.
        seed: u64,
        /// Their indices.
        passes: Range<u32>,
    },
    /// A film whose pass was cut short was to be merged.
    #[error("a film with a pass that was cut short can be shown, but not merged; render the pass again")]
    CutPass,
    /// An error of a library or driver beneath the backend.
    #[error("{backend}")]
    Backend {
        /// Which backend, and what it was doing.
        backend: &'static str,
        /// The cause.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl From<OutOfMemory> for Error {
    fn from(OutOfMemory { label, bytes }: OutOfMemory) -> Self {
        Self::OutOfMemory { label, bytes }
    }
}

/// Settings that need less memory with this label, in words.
fn remedy(label: &str) -> &'static str {
    let is_of = |names: &[&str]| names.iter().any(|name| label.contains(name));
    if is_of(&["film", "quer", "camera", "estimates"]) {
        "; render fewer pixels"
    } else if is_of(&["photon"]) {
        "; render fewer photons per pass"
    } else {
        ""
    }
}

fn each(rejected: &[(String, String)]) -> String {
    if rejected.is_empty() {
        return "none was found".to_owned();
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
        assert!(text.contains("none was found"), "{text}");
    }

    #[test]
    fn memory_names_the_buffer_and_the_limit() {
        let text = Error::AllocationTooLarge { label: "queries", bytes: 5000, limit: 4096 }.to_string();
        assert!(["queries", "5000", "4096", "fewer"].iter().all(|part| text.contains(part)), "{text}");
    }
}
