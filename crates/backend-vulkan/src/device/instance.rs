//! The instance: one for all devices of a process, or one that the validation layer watches.

use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};
use photon_core::Result;

use super::choose::has;
use super::fault::{Fault, during};

/// An instance, and what hears its layers.
pub(crate) struct Instance {
    /// Keeps the loader in memory, and goes after the instance.
    _entry: ash::Entry,
    pub(crate) raw: ash::Instance,
    /// Whether objects can be given names.
    pub(crate) names: bool,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Box<Mutex<Vec<String>>>,
}

/// The one without layers, from the first that asked for it on.
static SHARED: Mutex<Option<Arc<Instance>>> = Mutex::new(None);

impl Instance {
    /// The process's own, without layers. It stays when the last device is gone: NVIDIA's driver 580 gives
    /// a process some sixty instances in all, however few there are at a time, and then says that there is
    /// no driver.
    pub(crate) fn shared() -> Result<Arc<Self>> {
        let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(instance) = &*shared {
            return Ok(Arc::clone(instance));
        }
        let instance = Arc::new(Self::open(false)?);
        *shared = Some(Arc::clone(&instance));
        Ok(instance)
    }

    /// A fresh one with the validation layer, so that nobody hears what others did.
    pub(crate) fn watched() -> Result<Arc<Self>> {
        Self::open(true).map(Arc::new)
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
        let messages = Box::new(Mutex::new(Vec::new()));
        let user = std::ptr::from_ref(&*messages).cast_mut().cast();
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
        let mut instance = Self { _entry: entry, raw, names, messenger: None, messages };
        if validation {
            let functions = ext::debug_utils::Instance::new(&instance._entry, &instance.raw);
            // SAFETY: the list outlives the messenger, see `Drop`.
            let handle = unsafe { functions.create_debug_utils_messenger(&listen(), None) };
            instance.messenger = Some((functions, handle.map_err(during("listening to the validation layer"))?));
        }
        Ok(instance)
    }

    /// What the validation layer has said so far.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: whoever made something from it held on to it for as long.
        unsafe {
            if let Some((functions, messenger)) = &self.messenger {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
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
    // SAFETY: Vulkan passes a valid structure, and `user` is the list that the instance owns until
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
