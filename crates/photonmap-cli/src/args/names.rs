//! The words that options take.

use clap::ValueEnum;

macro_rules! names {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident),+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub enum $name { $($(#[$variant_doc])* $variant),+ }
    };
}

names!(/// Presets.
    PresetName { /// A first look.
        Preview, /// A picture to work with.
        Balanced, /// A picture to keep.
        Final });
names!(/// Backends.
    BackendName { /// A GPU if there is a suitable one, else the processor's cores.
        Auto, /// The processor's cores.
        Cpu, /// What Vulkan offers; PHOTON_VK_DEVICE names one of several.
        Vulkan });
names!(/// Estimators.
    EstimatorName { /// All photons within a radius that shrinks.
        Radius, /// The k nearest.
        Knn, /// Equation (2) of Lin and Wang 2010, errors included.
        Paper });
names!(/// Ways to arrange photons.
    IndexName { /// Left-balanced kd-tree.
        Median, /// kd-tree by the Voxel Volume Heuristic.
        Vvh, /// Morton order.
        Morton });
names!(/// What is divided by.
    AreaName { /// The disc, though it may hang over the end of its surface.
        Disc, /// What of the disc lies on the surface.
        Surface });
names!(/// Radii.
    BandwidthName { /// One for all pixels of a map.
        Shared, /// One for each pixel.
        PerPixel });
names!(/// Indirect light.
    IndirectName { /// Straight from the global map.
        Map, /// By final gathering.
        Gather, /// Left out.
        None });
names!(/// Direct light.
    DirectName { /// Shadow rays.
        Nee, /// Photons.
        Photons, /// Left out.
        None });
names!(/// Ways to share out paths.
    SharingName { /// Fixed quotas.
        Static, /// A shared counter.
        Dynamic });
names!(/// Random numbers.
    RngName { /// Counter-based.
        Counter, /// The paper's.
        Lcg, /// Counter-based, but photons leave lights by a low-discrepancy sequence.
        Sobol });
