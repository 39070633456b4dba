//! Equivalence of the CPU and Vulkan backends, in one process.

use photon_tests::backends::{OnCpu, OnValidatedVulkan};
use photon_tests::harness::TestBackend;
use photon_tests::{equivalence, media_equivalence, portals};

macro_rules! both {
    ($module:ident: $($name:ident),+ $(,)?) => {$(
        #[test]
        fn $name() {
            if OnValidatedVulkan::available() {
                $module::$name::<OnCpu, OnValidatedVulkan>();
            }
        }
    )+};
}

both! {
    equivalence:
    photons_leave_alike,
    paths_are_the_same_paths,
    tallies_agree,
    replayed_photons_give_the_same_estimates,
    uniform_plane_replays,
    means_are_equivalent,
    pictures_are_alike,
    alpha_is_the_same,
}

both! { media_equivalence: pictures_of_fog_are_alike, pictures_of_a_cloud_are_alike }

both! { portals: photons_leave_alike_through_portals }
