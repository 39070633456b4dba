//! The suite on the CPU.

use photon_tests::backends::OnCpu;

photon_tests::whole_suite!(OnCpu);
