//! The quick extent of the extremes, on every backend.

use photon_tests::backends::{OnCpu, OnValidatedVulkan};
use photon_tests::extremes::{Extent, Group, Sheet, groups};
use photon_tests::harness::TestBackend;

fn check(groups: &[(&'static str, Group)], name: &str) {
    let (_, group) = groups.iter().find(|(own, _)| *own == name).expect("a group of that name");
    let sheet = Sheet::run(*group, Extent::Tests);
    assert!(!sheet.rows.is_empty() && sheet.faults().is_empty(), "{:#?}", sheet.faults());
}

macro_rules! both {
    ($($cpu:ident, $vulkan:ident: $name:literal;)+) => {$(
        #[test]
        fn $cpu() {
            check(&groups::<OnCpu>(), $name);
        }

        #[test]
        fn $vulkan() {
            if OnValidatedVulkan::available() {
                check(&groups::<OnValidatedVulkan>(), $name);
            }
        }
    )+};
}

both! {
    scale_on_cpu, scale_on_vulkan: "Scale and place";
    power_on_cpu, power_on_vulkan: "Power and counts";
    points_on_cpu, points_on_vulkan: "Points";
    large_on_cpu, large_on_vulkan: "Large maps";
    geometry_on_cpu, geometry_on_vulkan: "Geometry";
    optics_on_cpu, optics_on_vulkan: "Optics";
    views_on_cpu, views_on_vulkan: "Cameras and lights";
}
