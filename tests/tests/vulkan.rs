//! The suite on Vulkan, with the validation layer enabled.

use backend_vulkan::{Vulkan, low_level};
use photon_tests::harness::TestBackend;

struct VulkanUnderTest;

impl TestBackend for VulkanUnderTest {
    type On = Vulkan;

    fn make(_threads: usize) -> Vulkan {
        low_level::for_tests().expect("available a moment ago")
    }

    fn available() -> bool {
        low_level::for_tests().is_some()
    }
}

photon_tests::whole_suite!(VulkanUnderTest);
