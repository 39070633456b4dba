//! The compiled shaders. Written by `cargo xtask shaders`.

use crate::device::Module;

pub(crate) static CAMERA_COMPACT: Module =
    Module { name: "camera_compact", bytes: include_bytes!("../spirv/camera_compact.spv") };

pub(crate) static CAMERA_GATHERED: Module =
    Module { name: "camera_gathered", bytes: include_bytes!("../spirv/camera_gathered.spv") };

pub(crate) static DEVICE_COPY: Module =
    Module { name: "device_copy", bytes: include_bytes!("../spirv/device_copy.spv") };

pub(crate) static EXAMPLE_PHOTONS: Module =
    Module { name: "example_photons", bytes: include_bytes!("../spirv/example_photons.spv") };

pub(crate) static FILM_END: Module =
    Module { name: "film_end", bytes: include_bytes!("../spirv/film_end.spv") };

pub(crate) static FILM_FOLD: Module =
    Module { name: "film_fold", bytes: include_bytes!("../spirv/film_fold.spv") };

pub(crate) static PROBE_BSDF: Module =
    Module { name: "probe_bsdf", bytes: include_bytes!("../spirv/probe_bsdf.spv") };

pub(crate) static PROBE_KERNEL: Module =
    Module { name: "probe_kernel", bytes: include_bytes!("../spirv/probe_kernel.spv") };

pub(crate) static PROBE_LAYOUT: Module =
    Module { name: "probe_layout", bytes: include_bytes!("../spirv/probe_layout.spv") };

pub(crate) static PROBE_MATH: Module =
    Module { name: "probe_math", bytes: include_bytes!("../spirv/probe_math.spv") };

pub(crate) static PROBE_OCTAHEDRAL: Module =
    Module { name: "probe_octahedral", bytes: include_bytes!("../spirv/probe_octahedral.spv") };

pub(crate) static PROBE_OFFSET: Module =
    Module { name: "probe_offset", bytes: include_bytes!("../spirv/probe_offset.spv") };

pub(crate) static PROBE_RANDOM: Module =
    Module { name: "probe_random", bytes: include_bytes!("../spirv/probe_random.spv") };

pub(crate) static PROBE_SAMPLING: Module =
    Module { name: "probe_sampling", bytes: include_bytes!("../spirv/probe_sampling.spv") };

pub(crate) static RAYS_NEAREST: Module =
    Module { name: "rays_nearest", bytes: include_bytes!("../spirv/rays_nearest.spv") };

pub(crate) static SCAN_ALONE: Module =
    Module { name: "scan_alone", bytes: include_bytes!("../spirv/scan_alone.spv") };

pub(crate) static SCAN_SUMS: Module =
    Module { name: "scan_sums", bytes: include_bytes!("../spirv/scan_sums.spv") };

pub(crate) static SCAN_TILES: Module =
    Module { name: "scan_tiles", bytes: include_bytes!("../spirv/scan_tiles.spv") };

/// All of them.
pub(crate) static ALL: [&Module; 18] = [
    &CAMERA_COMPACT,
    &CAMERA_GATHERED,
    &DEVICE_COPY,
    &EXAMPLE_PHOTONS,
    &FILM_END,
    &FILM_FOLD,
    &PROBE_BSDF,
    &PROBE_KERNEL,
    &PROBE_LAYOUT,
    &PROBE_MATH,
    &PROBE_OCTAHEDRAL,
    &PROBE_OFFSET,
    &PROBE_RANDOM,
    &PROBE_SAMPLING,
    &RAYS_NEAREST,
    &SCAN_ALONE,
    &SCAN_SUMS,
    &SCAN_TILES,
];
