//! The Vulkan backend: a device and its command recorder.

use std::sync::Arc;

use gpu_allocator::MemoryLocation;
use photon_core::{Error, Result};
use photon_scene::CompressedTree;

use crate::device::{
    ComputePipeline, Device, DiskCache, Fault, Groups, Limits, Memory, Module, Options, Pipelines, Profile, RawDevice,
    Recorder,
};
use crate::dispatch_limits::DispatchLimits;
use crate::parameters::Parameters;
use crate::shaders;
use crate::specialization::Constants;
use crate::stages::TracePlan;

/// Renders on a GPU.
///
/// Calls record commands and return; [`photon_core::Backend::download`], `fill` and `timings` submit them and
/// wait.
#[derive(Debug)]
pub struct Vulkan {
    // Drop order: pending commands finish before pipelines are destroyed; the device is destroyed last.
    pub(crate) recorder: Recorder,
    pub(crate) profile: Profile,
    pipelines: Pipelines,
    pub(crate) device: Arc<Device>,
    pub(crate) memory: Vec<(String, u64)>,
    pub(crate) fault: Option<Error>,
    pub(crate) trace_plan: TracePlan,
    pub(crate) dispatch_limits: DispatchLimits,
    /// A tree for the next scene, and the seconds that it took.
    pub(crate) tree: Option<(CompressedTree, f64)>,
    watched: bool,
}

impl Vulkan {
    /// Opens the most capable device, or the one that the environment variable `PHOTON_VK_DEVICE` selects by
    /// index or by a part of its name.
    ///
    /// # Errors
    /// [`Error::Backend`] if there is no Vulkan loader or no driver; [`Error::NoDevice`] if no device is
    /// suitable, with what each one lacks.
    pub fn new() -> Result<Self> {
        Self::with_options(&Options { disk_cache: true, ..Options::default() })
    }

    /// Opens a device with the given options.
    ///
    /// # Errors
    /// As [`Vulkan::new`], and [`Error::Backend`] if validation is requested but the layer is not installed.
    pub fn with_options(options: &Options) -> Result<Self> {
        Self::over(Device::open(options)?, options.disk_cache)
    }

    /// Uses a device that the host application opened. The host keeps ownership; before it destroys the device
    /// it waits for it to be idle, or drops this backend.
    ///
    /// # Errors
    /// [`Error::Backend`].
    ///
    /// # Safety
    /// The handles are valid, belong together, outlive this backend and every buffer made from it, and the
    /// device was created with the features that [`RawDevice::features`] lists. No other code uses the queue
    /// while a method of this backend runs.
    pub unsafe fn from_raw(raw: RawDevice) -> Result<Self> {
        // SAFETY: as the caller promises.
        Self::over(unsafe { Device::borrow(raw) }?, false)
    }

    fn over(device: Arc<Device>, disk_cache: bool) -> Result<Self> {
        let disk = if disk_cache { DiskCache::of_user(&device.limits, &shaders::KERNELS) } else { None };
        Ok(Self {
            recorder: Recorder::new(&device)?,
            profile: Profile::new(&device)?,
            pipelines: Pipelines::new(&device, disk)?,
            trace_plan: TracePlan::of(&device.limits),
            dispatch_limits: DispatchLimits::of(&device.limits),
            tree: None,
            device,
            memory: Vec::new(),
            fault: None,
            watched: false,
        })
    }

    /// Takes this tree for the next scene that is prepared, if it has as many triangles, instead of building one: a tree can be
    /// built while a device is opened. It must be that of the positions and triangles of the scene, or rays miss surfaces.
    /// `seconds` is how long it took, for [`photon_core::Stage::Bvh`].
    #[must_use]
    pub fn with_tree(mut self, tree: CompressedTree, seconds: f64) -> Self {
        self.tree = Some((tree, seconds));
        self
    }

    /// [`crate::low_level::for_tests`].
    #[must_use]
    #[expect(clippy::panic, reason = "a test that needs Vulkan fails where Vulkan is required")]
    pub(crate) fn for_tests() -> Option<Self> {
        let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
        let validation = wants_validation(std::env::var_os("PHOTON_VALIDATION").as_deref());
        match Self::with_options(&Options { validation, ..Options::default() }) {
            Ok(mut on) => {
                on.watched = validation;
                if validation {
                    on.device.set_strict();
                }
                Some(on)
            }
            Err(error) if required => panic!("Vulkan is required here: {}", chain(&error)),
            Err(error) => {
                eprintln!("skipped: no Vulkan: {}", chain(&error));
                None
            }
        }
    }

    /// Name, driver and limits of the device.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.device.limits
    }

    /// Messages of the validation layer about this device, if validation was enabled. Devices share an
    /// instance: a message belongs to the device whose objects it names, and to every device if it names none.
    #[must_use]
    pub fn validation_messages(&self) -> Vec<String> {
        self.device.messages()
    }

    /// Whether validation is enabled.
    #[cfg(test)]
    pub(crate) fn is_watched(&self) -> bool {
        self.watched
    }

    /// Requested kernels: modules and their specialization constants.
    #[cfg(test)]
    pub(crate) fn requested(&self) -> Vec<crate::device::Specialized> {
        self.pipelines.requested().cloned().collect()
    }

    /// Allocates a device-local buffer with undefined content.
    pub(crate) fn memory(&mut self, label: &str, bytes: u64) -> Result<Memory> {
        Memory::new(&self.device, label, bytes, MemoryLocation::GpuOnly)
    }

    /// The kernel of a module with this workgroup size. It is compiled by other threads, unless it was requested before;
    /// whoever dispatches it waits for that.
    pub(crate) fn kernel(
        &mut self,
        module: &'static Module,
        workgroup: u32,
        constants: &impl Constants,
    ) -> ComputePipeline {
        self.pipelines.kernel(module, workgroup, constants)
    }

    /// Says that all kernels of the next passes are requested.
    pub(crate) fn all_announced(&mut self) {
        self.pipelines.all_announced();
    }

    /// Waits until all kernels that were requested so far are compiled: by default nothing waits for one that is not used.
    ///
    /// # Errors
    /// [`Error::Backend`] if one does not compile.
    pub fn wait_for_kernels(&mut self) -> Result<()> {
        self.pipelines.wait_for_all()
    }

    /// The pipeline of a kernel, for which it waits.
    #[cfg(test)]
    pub(crate) fn pipeline(&mut self, kernel: &ComputePipeline) -> Result<ash::vk::Pipeline> {
        self.pipelines.compiled(kernel)
    }

    /// Kernels that were requested without being announced.
    #[cfg(test)]
    pub(crate) fn late_kernels(&self) -> &[crate::device::Specialized] {
        self.pipelines.late()
    }

    /// Seconds spent on waiting for kernels since the last call.
    pub(crate) fn compile_seconds(&mut self) -> f64 {
        self.pipelines.take_seconds()
    }

    /// Dispatches the given number of workgroups of a kernel, which reads a copy of the parameters.
    pub(crate) fn dispatch<P: Parameters>(
        &mut self,
        kernel: &ComputePipeline,
        parameters: &P,
        workgroups: u64,
    ) -> Result<()> {
        if workgroups == 0 {
            return Ok(());
        }
        if workgroups > 32_768 * 32_768 {
            return Err(
                Fault::Other(format!("{}: {workgroups} workgroups exceed the limit of 2^30", kernel.name)).into()
            );
        }
        self.record(kernel, parameters, Groups::Flat(workgroups))
    }

    /// Indirect dispatch: the three words of `args` at `offset` are the numbers of workgroups.
    pub(crate) fn dispatch_indirect<P: Parameters>(
        &mut self,
        kernel: &ComputePipeline,
        parameters: &P,
        args: &Memory,
        offset: u64,
    ) -> Result<()> {
        check(args, offset, 12);
        self.record(kernel, parameters, Groups::Indirect(args, offset))
    }

    fn record<P: Parameters>(&mut self, kernel: &ComputePipeline, parameters: &P, groups: Groups<'_>) -> Result<()> {
        let listed = P::MODULES.iter().any(|known| known.name == kernel.name);
        debug_assert!(listed, "parameters of other kernels than {}", kernel.name);
        let pipeline = self.pipelines.compiled(kernel)?;
        self.recorder.dispatch(self.pipelines.layout, pipeline, bytemuck::bytes_of(parameters), groups)
    }

    /// Sets every word of a range; offset and length are multiples of 4.
    pub(crate) fn fill_words(&mut self, to: &Memory, offset: u64, bytes: u64, word: u32) -> Result<()> {
        check(to, offset, bytes);
        self.recorder.fill(to, offset, bytes, word)
    }

    /// Copies a range.
    pub(crate) fn copy(
        &mut self,
        from: &Memory,
        from_offset: u64,
        to: &Memory,
        to_offset: u64,
        bytes: u64,
    ) -> Result<()> {
        check(from, from_offset, bytes);
        check(to, to_offset, bytes);
        self.recorder.copy((from, from_offset), (to, to_offset), bytes)
    }

    /// Writes data, in order with all other recorded commands.
    pub(crate) fn write(&mut self, to: &Memory, offset: u64, data: &[u8]) -> Result<()> {
        check(to, offset, data.len() as u64);
        self.recorder.write(to, offset, data)
    }

    /// Reads data back: submits all commands and waits.
    pub(crate) fn read(&mut self, from: &Memory, offset: u64, to: &mut [u8]) -> Result<()> {
        check(from, offset, to.len() as u64);
        self.recorder.read(from, offset, to)
    }

    /// Submits all commands, waits, and calls `take` with the data of these parts, `bytes` of each, one after another.
    pub(crate) fn read_parts(&mut self, parts: &[(&Memory, u64)], bytes: u64, take: impl FnOnce(&[u8])) -> Result<()> {
        parts.iter().for_each(|&(from, offset)| check(from, offset, bytes));
        self.recorder.read_parts(parts, bytes, take)
    }

    /// Records the commands of `f` without barriers between them: they must access disjoint memory.
    pub(crate) fn unordered(&mut self, f: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        self.recorder.set_ordered(false)?;
        let result = f(self);
        self.recorder.set_ordered(true)?;
        result
    }

    /// Submits all commands and waits.
    pub(crate) fn finish(&mut self) -> Result<()> {
        self.recorder.wait()
    }

    /// Records the size of an allocation, for reports.
    pub(crate) fn note_memory(&mut self, label: &str, bytes: u64) {
        match self.memory.iter_mut().find(|(known, _)| known == label) {
            Some((_, known)) => *known = bytes,
            None => self.memory.push((label.to_owned(), bytes)),
        }
    }
}

/// Offsets come from our own code only; a wrong one would overwrite other device memory.
fn check(memory: &Memory, offset: u64, bytes: u64) {
    let end = offset.checked_add(bytes);
    assert!(end.is_some_and(|end| end <= memory.bytes()), "{offset} + {bytes} in a buffer of {}", memory.bytes());
}

/// Whether tests use the validation layer, given the value of `PHOTON_VALIDATION`.
fn wants_validation(value: Option<&std::ffi::OsStr>) -> bool {
    value.is_none_or(|value| value != "0")
}

/// An error and its causes, in one line.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

impl Drop for Vulkan {
    fn drop(&mut self) {
        if let Err(error) = self.finish() {
            log::error!("{error}");
        }
        if self.watched && !std::thread::panicking() {
            let messages = self.device.take_messages();
            assert!(messages.is_empty(), "messages of the validation layer:\n{}", messages.join("\n"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::wants_validation;

    #[test]
    fn only_0_switches_validation_off() {
        assert!(wants_validation(None) && wants_validation(Some("1".as_ref())) && wants_validation(Some("".as_ref())));
        assert!(!wants_validation(Some("0".as_ref())));
    }
}
