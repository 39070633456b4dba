//! Equivalence of the CPU and Vulkan backends, in one process.

use backend_cpu::Cpu;
use backend_vulkan::{Vulkan, low_level};
use photon_tests::equivalence;
use photon_tests::harness::TestBackend;

struct OnCpu;

impl TestBackend for OnCpu {
    type On = Cpu;
    fn make(threads: usize) -> Cpu {
        Cpu::with_threads(threads).expect("threads start")
    }
}

struct OnVulkan;

impl TestBackend for OnVulkan {
    type On = Vulkan;
    fn make(_threads: usize) -> Vulkan {
        low_level::for_tests().expect("available a moment ago")
    }
}

macro_rules! both {
    ($($name:ident),+ $(,)?) => {$(
        #[test]
        fn $name() {
            if low_level::for_tests().is_some() {
                equivalence::$name::<OnCpu, OnVulkan>();
            }
        }
    )+};
}

both! {
    photons_leave_alike,
    paths_are_the_same_paths,
    tallies_agree,
    replayed_photons_give_the_same_estimates,
    uniform_plane_replays,
    means_are_equivalent,
    pictures_are_alike,
}
