//! GPU backend: the photon-mapping pipeline in Vulkan 1.2 compute shaders, from photon emission to the finished
//! film.
//!
//! It uses no rasterisation, no ray-tracing extension and no float atomics. Start with [`Vulkan`];
//! `docs/studies/shaders.md` describes the kernels.
//!
//! Another renderer can supply its own device ([`Vulkan::from_raw`]) and its own photons
//! ([`VulkanBuffer::from_raw`]), which then never leave the GPU.

// First, since their macros are used in the modules below.
#[macro_use]
mod parameters;
#[macro_use]
mod specialization;

mod backend;
mod constants;
mod device;
mod dispatch_limits;
mod film;
pub mod gpu;
mod index;
pub mod low_level;
mod map;
#[cfg(test)]
mod probe;
mod rays;
mod scan;
mod scene;
mod shaders;
mod sort;
mod stages;
mod transport;
mod vulkan;

pub use ash;
pub use device::buffer::VulkanBuffer;
pub use device::{Candidate, Fault, Limits, Options, RawDevice, devices, preferred};
pub use film::VulkanFilm;
pub use map::VulkanMap;
pub use scene::VulkanScene;
pub use vulkan::Vulkan;
