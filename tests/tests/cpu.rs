//! The suite on the CPU.

use backend_cpu::Cpu;
use photon_tests::harness::TestBackend;

struct CpuUnderTest;

impl TestBackend for CpuUnderTest {
    type On = Cpu;
    fn make(threads: usize) -> Cpu {
        Cpu::with_threads(threads).expect("threads start")
    }
}

photon_tests::whole_suite!(CpuUnderTest);
