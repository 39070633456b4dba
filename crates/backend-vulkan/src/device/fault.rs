//! What Vulkan says when it fails, as errors of this library.

use ash::vk;
use photon_core::Error;

/// Why there is no device to work on, or why a call of Vulkan's failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum Fault {
    /// The library that finds drivers is not installed.
    #[error(
        "no Vulkan loader ({0}): install it (Debian: libvulkan1; Windows: the graphics driver; macOS: MoltenVK), or use the CPU backend"
    )]
    NoLoader(String),
    /// The loader found no driver.
    #[error(
        "a Vulkan loader, but no driver ({0}): install the driver of your GPU, or a software one (Debian: mesa-vulkan-drivers), or use the CPU backend"
    )]
    NoDriver(String),
    /// A call failed.
    #[error("{what}: {result}")]
    Call {
        /// What was called for.
        what: &'static str,
        /// What it returned.
        result: vk::Result,
    },
    /// Validation was asked for.
    #[error(
        "validation was asked for, but the layer VK_LAYER_KHRONOS_validation is not installed (Debian: vulkan-validationlayers)"
    )]
    NoValidation,
    /// Something else, in words.
    #[error("{0}")]
    Other(String),
}

impl From<Fault> for Error {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Call { result: vk::Result::ERROR_DEVICE_LOST, .. } => Self::DeviceLost,
            other => Self::Backend { backend: "vulkan", source: Box::new(other) },
        }
    }
}

/// Names the call that failed.
pub(crate) fn during(what: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| Fault::Call { what, result }.into()
}
