//! The picture as it is shown, made on the device: four bytes per pixel are copied instead of the sums.

use photon_core::{Display, DisplayImage, Error, Result};

use super::{GROUP, VulkanFilm, label};
use crate::constants::FIRST_HITS;
use crate::shaders;
use crate::vulkan::Vulkan;

parameters! {
    struct DisplayPush => FILM_DISPLAY {
        sums: [u64; 4],
        /// Plane of hits.
        hits: u64,
        shown: u64,
        pixels: u32,
        /// From a sum to a radiance, with the exposure unless that comes after clamping.
        factor: f32,
        exposure: f32,
        inverse_paths: f32,
    }
}

specialized!(display_constants: DisplayConstants => FILM_DISPLAY,
    2 layers: u32, 3 curve: u32, 4 is_transparent: bool, 5 is_clamped: bool);

/// Computes the picture and reads it back.
pub(super) fn read(on: &mut Vulkan, film: &mut VulkanFilm, display: &Display, clamp: bool) -> Result<DisplayImage> {
    display.validate()?;
    let pixels = film.pixels();
    if film.shown.is_none() {
        film.shown = match on.memory("film", pixels * 4).map_err(label) {
            // A picture on a screen must not end the render.
            Err(Error::OutOfMemory { .. }) => None,
            memory => Some(memory?),
        };
        film.note(on);
    }
    let Some(shown) = &film.shown else { return Ok(super::read(on, film)?.display_clamped(display, clamp)) };
    let passes = f64::from(film.passes.max(1));
    let factor = film.units.radiance_to_user() / passes;
    let scale = f64::from(display.exposure.exp2());
    let (factor, exposure) = if clamp { (factor, scale) } else { (factor * scale, 1.0) };
    let finite = |x: f64| x.min(f64::from(f32::MAX)) as f32;
    let push = DisplayPush {
        sums: std::array::from_fn(|i| film.layers[i].as_ref().map_or(0, |plane| plane.sum.address())),
        hits: film.first_sum.address() + u64::from(FIRST_HITS) * pixels * 4,
        shown: shown.address(),
        pixels: pixels as u32,
        factor: finite(factor),
        exposure: finite(exposure),
        inverse_paths: (1.0 / (passes * f64::from(film.camera_samples))) as f32,
    };
    let constants = DisplayConstants {
        layers: film.layer_bits(),
        curve: display.tone_map as u32,
        is_transparent: display.transparent,
        is_clamped: clamp,
    };
    let kernel = on.kernel(&shaders::FILM_DISPLAY, GROUP, &constants);
    on.dispatch(&kernel, &push, pixels.div_ceil(u64::from(GROUP)))?;
    let mut bytes = vec![[0; 4]; pixels as usize];
    on.read(shown, 0, bytemuck::cast_slice_mut(&mut bytes))?;
    DisplayImage::new(film.width, film.height, film.passes, bytes)
}
