//! The pipeline on a GPU: Vulkan 1.2 compute shaders, from photon emission to the finished film.
//!
//! No rasterisation, no ray-tracing extension, no float atomics. See [`Vulkan`] for where to start,
//! and `docs/shaders.md` for the kernels.
//!
//! Another renderer brings its own device ([`Vulkan::from_raw`]) and its own photons
//! ([`VulkanBuffer::from_raw`]), which then never leave the card.

mod backend;
mod buffer;
mod device;
mod film;
mod map;
#[cfg(test)]
mod probe;
mod scan;
mod shaders;
mod vulkan;

pub use ash;
pub use buffer::VulkanBuffer;
pub use device::{Candidate, Limits, Options, RawDevice, devices};
pub use film::VulkanFilm;
pub use map::VulkanMap;
pub use vulkan::Vulkan;
