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

pub(crate) static SCAN_ALONE: Module =
    Module { name: "scan_alone", bytes: include_bytes!("../spirv/scan_alone.spv") };

pub(crate) static SCAN_SUMS: Module =
    Module { name: "scan_sums", bytes: include_bytes!("../spirv/scan_sums.spv") };

pub(crate) static SCAN_TILES: Module =
    Module { name: "scan_tiles", bytes: include_bytes!("../spirv/scan_tiles.spv") };

/// All of them.
pub(crate) static ALL: [&Module; 9] = [
    &CAMERA_COMPACT,
    &CAMERA_GATHERED,
    &DEVICE_COPY,
    &EXAMPLE_PHOTONS,
    &FILM_END,
    &FILM_FOLD,
    &SCAN_ALONE,
    &SCAN_SUMS,
    &SCAN_TILES,
];
