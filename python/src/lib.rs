//! The compiled part of the Python package `photonmap`. The classes that users see are in the Python files beside it.
#![forbid(unsafe_code)]

mod blocks;
mod error;
mod film;
mod frame;
mod gpu;
mod map;
mod observe;
mod points;
mod process;
mod render;
mod scene;
mod settings;
mod texture;
mod trace;
mod tree;

use pyo3::prelude::*;

/// The compiled part of `photonmap`.
#[pymodule]
mod _photonmap {
    #[pymodule_export]
    use crate::blocks::add_blocks;
    #[pymodule_export]
    use crate::film::{RawFilm, check_blocks, check_writable, write_bytes};
    #[pymodule_export]
    use crate::gpu::prefers_gpu;
    #[pymodule_export]
    use crate::map::RawMap;
    #[pymodule_export]
    use crate::render::Renderer;
    #[pymodule_export]
    use crate::scene::{RawBuilder, RawScene, builtin_scenes, environment_text};
    #[pymodule_export]
    use crate::settings::{preset_passes, settings_json};
    #[pymodule_export]
    use crate::trace::trace_photons;
    #[pymodule_export]
    use crate::tree::Tree;
}
