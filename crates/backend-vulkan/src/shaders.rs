//! The compiled shaders. Written by `cargo xtask shaders`.

use crate::device::Module;

pub(crate) static DEVICE_COPY: Module =
    Module { name: "device_copy", bytes: include_bytes!("../spirv/device_copy.spv") };

/// All of them.
pub(crate) static ALL: [&Module; 1] = [&DEVICE_COPY];
