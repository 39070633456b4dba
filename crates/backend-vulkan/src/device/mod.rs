//! The Vulkan layer: instance and device, memory, pipelines, and the command recorder.

pub(crate) mod buffer;

mod cache;
mod choose;
mod compiler;
mod fault;
mod inject;
mod instance;
mod listen;
mod logical;
mod memory;
mod module;
mod parameters;
mod pipelines;
mod profile;
mod queue;
mod recorder;
mod spare;
mod specialize;
#[cfg(test)]
mod tests;

pub(crate) use cache::DiskCache;
pub use choose::{Candidate, devices, preferred};
pub use fault::Fault;
pub(crate) use logical::Device;
pub use logical::{Limits, Options, RawDevice};
pub(crate) use memory::Memory;
pub(crate) use module::Module;
#[cfg(test)]
pub(crate) use pipelines::Specialized;
pub(crate) use pipelines::{ComputePipeline, Pipelines};
pub(crate) use profile::Profile;
pub(crate) use recorder::{Groups, READ_BACK, Recorder};
