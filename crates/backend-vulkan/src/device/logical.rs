//! Logical device and queue: our own, or a host's.

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

/// How to open a device.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// A device by its number or a part of its name; `None`: what `PHOTON_VK_DEVICE` says, else the
    /// most capable one.
    pub device: Option<String>,
    /// Whether the validation layer looks on, synchronization included. What it says is in
    /// [`crate::Vulkan::validation_messages`].
    pub validation: bool,
    /// Whether compiled pipelines are kept on disk, in the user's cache folder, for the next start.
    pub disk_cache: bool,
}

/// What a device can do.
#[derive(Clone, Debug)]
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
    /// Nanoseconds per tick of a timestamp; 0 if the queue has none.
    pub timestamp_period: f64,
    /// Turns that all loops of an invocation may make together before the driver ends them in silence;
    /// 0 if it never does.
    pub loop_turns: u32,
    /// Whether 32-bit floats below 2⁻¹²⁶ are kept: every kernel asks for it where the device offers that
    /// (`shaderDenormPreserveFloat32`). Elsewhere the device may take them for 0.
    pub keeps_denormals: bool,
    /// What tells this driver's compiled pipelines from others.
    pub(crate) cache_key: [u8; 16],
}

/// A logical device and what belongs to it; lives until the last buffer is gone.
pub(crate) struct Device {
    pub(crate) raw: ash::Device,
    pub(crate) queue: vk::Queue,
    pub(crate) family: u32,
    pub(crate) limits: Limits,
    /// Names objects and groups of commands, where the extension is on.
    pub(crate) debug: Option<ext::debug_utils::Device>,
    pub(crate) allocator: Mutex<Option<Allocator>>,
    /// Buffers that were dropped, until the device is done with them.
    pub(crate) graveyard: Mutex<Vec<Spare>>,
    /// Those that it is done with.
    pub(crate) spares: Mutex<Spares>,
    /// Faults that tests ask for.
    pub(crate) injection: Injection,
    /// What has been named.
    #[cfg(test)]
    named: Mutex<Vec<(vk::ObjectType, String)>>,
    /// Hears what the validation layer says about it, if that was asked for.
    listener: Option<Listener>,
    /// Whether a message that nobody has asked for ends the test.
    strict: AtomicBool,
    /// What it was made from, which goes after it; `None` for a host's device.
    owned: Option<Arc<Instance>>,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Device").field("name", &self.limits.name).finish_non_exhaustive()
    }
}

/// A device that a host opened: what [`crate::Vulkan::from_raw`] works on.
#[derive(Clone)]
#[expect(missing_debug_implementations, reason = "tables of functions")]
pub struct RawDevice {
    /// The instance, of Vulkan 1.2 at least.
    pub instance: ash::Instance,
    /// The physical device.
    pub physical: vk::PhysicalDevice,
    /// The logical device, with [`RawDevice::features`] enabled.
    pub device: ash::Device,
    /// A queue that computes; not used by anyone else while a call of the backend runs.
    pub queue: vk::Queue,
    /// Its family.
    pub family: u32,
}

impl RawDevice {
    /// What must be enabled on a device: shaderInt64; bufferDeviceAddress, scalarBlockLayout, timelineSemaphore
    /// and hostQueryReset. A host adds what it needs itself.
    pub fn features() -> (vk::PhysicalDeviceFeatures, vk::PhysicalDeviceVulkan12Features<'static>) {
        let twelve = vk::PhysicalDeviceVulkan12Features::default()
            .buffer_device_address(true)
            .scalar_block_layout(true)
            .timeline_semaphore(true)
            .host_query_reset(true);
        (vk::PhysicalDeviceFeatures::default().shader_int64(true), twelve)
    }
}

impl Device {
    /// Opens a device of our own.
    pub(crate) fn open(options: &Options) -> Result<Arc<Self>> {
        let instance = Instance::shared(options.validation)?;
        let listener = options.validation.then(|| Listener::new(&instance));
        let from_environment = std::env::var("PHOTON_VK_DEVICE").ok().filter(|value| !value.is_empty());
        let wanted = options.device.clone().or(from_environment);
        let chosen = choose(candidates(&instance.raw)?, wanted.as_deref())?;
        let priorities = [1.0];
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(chosen.family).queue_priorities(&priorities)];
        let (features, mut twelve) = RawDevice::features();
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_features(&features)
            .push_next(&mut twelve);
        // SAFETY: the features were found to be there, and what is pointed to lives until after it.
        let raw =
            unsafe { instance.raw.create_device(chosen.handle, &info, None) }.map_err(during("opening the device"))?;
        // SAFETY: the queue was asked for above.
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

    /// Works on a host's device.
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

    /// What has been named so far, and of what type it is.
    #[cfg(test)]
    pub(crate) fn named(&self) -> Vec<(vk::ObjectType, String)> {
        self.named.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// What the validation layer has said about this device so far.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.listener.as_ref().map(Listener::messages).unwrap_or_default()
    }

    /// The same, and forgets it.
    pub(crate) fn take_messages(&self) -> Vec<String> {
        self.listener.as_ref().map(Listener::take).unwrap_or_default()
    }

    /// From here on the device panics if it is destroyed with messages that were not taken.
    pub(crate) fn set_strict(&self) {
        self.strict.store(true, Ordering::Relaxed);
    }

    /// Names an object, for debuggers and messages. Each object must have a name: by it the validation layer's
    /// messages find their device.
    pub(crate) fn name<T: vk::Handle + Copy>(&self, handle: T, name: &str) {
        if let Some(listener) = &self.listener {
            listener.own(handle);
        }
        #[cfg(test)]
        self.named.lock().unwrap_or_else(PoisonError::into_inner).push((T::TYPE, name.to_owned()));
        if let Some(debug) = &self.debug {
            let name = std::ffi::CString::new(name.replace('\0', " ")).unwrap_or_default();
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle is alive and the name ends; a name that fails to stick harms nothing.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }

    /// Keeps what was dropped for those who want as much, and frees what nobody wanted for long. Only when
    /// the device has finished everything that was recorded.
    pub(crate) fn bury(&self) {
        let dropped = std::mem::take(&mut *self.graveyard.lock().unwrap_or_else(PoisonError::into_inner));
        let old = self.spares.lock().unwrap_or_else(PoisonError::into_inner).exchange(dropped);
        self.free(old);
    }

    /// Frees what is kept and not in use.
    pub(crate) fn free_spares(&self) {
        let all = self.spares.lock().unwrap_or_else(PoisonError::into_inner).drain();
        self.free(all);
    }

    fn free(&self, spares: Vec<Spare>) {
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        for spare in spares {
            // SAFETY: the device was done with it when it became a spare one.
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
    // SAFETY: the device comes from the instance, and the chain is of structures of Vulkan 1.2.
    unsafe { instance.get_physical_device_properties2(physical, &mut all) };
    let properties = all.properties;
    // SAFETY: likewise.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
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
        timestamp_period: if stamps { f64::from(properties.limits.timestamp_period) } else { 0.0 },
        // Mesa's LP_MAX_TGSI_LOOP_ITERATIONS.
        loop_turns: if driver.driver_id == vk::DriverId::MESA_LLVMPIPE { 65_535 } else { 0 },
        // Without independence the request would have to be made for floats of all sizes.
        keeps_denormals: floats.shader_denorm_preserve_float32 == vk::TRUE
            && floats.denorm_behavior_independence != vk::ShaderFloatControlsIndependence::NONE,
        cache_key: properties.pipeline_cache_uuid,
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the last owner is going; after the wait nothing is in use. Order: what was made
        // from the device, the device; the instance is let go of after it.
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
            // Of what was destroyed, or left over.
            let messages = self.take_messages();
            assert!(messages.is_empty(), "the validation layer said at the end:\n{}", messages.join("\n"));
        }
    }
}
