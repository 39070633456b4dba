//! The logical device and its queue: opened by the backend, or supplied by a host.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use photon_core::Result;

use super::choose::{candidates, choose};
use super::fault::{Fault, during};
use super::inject::Injection;
use super::instance::Instance;
use super::listen::Listener;
use super::spare::{Spare, Spares};

/// Options for opening a device.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Options {
    /// Selects a device by index or by a part of its name; `None`: by the environment variable
    /// `PHOTON_VK_DEVICE`, otherwise the most capable one.
    pub device: Option<String>,
    /// Whether to enable the validation layer, including synchronization validation. Its messages are returned
    /// by [`crate::Vulkan::validation_messages`].
    pub validation: bool,
    /// Whether to keep compiled pipelines on disk, in the user's cache folder, for later runs.
    pub disk_cache: bool,
}

/// Properties and limits of a device.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Limits {
    /// Name of the device.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// Invocations per subgroup.
    pub subgroup_size: u32,
    /// Largest workgroup.
    pub max_workgroup: u32,
    /// Bytes of shared memory per workgroup.
    pub shared_memory: u32,
    /// Largest single allocation, bytes.
    pub max_allocation: u64,
    /// Largest memory of the device's own, bytes.
    pub device_memory: u64,
    /// Nanoseconds per tick of a timestamp; 0 if the queue has none.
    pub timestamp_period: f64,
    /// Maximum number of iterations of all loops of an invocation together before the driver silently ends
    /// them; 0 if unlimited.
    pub loop_turns: u32,
    /// Whether 32-bit floats below 2⁻¹²⁶ are preserved: every kernel requests that if the device supports it
    /// (`shaderDenormPreserveFloat32`). Otherwise the device may flush them to 0.
    pub keeps_denormals: bool,
    /// Identifies this driver's compiled pipelines.
    pub(crate) cache_key: [u8; 16],
}

impl Limits {
    /// Whether it is a software driver, whose subgroups are narrower than those of GPUs.
    pub(crate) fn is_software(&self) -> bool {
        self.subgroup_size < 16
    }
}

/// A logical device and everything that belongs to it; lives until the last buffer is dropped.
pub(crate) struct Device {
    pub(crate) raw: ash::Device,
    pub(crate) queue: vk::Queue,
    pub(crate) family: u32,
    pub(crate) limits: Limits,
    /// For naming objects and groups of commands, if the extension is enabled.
    pub(crate) debug: Option<ext::debug_utils::Device>,
    pub(crate) allocator: Mutex<Option<Allocator>>,
    /// Dropped buffers that the device may still use.
    pub(crate) graveyard: Mutex<Vec<Spare>>,
    /// Dropped buffers that the device no longer uses.
    pub(crate) spares: Mutex<Spares>,
    /// Injected faults, for tests.
    pub(crate) injection: Injection,
    /// Objects that have been named.
    #[cfg(test)]
    named: Mutex<Vec<(vk::ObjectType, String)>>,
    /// Receives validation messages about this device, if validation is enabled.
    listener: Option<Listener>,
    /// Whether messages that have not been taken make the test panic.
    strict: AtomicBool,
    /// The instance it was created from, dropped after it; `None` for a host's device.
    owned: Option<Arc<Instance>>,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Device").field("name", &self.limits.name).finish_non_exhaustive()
    }
}

/// A device that a host opened, for [`crate::Vulkan::from_raw`].
// Exhaustive: the host must state every handle.
#[derive(Clone)]
#[expect(missing_debug_implementations, reason = "tables of functions")]
pub struct RawDevice {
    /// The instance, of Vulkan 1.2 at least.
    pub instance: ash::Instance,
    /// The physical device.
    pub physical: vk::PhysicalDevice,
    /// The logical device, with [`RawDevice::features`] enabled.
    pub device: ash::Device,
    /// A compute queue; no other code uses it while a call of the backend runs.
    pub queue: vk::Queue,
    /// The queue family index of the queue.
    pub family: u32,
}

impl RawDevice {
    /// Features that must be enabled on the device: shaderInt64; bufferDeviceAddress, scalarBlockLayout,
    /// timelineSemaphore and hostQueryReset. A host adds the features that it needs itself.
    pub fn features() -> (vk::PhysicalDeviceFeatures, vk::PhysicalDeviceVulkan12Features<'static>) {
        let twelve = vk::PhysicalDeviceVulkan12Features::default()
            .buffer_device_address(true)
            .scalar_block_layout(true)
            .timeline_semaphore(true)
            .host_query_reset(true);
        (vk::PhysicalDeviceFeatures::default().shader_int64(true), twelve)
    }
}

/// The device that the environment variable `PHOTON_VK_DEVICE` selects.
pub(super) fn from_environment() -> Option<String> {
    std::env::var("PHOTON_VK_DEVICE").ok().filter(|value| !value.is_empty())
}

impl Device {
    /// Opens a device.
    pub(crate) fn open(options: &Options) -> Result<Arc<Self>> {
        let instance = Instance::shared(options.validation)?;
        let listener = options.validation.then(|| Listener::new(&instance));
        let wanted = options.device.clone().or_else(from_environment);
        let chosen = choose(candidates(&instance.raw)?, wanted.as_deref())?;
        let priorities = [1.0];
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(chosen.family).queue_priorities(&priorities)];
        let (features, mut twelve) = RawDevice::features();
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_features(&features)
            .push_next(&mut twelve);
        // SAFETY: the features are supported, and everything pointed to outlives the call.
        let raw =
            unsafe { instance.raw.create_device(chosen.handle, &info, None) }.map_err(during("opening the device"))?;
        // SAFETY: the queue was requested above.
        let queue = unsafe { raw.get_device_queue(chosen.family, 0) };
        let parts = RawDevice {
            instance: instance.raw.clone(),
            physical: chosen.handle,
            device: raw,
            queue,
            family: chosen.family,
        };
        Self::assemble(parts, Some(instance), listener)
    }

    /// Wraps a host's device.
    ///
    /// # Safety
    /// As [`crate::Vulkan::from_raw`].
    pub(crate) unsafe fn borrow(raw: RawDevice) -> Result<Arc<Self>> {
        Self::assemble(raw, None, None)
    }

    fn assemble(parts: RawDevice, owned: Option<Arc<Instance>>, listener: Option<Listener>) -> Result<Arc<Self>> {
        let RawDevice { instance, physical, device: raw, queue, family } = parts;
        let limits = limits(&instance, physical, family);
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: raw.clone(),
            physical_device: physical,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: true,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })
        .map_err(|error| Fault::Other(format!("starting the allocator: {error}")))?;
        let names = owned.as_ref().is_some_and(|instance| instance.names);
        let debug = names.then(|| ext::debug_utils::Device::new(&instance, &raw));
        let device = Self {
            raw,
            queue,
            family,
            limits,
            debug,
            allocator: Mutex::new(Some(allocator)),
            graveyard: Mutex::default(),
            spares: Mutex::default(),
            injection: Injection::default(),
            #[cfg(test)]
            named: Mutex::default(),
            listener,
            strict: AtomicBool::new(false),
            owned,
        };
        device.name(device.raw.handle(), "photon mapping");
        device.name(device.queue, "photon mapping");
        Ok(Arc::new(device))
    }

    /// Names and types of the objects named so far.
    #[cfg(test)]
    pub(crate) fn named(&self) -> Vec<(vk::ObjectType, String)> {
        self.named.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Validation messages about this device so far.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.listener.as_ref().map(Listener::messages).unwrap_or_default()
    }

    /// Returns and clears the validation messages about this device.
    pub(crate) fn take_messages(&self) -> Vec<String> {
        self.listener.as_ref().map(Listener::take).unwrap_or_default()
    }

    /// From now on, dropping the device panics if there are messages that were not taken.
    pub(crate) fn set_strict(&self) {
        self.strict.store(true, Ordering::Relaxed);
    }

    /// Names an object, for debuggers and validation messages. Every object must be named: the naming also
    /// registers the object for routing validation messages to this device.
    pub(crate) fn name<T: vk::Handle + Copy>(&self, handle: T, name: &str) {
        if let Some(listener) = &self.listener {
            listener.own(handle);
        }
        #[cfg(test)]
        self.named.lock().unwrap_or_else(PoisonError::into_inner).push((T::TYPE, name.to_owned()));
        if let Some(debug) = &self.debug {
            let name = std::ffi::CString::new(name.replace('\0', " ")).unwrap_or_default();
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle is alive and the name is null-terminated; a failure to set the name is
            // harmless.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }

    /// Moves dropped buffers to the spare list for reuse, and frees those that have been unused for long. To be
    /// called only when the device has finished all recorded commands.
    pub(crate) fn bury(&self) {
        let dropped = std::mem::take(&mut *self.graveyard.lock().unwrap_or_else(PoisonError::into_inner));
        let old = self.spares.lock().unwrap_or_else(PoisonError::into_inner).exchange(dropped);
        self.free(old);
    }

    /// Frees all spare buffers.
    pub(crate) fn free_spares(&self) {
        let all = self.spares.lock().unwrap_or_else(PoisonError::into_inner).drain();
        self.free(all);
    }

    fn free(&self, spares: Vec<Spare>) {
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        for spare in spares {
            // SAFETY: spare buffers are no longer used by the device.
            unsafe { self.raw.destroy_buffer(spare.buffer, None) };
            if let Some(Err(error)) = allocator.as_mut().map(|allocator| allocator.free(spare.allocation)) {
                log::error!("freeing memory: {error}");
            }
        }
    }
}

fn limits(instance: &ash::Instance, physical: vk::PhysicalDevice, family: u32) -> Limits {
    let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
    let mut three = vk::PhysicalDeviceMaintenance3Properties::default();
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut floats = vk::PhysicalDeviceFloatControlsProperties::default();
    let mut all = vk::PhysicalDeviceProperties2::default()
        .push_next(&mut subgroup)
        .push_next(&mut three)
        .push_next(&mut driver)
        .push_next(&mut floats);
    // SAFETY: the device comes from the instance, and the chain consists of Vulkan 1.2 structures.
    unsafe { instance.get_physical_device_properties2(physical, &mut all) };
    let properties = all.properties;
    // SAFETY: likewise.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    // SAFETY: likewise.
    let memory = unsafe { instance.get_physical_device_memory_properties(physical) };
    let own = |heap: &&vk::MemoryHeap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL);
    let device_memory = memory.memory_heaps_as_slice().iter().filter(own).map(|heap| heap.size).max().unwrap_or(0);
    let stamps = families.get(family as usize).is_some_and(|family| family.timestamp_valid_bits > 0);
    let text = |name: Result<&std::ffi::CStr, std::ffi::FromBytesUntilNulError>| {
        name.map_or_else(|_| String::new(), |name| name.to_string_lossy().into_owned())
    };
    Limits {
        name: text(properties.device_name_as_c_str()),
        driver: format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str())),
        subgroup_size: subgroup.subgroup_size,
        max_workgroup: properties.limits.max_compute_work_group_invocations,
        shared_memory: properties.limits.max_compute_shared_memory_size,
        max_allocation: three.max_memory_allocation_size,
        device_memory,
        timestamp_period: if stamps { f64::from(properties.limits.timestamp_period) } else { 0.0 },
        // Mesa's LP_MAX_TGSI_LOOP_ITERATIONS.
        loop_turns: if driver.driver_id == vk::DriverId::MESA_LLVMPIPE { 65_535 } else { 0 },
        // Without independence, denormals of all float sizes would have to be preserved.
        keeps_denormals: floats.shader_denorm_preserve_float32 == vk::TRUE
            && floats.denorm_behavior_independence != vk::ShaderFloatControlsIndependence::NONE,
        cache_key: properties.pipeline_cache_uuid,
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the last owner is being dropped; after the wait nothing is in use. Objects made from the device are
        // destroyed first, then the device; the reference to the instance is dropped after it.
        unsafe {
            // A lost device has nothing left to wait for.
            let _ = self.raw.device_wait_idle();
        }
        self.bury();
        self.free_spares();
        drop(self.allocator.lock().unwrap_or_else(PoisonError::into_inner).take());
        if self.owned.is_some() {
            // SAFETY: as above.
            unsafe { self.raw.destroy_device(None) };
        }
        if self.strict.load(Ordering::Relaxed) && !std::thread::panicking() {
            // Messages about destroyed or leaked objects.
            let messages = self.take_messages();
            assert!(messages.is_empty(), "messages of the validation layer at the end:\n{}", messages.join("\n"));
        }
    }
}
