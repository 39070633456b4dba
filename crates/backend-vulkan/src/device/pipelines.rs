//! Compute pipelines: one for each module and set of specialization constants, cached on disk between runs.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use photon_core::Result;

use super::cache::DiskCache;
use super::compiler::{Compiler, Job};
use super::fault::during;
use super::logical::Device;
use super::module::Module;
use crate::parameters::MAX_PUSHED;
use crate::specialization::Constants;

/// A kernel, which may still be compiling.
#[derive(Clone, Debug)]
pub(crate) struct ComputePipeline {
    job: Arc<Job>,
    pub(crate) name: &'static str,
    /// Specialization constant 1.
    pub(crate) workgroup: u32,
}

/// The name of a module, and ids and values of its specialization constants, the workgroup size first.
pub(crate) type Specialized = (&'static str, Vec<(u32, u32)>);

/// All pipelines requested so far.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Arc<Device>,
    /// No descriptor sets, [`MAX_PUSHED`] bytes of push constants: the same for every kernel.
    pub(crate) layout: vk::PipelineLayout,
    cache: vk::PipelineCache,
    compiler: Compiler,
    #[cfg(test)]
    begun_with: usize,
    requested: BTreeMap<Specialized, ComputePipeline>,
    /// Kernels requested since [`Pipelines::all_announced`].
    #[cfg(test)]
    late: Option<Vec<Specialized>>,
    /// Seconds spent on waiting for kernels since they were last asked for.
    seconds: f64,
}

impl Pipelines {
    /// Starts without pipelines; `disk` provides cached compilation results.
    pub(crate) fn new(device: &Arc<Device>, disk: Option<DiskCache>) -> Result<Self> {
        let range =
            [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(MAX_PUSHED as u32)];
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
            compiler: Compiler::new(device, layout, cache, disk),
            #[cfg(test)]
            begun_with: old.len(),
            requested: BTreeMap::new(),
            #[cfg(test)]
            late: None,
            seconds: 0.0,
        })
    }

    /// The kernel of a module. Begins to compile it unless it was requested before, and does not wait.
    pub(crate) fn kernel<C: Constants>(
        &mut self,
        module: &'static Module,
        workgroup: u32,
        constants: &C,
    ) -> ComputePipeline {
        let constants = constants.words();
        let listed = C::MODULES.iter().any(|known| known.name == module.name);
        debug_assert!(listed || constants.is_empty(), "constants of other modules than {}", module.name);
        let constants: Vec<_> = [(1, workgroup)].into_iter().chain(constants).collect();
        let key = (module.name, constants);
        if let Some(kernel) = self.requested.get(&key) {
            return kernel.clone();
        }
        #[cfg(test)]
        if let Some(late) = &mut self.late {
            late.push(key.clone());
        }
        let job = self.compiler.add(module, key.1.clone());
        let kernel = ComputePipeline { job, name: module.name, workgroup };
        self.requested.insert(key, kernel.clone());
        kernel
    }

    /// The pipeline of a kernel, for which it waits.
    pub(crate) fn compiled(&mut self, kernel: &ComputePipeline) -> Result<vk::Pipeline> {
        let made = kernel.job.made().unwrap_or_else(|| {
            let begun = Instant::now();
            let made = self.compiler.wait(&kernel.job);
            self.seconds += begun.elapsed().as_secs_f64();
            made
        });
        made.map_err(during(kernel.name))
    }

    /// Waits for all requested kernels.
    pub(crate) fn wait_for_all(&mut self) -> Result<()> {
        let all: Vec<_> = self.requested.values().cloned().collect();
        all.iter().try_for_each(|kernel| self.compiled(kernel).map(drop))
    }

    /// Says that all kernels of the next passes are requested: the cache file is written once they are compiled.
    pub(crate) fn all_announced(&mut self) {
        self.compiler.save_when_done();
        #[cfg(test)]
        self.late.get_or_insert_default().clear();
    }

    /// Kernels that were requested without being announced.
    #[cfg(test)]
    pub(crate) fn late(&self) -> &[Specialized] {
        self.late.as_deref().unwrap_or_default()
    }

    /// Seconds spent on waiting for kernels since the last call.
    pub(crate) fn take_seconds(&mut self) -> f64 {
        std::mem::take(&mut self.seconds)
    }

    /// Size of the cache data read from disk.
    #[cfg(test)]
    pub(crate) fn begun_with(&self) -> usize {
        self.begun_with
    }

    /// Requested pipelines: modules and their constants.
    #[cfg(test)]
    pub(crate) fn requested(&self) -> impl Iterator<Item = &Specialized> {
        self.requested.keys()
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        self.compiler.finish();
        // SAFETY: the owner has waited for the device.
        unsafe {
            for pipeline in self.requested.values().filter_map(|kernel| kernel.job.made()?.ok()) {
                self.device.raw.destroy_pipeline(pipeline, None);
            }
            self.device.raw.destroy_pipeline_cache(self.cache, None);
            self.device.raw.destroy_pipeline_layout(self.layout, None);
        }
    }
}
