//! Instance, logical device and queue: our own, or a host's.

use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use photon_core::Result;

use super::choose::{candidates, choose, has};
use super::fault::{Fault, during};
use super::inject::Injection;
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
    /// What tells this driver's compiled pipelines from others.
    pub(crate) cache_key: [u8; 16],
}

/// A logical device and what belongs to it; lives until the last buffer is gone.
pub(crate) struct Device {
    /// Keeps the loader in memory; `None` for a host's device.
    _entry: Option<ash::Entry>,
    instance: ash::Instance,
    pub(crate) raw: ash::Device,
    pub(crate) queue: vk::Queue,
    pub(crate) family: u32,
    pub(crate) limits: Limits,
    /// Names objects and groups of commands, where the extension is on.
    pub(crate) debug: Option<ext::debug_utils::Device>,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Box<Mutex<Vec<String>>>,
    pub(crate) allocator: Mutex<Option<Allocator>>,
    /// Buffers that were dropped, until the device is done with them.
    pub(crate) graveyard: Mutex<Vec<Spare>>,
    /// Those that it is done with.
    pub(crate) spares: Mutex<Spares>,
    owned: bool,
    /// Faults that tests ask for.
    pub(crate) injection: Injection,
    /// What has been named.
    #[cfg(test)]
    named: Mutex<Vec<(vk::ObjectType, String)>>,
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
    /// The logical device, with shaderInt64, bufferDeviceAddress, scalarBlockLayout, timelineSemaphore and
    /// hostQueryReset enabled.
    pub device: ash::Device,
    /// A queue that computes; not used by anyone else while a call of the backend runs.
    pub queue: vk::Queue,
    /// Its family.
    pub family: u32,
}

/// An instance without layers, to look round.
pub(crate) fn bare_instance() -> Result<(ash::Entry, ash::Instance)> {
    let entry = load()?;
    let instance = create_instance(&entry, false, false, None)?;
    Ok((entry, instance))
}

fn load() -> Result<ash::Entry> {
    // SAFETY: the loader is the system's; what it does when it is loaded is in its own hands.
    unsafe { ash::Entry::load() }.map_err(|error| Fault::NoLoader(error.to_string()).into())
}

const VALIDATION: &std::ffi::CStr = c"VK_LAYER_KHRONOS_validation";

fn create_instance(
    entry: &ash::Entry,
    validation: bool,
    debug: bool,
    messenger: Option<&mut vk::DebugUtilsMessengerCreateInfoEXT<'_>>,
) -> Result<ash::Instance> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"photon mapping")
        .engine_name(c"backend-vulkan")
        .api_version(vk::API_VERSION_1_2);
    let layers = if validation { vec![VALIDATION.as_ptr()] } else { Vec::new() };
    let extensions = if debug { vec![ext::debug_utils::NAME.as_ptr()] } else { Vec::new() };
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions);
    if validation {
        info = info.push_next(&mut features);
    }
    if let Some(messenger) = messenger {
        info = info.push_next(messenger);
    }
    // SAFETY: all that the structure points to lives until after the call.
    unsafe { entry.create_instance(&info, None) }.map_err(|result| {
        let message = result.to_string();
        match result {
            vk::Result::ERROR_INCOMPATIBLE_DRIVER | vk::Result::ERROR_INITIALIZATION_FAILED => {
                Fault::NoDriver(message).into()
            }
            result => Fault::Call { what: "opening Vulkan", result }.into(),
        }
    })
}

/// Collects what the layers say.
unsafe extern "system" fn hear(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut std::ffi::c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan passes a valid structure, and `user` is the list that the device owns until
    // after the messenger is destroyed.
    let (data, messages) = unsafe { (&*data, &*user.cast::<Mutex<Vec<String>>>()) };
    // SAFETY: a message that is there is a string that ends.
    let text = unsafe { data.message_as_c_str() }.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
    // None may be no pointer at all.
    let labels = match data.cmd_buf_label_count {
        0 => &[],
        // SAFETY: the layer's array of so many.
        count => unsafe { std::slice::from_raw_parts(data.p_cmd_buf_labels, count as usize) },
    };
    let label = |label: &vk::DebugUtilsLabelEXT<'_>| {
        // SAFETY: a name that is there is a string that ends.
        unsafe { label.label_name_as_c_str() }.map(|name| format!(" [in {}]", name.to_string_lossy()))
    };
    let text = labels.iter().filter_map(label).fold(text, |text, label| text + &label);
    log::warn!("{severity:?}: {text}");
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    vk::FALSE
}

impl Device {
    /// Opens a device of our own.
    pub(crate) fn open(options: &Options) -> Result<Arc<Self>> {
        let entry = load()?;
        // SAFETY: the entry is loaded.
        let layers = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
        if options.validation && !has(layers.iter().map(|layer| layer.layer_name), VALIDATION) {
            return Err(Fault::NoValidation.into());
        }
        // SAFETY: likewise.
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let debug = options.validation
            || has(extensions.iter().map(|extension| extension.extension_name), ext::debug_utils::NAME);
        let messages = Box::new(Mutex::new(Vec::new()));
        let user = std::ptr::from_ref(&*messages).cast_mut().cast();
        let messenger = || {
            vk::DebugUtilsMessengerCreateInfoEXT::default()
                .message_severity(
                    vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
                )
                .message_type(
                    vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
                )
                .pfn_user_callback(Some(hear))
                .user_data(user)
        };
        let instance = create_instance(&entry, options.validation, debug, options.validation.then(messenger).as_mut())?;
        let messenger = if options.validation {
            let functions = ext::debug_utils::Instance::new(&entry, &instance);
            // SAFETY: the list outlives the messenger, see `Drop`.
            let handle = unsafe { functions.create_debug_utils_messenger(&messenger(), None) };
            Some((functions, handle.map_err(during("listening to the validation layer"))?))
        } else {
            None
        };
        let from_environment = std::env::var("PHOTON_VK_DEVICE").ok().filter(|value| !value.is_empty());
        let wanted = options.device.clone().or(from_environment);
        let chosen = match candidates(&instance).and_then(|found| choose(found, wanted.as_deref())) {
            Ok(chosen) => chosen,
            Err(error) => {
                // SAFETY: nothing but the messenger was made from the instance.
                unsafe {
                    if let Some((functions, handle)) = &messenger {
                        functions.destroy_debug_utils_messenger(*handle, None);
                    }
                    instance.destroy_instance(None);
                }
                return Err(error);
            }
        };
        let priorities = [1.0];
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(chosen.family).queue_priorities(&priorities)];
        let mut twelve = vk::PhysicalDeviceVulkan12Features::default()
            .buffer_device_address(true)
            .scalar_block_layout(true)
            .timeline_semaphore(true)
            .host_query_reset(true);
        let features = vk::PhysicalDeviceFeatures::default().shader_int64(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_features(&features)
            .push_next(&mut twelve);
        // SAFETY: the features were found to be there, and what is pointed to lives until after it.
        let raw =
            unsafe { instance.create_device(chosen.handle, &info, None) }.map_err(during("opening the device"))?;
        // SAFETY: the queue was asked for above.
        let queue = unsafe { raw.get_device_queue(chosen.family, 0) };
        let parts = RawDevice { instance, physical: chosen.handle, device: raw, queue, family: chosen.family };
        Self::assemble(Some(entry), parts, debug, messenger, messages, true)
    }

    /// Works on a host's device.
    ///
    /// # Safety
    /// As [`crate::Vulkan::from_raw`].
    pub(crate) unsafe fn borrow(raw: RawDevice) -> Result<Arc<Self>> {
        Self::assemble(None, raw, false, None, Box::default(), false)
    }

    fn assemble(
        entry: Option<ash::Entry>,
        parts: RawDevice,
        debug: bool,
        messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
        messages: Box<Mutex<Vec<String>>>,
        owned: bool,
    ) -> Result<Arc<Self>> {
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
        let debug = debug.then(|| ext::debug_utils::Device::new(&instance, &raw));
        let device = Self {
            _entry: entry,
            instance,
            raw,
            queue,
            family,
            limits,
            debug,
            messenger,
            messages,
            allocator: Mutex::new(Some(allocator)),
            graveyard: Mutex::default(),
            spares: Mutex::default(),
            owned,
            injection: Injection::default(),
            #[cfg(test)]
            named: Mutex::default(),
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

    /// What the validation layer has said so far.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Names an object, for debuggers and messages.
    pub(crate) fn name<T: vk::Handle>(&self, handle: T, name: &str) {
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
    let mut all =
        vk::PhysicalDeviceProperties2::default().push_next(&mut subgroup).push_next(&mut three).push_next(&mut driver);
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
        cache_key: properties.pipeline_cache_uuid,
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the last owner is going; after the wait nothing is in use. Order: what was made
        // from the device, the device, what was made from the instance, the instance.
        unsafe {
            // A lost device has nothing left to wait for.
            let _ = self.raw.device_wait_idle();
        }
        self.bury();
        self.free_spares();
        drop(self.allocator.lock().unwrap_or_else(PoisonError::into_inner).take());
        if self.owned {
            // SAFETY: as above.
            unsafe {
                self.raw.destroy_device(None);
                if let Some((functions, messenger)) = &self.messenger {
                    functions.destroy_debug_utils_messenger(*messenger, None);
                }
                self.instance.destroy_instance(None);
            }
        }
    }
}
