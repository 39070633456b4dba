//! Vulkan instances: one for all devices of a process, and one for all devices with validation.

use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};
use photon_core::Result;

use super::choose::has;
use super::fault::{Fault, during};
use super::listen::{Listeners, Object};

/// An instance, and the receivers of its validation messages.
pub(crate) struct Instance {
    /// Keeps the loader in memory; dropped after the instance.
    _entry: ash::Entry,
    pub(crate) raw: ash::Instance,
    /// Whether the debug-utils extension for naming objects is enabled.
    pub(crate) names: bool,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// User data of the messenger's callback.
    pub(crate) listeners: Box<Listeners>,
}

/// The instance without layers and the one with the validation layer, each created on first use.
static SHARED: [Mutex<Option<Arc<Instance>>>; 2] = [const { Mutex::new(None) }; 2];

impl Instance {
    /// The process-wide instance, with or without the validation layer. It is never destroyed: the loader
    /// unloads a driver with its last instance, and NVIDIA's driver 580 cannot be loaded again after 30 times
    /// (it leaks static TLS), and leaves a destructor of thread-specific data in unloaded code, which makes
    /// exiting threads crash with a segmentation fault, both with the layer and without: see
    /// `docs/studies/devices.md`.
    pub(crate) fn shared(validation: bool) -> Result<Arc<Self>> {
        let mut shared = SHARED[usize::from(validation)].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(instance) = &*shared {
            return Ok(Arc::clone(instance));
        }
        let instance = Arc::new(Self::open(validation)?);
        *shared = Some(Arc::clone(&instance));
        Ok(instance)
    }

    fn open(validation: bool) -> Result<Self> {
        let entry = load()?;
        // SAFETY: the entry is loaded.
        let layers = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
        if validation && !has(layers.iter().map(|layer| layer.layer_name), VALIDATION) {
            return Err(Fault::NoValidation.into());
        }
        // SAFETY: likewise.
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let names =
            validation || has(extensions.iter().map(|extension| extension.extension_name), ext::debug_utils::NAME);
        let listeners = Box::new(Listeners::default());
        let user = std::ptr::from_ref(&*listeners).cast_mut().cast();
        let listen = || {
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
        let raw = create_instance(&entry, validation, names, validation.then(listen).as_mut())?;
        let mut instance = Self { _entry: entry, raw, names, messenger: None, listeners };
        if validation {
            let functions = ext::debug_utils::Instance::new(&instance._entry, &instance.raw);
            // SAFETY: the listeners outlive the messenger, see `Drop`.
            let handle = unsafe { functions.create_debug_utils_messenger(&listen(), None) };
            instance.messenger = Some((functions, handle.map_err(during("listening to the validation layer"))?));
        }
        Ok(instance)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: everything made from the instance holds a reference to it.
        unsafe {
            if let Some((functions, messenger)) = &self.messenger {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

fn load() -> Result<ash::Entry> {
    // SAFETY: the loader is the system's; what its initialization does is beyond our control.
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

/// Callback of the messenger: forwards messages to the devices they concern.
unsafe extern "system" fn hear(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut std::ffi::c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan passes a valid structure, and `user` points to data that the instance owns until after the
    // messenger is destroyed.
    let (data, listeners) = unsafe { (&*data, &*user.cast::<Listeners>()) };
    // SAFETY: a non-null message is a null-terminated string.
    let text = unsafe { data.message_as_c_str() }.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
    // If there are none, the pointer may be null.
    let labels = match data.cmd_buf_label_count {
        0 => &[],
        // SAFETY: the layer's array has this length.
        count => unsafe { std::slice::from_raw_parts(data.p_cmd_buf_labels, count as usize) },
    };
    let label = |label: &vk::DebugUtilsLabelEXT<'_>| {
        // SAFETY: a non-null name is a null-terminated string.
        unsafe { label.label_name_as_c_str() }.map(|name| format!(" [in {}]", name.to_string_lossy()))
    };
    let text = labels.iter().filter_map(label).fold(text, |text, label| text + &label);
    log::warn!("{severity:?}: {text}");
    let objects = match data.object_count {
        0 => &[],
        // SAFETY: as above.
        count => unsafe { std::slice::from_raw_parts(data.p_objects, count as usize) },
    };
    let objects: Vec<Object> =
        objects.iter().map(|object| (object.object_type.as_raw(), object.object_handle)).collect();
    listeners.hear(&objects, &text);
    vk::FALSE
}
