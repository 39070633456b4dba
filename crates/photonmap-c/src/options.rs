//! Parts that several calls share: settings, backends, views.

use std::ffi::{c_char, c_void};

use photonmap::scene::LoadOptions;
use photonmap::{Fixed, Settings};

use crate::caster::PmCaster;
use crate::error::{Fault, PmStatus, Result};
use crate::pointer;

/// The picture: its size and camera.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmView {
    /// sizeof(PmView).
    pub size: usize,
    /// Name of a camera of the scene; NULL: the first one.
    pub camera: *const c_char,
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1. At most 2^31 pixels in all.
    pub height: u32,
}

/// How scene files are read. All zero, except for the size: no overrides, no limit.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmLoadOptions {
    /// sizeof(PmLoadOptions).
    pub size: usize,
    /// Path of a TOML file that changes or adds materials, lights, cameras and an environment, UTF-8; NULL: none.
    pub overrides: *const c_char,
    /// Limit in bytes on what reading holds at any time: files, meshes, textures and images; 0: none but the fixed ones.
    /// Textures that do not fit are reduced, which the scene's report says; if that is not enough, the call fails with
    /// PM_STATUS_OUT_OF_MEMORY before anything too large is decoded. Tables that are made of the scene do not count.
    pub memory: u64,
}

/// What a renderer runs on. All zero, except for the size: all cores, with the library's own ray caster.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmDevice {
    /// sizeof(PmDevice).
    pub size: usize,
    /// "cpu"; "gpu"; "auto": a GPU if there is one, and no caster, else the CPU; a device of pm_devices() by index or a part of
    /// its name, "gpu:1"; or "vulkan": the device that Vulkan prefers, even a software driver, which "auto" and "gpu" never take.
    /// NULL: "cpu". For "gpu" and "vulkan", the environment variable PHOTON_VK_DEVICE selects a device.
    pub backend: *const c_char,
    /// The caller's ray caster; NULL: that of the library. Only on the CPU.
    pub caster: *const PmCaster,
    /// Number of threads on the CPU, at most 4096; 0: one for each core. Pictures do not depend on it.
    pub threads: u32,
}

/// What a progress function is called with.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PmProgress {
    /// Size of this struct in the library.
    pub size: usize,
    /// Index of the pass.
    pub pass: u32,
    /// Passes that this call of pm_renderer_passes() has finished.
    pub done: u32,
    /// Passes that it was asked for.
    pub count: u32,
    /// Photon paths of the present pass that have been traced, and their number. Equal at the end of a pass.
    pub traced: u32,
    /// Photon paths of the present pass.
    pub total: u32,
}

/// A progress function: called several times while the photons of each pass are traced, on the thread that renders.
/// Returns 0 to go on; anything else stops the render within the pass. It must not use the renderer, nor throw exceptions.
pub type PmProgressFunction = Option<unsafe extern "C" fn(user: *mut c_void, progress: *const PmProgress) -> i32>;

pointer::versioned!(PmLoadOptions, PmView, PmDevice, PmProgress);

/// Overrides and limits; NULL is none of them.
///
/// # Safety
/// `options` is NULL or a struct, whose texts are valid.
pub(crate) unsafe fn loading<'a>(options: *const PmLoadOptions) -> Result<(Option<&'a str>, LoadOptions)> {
    if options.is_null() {
        return Ok((None, LoadOptions::default()));
    }
    // SAFETY: as the caller ensures.
    let (given, overrides) = unsafe {
        let given = pointer::read(options)?;
        (given, pointer::text_or_null(given.overrides, "overrides")?)
    };
    Ok((overrides, LoadOptions::default().with_memory((given.memory > 0).then_some(given.memory))))
}

/// Settings from JSON; NULL is `{}`.
///
/// # Safety
/// `json` is NULL or a text.
pub(crate) unsafe fn settings(json: *const c_char) -> Result<Settings> {
    // SAFETY: as the caller ensures.
    Ok(unsafe { given_settings(json) }?.0)
}

/// Settings from JSON, and those that it fixes; NULL is `{}`.
///
/// # Safety
/// `json` is NULL or a text.
pub(crate) unsafe fn given_settings(json: *const c_char) -> Result<(Settings, Fixed)> {
    // SAFETY: as the caller ensures.
    let Some(text) = (unsafe { pointer::text_or_null(json, "settings") })? else {
        return Ok((Settings::default(), Fixed::default()));
    };
    // An array would be read as the values of the first fields.
    if !text.trim_start().starts_with('{') {
        return Err(Fault::new(
            PmStatus::InvalidSettings,
            "settings: not a JSON object, such as {\"photons\": 100000}",
        ));
    }
    let invalid = |error: serde_json::Error| Fault::new(PmStatus::InvalidSettings, format!("settings: {error}"));
    let settings: Settings = serde_json::from_str(text).map_err(invalid)?;
    settings.validate()?;
    let fields: serde_json::Map<String, serde_json::Value> = serde_json::from_str(text).map_err(invalid)?;
    Ok((settings, Fixed::given(|name| fields.contains_key(name))))
}
