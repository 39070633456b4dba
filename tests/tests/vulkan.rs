//! The suite on Vulkan, with the validation layer enabled.

use photon_tests::backends::OnValidatedVulkan;

photon_tests::whole_suite!(OnValidatedVulkan);
