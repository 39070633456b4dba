//! Compute pipelines: one for each module and set of specialization constants, cached on disk between runs.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use photon_core::Result;

use super::cache::DiskCache;
use super::fault::during;
use super::logical::Device;
use super::module::Module;
use super::specialize::specialize;
use crate::specialization::Constants;

/// A compiled kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ComputePipeline {
    pub(crate) pipeline: vk::Pipeline,
    pub(crate) name: &'static str,
    /// Specialization constant 1.
    pub(crate) workgroup: u32,
}

/// The name of a module, and ids and values of its specialization constants, the workgroup size first.
pub(crate) type Specialized = (&'static str, Vec<(u32, u32)>);

/// All pipelines compiled so far.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Arc<Device>,
    /// No descriptor sets, 128 bytes of push constants: the same for every kernel.
    pub(crate) layout: vk::PipelineLayout,
    cache: vk::PipelineCache,
    disk: Option<DiskCache>,
    #[cfg(test)]
    begun_with: usize,
    compiled: BTreeMap<Specialized, ComputePipeline>,
    fresh: bool,
    /// Seconds spent on compiling since they were last asked for.
    seconds: f64,
}

impl Pipelines {
    /// Starts without pipelines; `disk` provides cached compilation results.
    pub(crate) fn new(device: &Arc<Device>, disk: Option<DiskCache>) -> Result<Self> {
        let range = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(128)];
        let info = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&range);
        // SAFETY: the device is alive.
        let layout = unsafe { device.raw.create_pipeline_layout(&info, None) }.map_err(during("a pipeline layout"))?;
        let old = disk.as_ref().map(DiskCache::read).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&old);
        // SAFETY: as above; the driver validates the header of the data.
        let cache = unsafe { device.raw.create_pipeline_cache(&info, None) }.map_err(during("a pipeline cache"))?;
        device.name(layout, "every kernel's layout");
        device.name(cache, "pipelines");
        Ok(Self {
            device: device.clone(),
            layout,
            cache,
            disk,
            #[cfg(test)]
            begun_with: old.len(),
            compiled: BTreeMap::new(),
            fresh: false,
            seconds: 0.0,
        })
    }

    /// The kernel of a module, compiled if necessary.
    pub(crate) fn kernel<C: Constants>(
        &mut self,
        module: &'static Module,
        workgroup: u32,
        constants: &C,
    ) -> Result<ComputePipeline> {
        let constants = constants.words();
        let listed = C::MODULES.iter().any(|known| known.name == module.name);
        debug_assert!(listed || constants.is_empty(), "constants of other modules than {}", module.name);
        let constants: Vec<_> = [(1, workgroup)].into_iter().chain(constants).collect();
        let key = (module.name, constants.clone());
        if let Some(kernel) = self.compiled.get(&key) {
            return Ok(*kernel);
        }
        let begun = Instant::now();
        let keep = self.device.limits.keeps_denormals;
        let words = if keep { module.words_that_keep_denormals() } else { module.words() };
        let words = specialize(&words, &constants);
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the backend's own SPIR-V, validated when it was committed.
        let shader = unsafe { self.device.raw.create_shader_module(&info, None) }.map_err(during(module.name))?;
        self.device.name(shader, module.name);
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(shader)
            .name(c"main");
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout)];
        // SAFETY: everything the structures point to outlives the call.
        let made = unsafe { self.device.raw.create_compute_pipelines(self.cache, &info, None) };
        // SAFETY: a pipeline does not need its module once it is created.
        unsafe { self.device.raw.destroy_shader_module(shader, None) };
        let pipeline = made.map_err(|(_, result)| during(module.name)(result))?[0];
        self.device.name(pipeline, module.name);
        self.fresh = true;
        let kernel = ComputePipeline { pipeline, name: module.name, workgroup };
        self.compiled.insert(key, kernel);
        self.seconds += begun.elapsed().as_secs_f64();
        Ok(kernel)
    }

    /// Seconds spent on compiling since the last call.
    pub(crate) fn take_seconds(&mut self) -> f64 {
        std::mem::take(&mut self.seconds)
    }

    /// Size of the cache data read from disk.
    #[cfg(test)]
    pub(crate) fn begun_with(&self) -> usize {
        self.begun_with
    }

    /// Compiled pipelines: modules and their constants.
    #[cfg(test)]
    pub(crate) fn compiled(&self) -> impl Iterator<Item = &Specialized> {
        self.compiled.keys()
    }

    fn save(&self) {
        let Some(disk) = &self.disk else { return };
        // SAFETY: the cache is alive.
        if let Ok(data) = unsafe { self.device.raw.get_pipeline_cache_data(self.cache) } {
            disk.write(&data);
        }
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        if self.fresh {
            self.save();
        }
        // SAFETY: the owner has waited for the device.
        unsafe {
            for kernel in self.compiled.values() {
                self.device.raw.destroy_pipeline(kernel.pipeline, None);
            }
            self.device.raw.destroy_pipeline_cache(self.cache, None);
            self.device.raw.destroy_pipeline_layout(self.layout, None);
        }
    }
}
