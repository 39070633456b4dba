//! Vulkan failures as errors of this library.

use ash::vk;
use photon_core::Error;

/// Why Vulkan is not available, or which Vulkan call failed: the source of [`Error::Backend`], for
/// `downcast_ref`. If no device is suitable the error is [`Error::NoDevice`]; if the device stopped responding
/// it is [`Error::DeviceLost`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The Vulkan loader library is not installed.
    #[error(
        "no Vulkan loader ({0}): install it (Debian: libvulkan1; Windows: the graphics driver; macOS: MoltenVK), or use the CPU backend"
    )]
    NoLoader(String),
    /// The loader found no driver.
    #[error(
        "a Vulkan loader, but no driver ({0}): install the driver of your GPU, or a software one (Debian: mesa-vulkan-drivers), or use the CPU backend"
    )]
    NoDriver(String),
    /// A Vulkan call failed.
    #[error("{what}: {result}")]
    Call {
        /// The operation that failed.
        what: &'static str,
        /// The result code.
        result: vk::Result,
    },
    /// Validation was requested, but the layer is not installed.
    #[error(
        "validation was asked for, but the layer VK_LAYER_KHRONOS_validation is not installed (Debian: vulkan-validationlayers)"
    )]
    NoValidation,
    /// Another failure, in words.
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

/// Converts a result code into an error that names the failed operation.
pub(crate) fn during(what: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| Fault::Call { what, result }.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(error: Error) -> Fault {
        let Error::Backend { backend: "vulkan", source } = error else { panic!("{error:?}") };
        *source.downcast::<Fault>().expect("one of ours")
    }

    /// The errors can be told apart by their types, and each one says what to install.
    #[test]
    fn three_reasons_for_no_device_are_three_errors() {
        let loader = fault(Fault::NoLoader("not found".to_owned()).into());
        assert!(matches!(loader, Fault::NoLoader(_)));
        let driver = fault(Fault::NoDriver("none".to_owned()).into());
        assert!(matches!(driver, Fault::NoDriver(_)));
        let device = super::super::choose::choose(Vec::new(), None).unwrap_err();
        assert!(matches!(device, Error::NoDevice { .. }));
        let texts = [loader.to_string(), driver.to_string(), device.to_string()];
        for (text, hint) in texts.iter().zip(["libvulkan1", "mesa-vulkan-drivers", "another device"]) {
            assert!(text.contains(hint) && text.contains("CPU backend"), "{text}");
        }
    }

    #[test]
    fn a_lost_device_is_an_error_of_its_own() {
        assert!(matches!(during("waiting")(vk::Result::ERROR_DEVICE_LOST), Error::DeviceLost));
        let other = fault(during("waiting")(vk::Result::ERROR_UNKNOWN));
        assert!(other.to_string().starts_with("waiting"), "{other}");
    }
}
