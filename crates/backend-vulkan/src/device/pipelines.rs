//! Pipelines: one for each module and set of constants, kept on disk from one start to the next.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use ash::vk;
use photon_core::Result;

use super::fault::during;
use super::instance::Device;
use super::module::Module;

/// A compiled kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernel {
    pub(crate) pipeline: vk::Pipeline,
    pub(crate) name: &'static str,
    /// Specialization constant 1.
    pub(crate) workgroup: u32,
}

/// All compiled so far.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Arc<Device>,
    /// No descriptor sets, 128 bytes of push constants: the same for every kernel.
    pub(crate) layout: vk::PipelineLayout,
    cache: vk::PipelineCache,
    file: Option<PathBuf>,
    compiled: BTreeMap<(&'static str, Vec<u32>), Kernel>,
    fresh: bool,
}

impl Pipelines {
    /// None yet.
    pub(crate) fn new(device: &Arc<Device>, disk_cache: bool) -> Result<Self> {
        let range = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(128)];
        let info = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&range);
        // SAFETY: the device is alive.
        let layout = unsafe { device.raw.create_pipeline_layout(&info, None) }.map_err(during("a pipeline layout"))?;
        let file = if disk_cache { cache_file(&device.limits.cache_key) } else { None };
        let old = file.as_ref().and_then(|file| std::fs::read(file).ok()).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&old);
        // SAFETY: as above; the driver checks the header of what it is given.
        let cache = unsafe { device.raw.create_pipeline_cache(&info, None) }.map_err(during("a pipeline cache"))?;
        Ok(Self { device: device.clone(), layout, cache, file, compiled: BTreeMap::new(), fresh: false })
    }

    /// The kernel of a module; `constants[i]` is specialization constant i.
    pub(crate) fn kernel(&mut self, module: &'static Module, constants: &[u32]) -> Result<Kernel> {
        let key = (module.name, constants.to_vec());
        if let Some(kernel) = self.compiled.get(&key) {
            return Ok(*kernel);
        }
        let words = module.words();
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: our own SPIR-V, validated when it was committed.
        let shader = unsafe { self.device.raw.create_shader_module(&info, None) }.map_err(during(module.name))?;
        let entries: Vec<_> = (0..constants.len() as u32)
            .map(|id| vk::SpecializationMapEntry { constant_id: id, offset: 4 * id, size: 4 })
            .collect();
        let special = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(constants));
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(shader)
            .name(c"main")
            .specialization_info(&special);
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout)];
        // SAFETY: all that the structures point to lives until after the call.
        let made = unsafe { self.device.raw.create_compute_pipelines(self.cache, &info, None) };
        // SAFETY: a pipeline does not need its module once it is made.
        unsafe { self.device.raw.destroy_shader_module(shader, None) };
        let pipeline = made.map_err(|(_, result)| during(module.name)(result))?[0];
        self.device.name(pipeline, module.name);
        self.fresh = true;
        let kernel = Kernel { pipeline, name: module.name, workgroup: constants.get(1).copied().unwrap_or(1) };
        self.compiled.insert(key, kernel);
        Ok(kernel)
    }

    /// Writes the cache, beside and then over the old one. A cache that cannot be kept harms nothing.
    fn save(&self) -> Option<()> {
        let file = self.file.as_ref()?;
        // SAFETY: the cache is alive.
        let data = unsafe { self.device.raw.get_pipeline_cache_data(self.cache) }.ok()?;
        std::fs::create_dir_all(file.parent()?).ok()?;
        let beside = file.with_extension(format!("{}.new", std::process::id()));
        std::fs::write(&beside, data).ok()?;
        std::fs::rename(&beside, file).ok()
    }
}

/// Named by the driver's key for its compiled code, and by a hash (Fowler, Noll and Vo's, 64 bits)
/// of all SPIR-V.
fn cache_file(key: &[u8; 16]) -> Option<PathBuf> {
    let folder = std::env::var_os("XDG_CACHE_HOME")
        .or_else(|| std::env::var_os("LOCALAPPDATA"))
        .map(PathBuf::from)
        .or_else(|| std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".cache")))?;
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in crate::shaders::ALL.iter().flat_map(|module| module.bytes) {
        hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
    let key: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    Some(folder.join("photon-mapping").join(format!("{key}-{hash:016x}.pipelines")))
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
