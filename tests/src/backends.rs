//! The backends that the suite runs on.

use backend_cpu::Cpu;
use backend_vulkan::{Vulkan, low_level};

use crate::harness::TestBackend;

/// The CPU backend.
#[derive(Clone, Copy, Debug)]
pub struct OnCpu;

impl TestBackend for OnCpu {
    type On = Cpu;

    fn make(threads: usize) -> Cpu {
        Cpu::with_threads(threads).expect("threads start")
    }
}

/// The Vulkan backend, as users open it.
#[derive(Clone, Copy, Debug)]
pub struct OnVulkan;

impl TestBackend for OnVulkan {
    type On = Vulkan;

    fn make(_threads: usize) -> Vulkan {
        Vulkan::new().expect("available a moment ago")
    }

    fn available() -> bool {
        Vulkan::new().is_ok()
    }
}

/// The Vulkan backend, with the validation layer enabled: see [`low_level::for_tests`].
#[derive(Clone, Copy, Debug)]
pub struct OnValidatedVulkan;

impl TestBackend for OnValidatedVulkan {
    type On = Vulkan;

    const ONE_OF: u32 = 4;

    fn make(_threads: usize) -> Vulkan {
        low_level::for_tests().expect("available a moment ago")
    }

    fn available() -> bool {
        low_level::for_tests().is_some()
    }

    fn check(on: &Vulkan) {
        assert_eq!(on.validation_messages(), [""; 0]);
    }
}
