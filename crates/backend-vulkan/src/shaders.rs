//! The compiled shaders. Written by `cargo xtask shaders`.

use crate::device::Module;

pub(crate) static DEVICE_COPY: Module =
    Module { name: "device_copy", bytes: include_bytes!("../spirv/device_copy.spv") };

pub(crate) static EXAMPLE_PHOTONS: Module =
    Module { name: "example_photons", bytes: include_bytes!("../spirv/example_photons.spv") };

pub(crate) static FILM_END: Module =
    Module { name: "film_end", bytes: include_bytes!("../spirv/film_end.spv") };

pub(crate) static FILM_FOLD: Module =
    Module { name: "film_fold", bytes: include_bytes!("../spirv/film_fold.spv") };

/// All of them.
pub(crate) static ALL: [&Module; 4] = [
    &DEVICE_COPY,
    &EXAMPLE_PHOTONS,
    &FILM_END,
    &FILM_FOLD,
];
