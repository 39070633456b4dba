//! Devices by name.

use std::ffi::c_char;

use photonmap::cpu::Cpu;
use photonmap::vulkan::{Options, Vulkan, gpu};

use crate::caster::Caster;
use crate::error::{Fault, PmStatus, Result, length};
use crate::options::PmDevice;
use crate::pointer;

pub(crate) enum Device {
    Cpu(Cpu),
    Vulkan(Box<Vulkan>),
}

/// Opens a device.
///
/// # Safety
/// `device` is NULL or points to a valid struct, whose caster can be called as long as the result exists.
pub(crate) unsafe fn open(device: *const PmDevice) -> Result<Device> {
    if device.is_null() {
        return Ok(Device::Cpu(Cpu::new()?));
    }
    // SAFETY: as the caller ensures.
    let (device, backend) = unsafe {
        let device = pointer::read(device)?;
        (device, pointer::text_or_null(device.backend, "backend")?)
    };
    let name = backend.unwrap_or("cpu");
    if let Some(gpu) = gpu(name, !device.caster.is_null())? {
        return Ok(Device::Vulkan(Box::new(gpu)));
    }
    let cpu = if device.threads == 0 { Cpu::new()? } else { Cpu::with_threads(device.threads as usize)? };
    if device.caster.is_null() {
        return Ok(Device::Cpu(cpu));
    }
    // SAFETY: as the caller ensures.
    let caster = unsafe { Caster::new(device.caster) }?;
    Ok(Device::Cpu(cpu.with_caster(move |scene| Ok(Box::new(caster.prepared(scene)?)))))
}

/// The GPU of a name; `None` for the CPU, on which alone the caller's ray caster works.
fn gpu(name: &str, has_caster: bool) -> Result<Option<Vulkan>> {
    let missing = |why: String| {
        let text =
            format!("no GPU can be used: {why}; install a Vulkan driver, or use the backend \"cpu\" or \"auto\"");
        Fault::new(PmStatus::NoDevice, text)
    };
    let named = |device: Option<&str>| {
        let mut options = Options::default();
        options.disk_cache = true;
        options.device = device.map(str::to_owned);
        Vulkan::with_options(&options).map(Some).map_err(|error| Fault::from(error).with_status(PmStatus::NoDevice))
    };
    match (name, name.strip_prefix("gpu:")) {
        ("cpu", _) => Ok(None),
        ("auto", _) if has_caster || gpu::prefers_gpu().is_err() => Ok(None),
        ("gpu" | "vulkan", _) | (_, Some(_)) if has_caster => {
            Err(Fault::argument("a ray caster of the caller works with the backend \"cpu\" alone"))
        }
        ("auto" | "gpu", _) => gpu::requested_gpu().map(Some).map_err(missing),
        ("vulkan", _) => named(None),
        (_, Some(device)) if !device.is_empty() => named(Some(device)),
        _ => Err(Fault::argument(format!(
            "backend is {name:?}, but there are \"auto\", \"cpu\", \"gpu\", \"vulkan\", and devices of pm_devices() by index or \
             name, such as \"gpu:1\""
        ))),
    }
}

/// Copies the list of the Vulkan devices, one to a line: as pm_last_error(). A line has the index, name and kind of a device,
/// its Vulkan version, and whether it is suitable or what it lacks. After "gpu:", the index or a part of the name is a
/// PmDevice.backend. Returns 0 if there is no driver.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_devices(text: *mut c_char, room: usize) -> usize {
    length(|| {
        let missing = |why: String| Fault::new(PmStatus::NoDevice, why);
        let lines = gpu::list().map_err(missing)?.join("\n");
        // SAFETY: the caller's buffer of `room` bytes.
        Ok(unsafe { pointer::copy_text(&lines, text, room) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(name: &str, has_caster: bool) -> Fault {
        gpu(name, has_caster).err().unwrap_or_else(|| panic!("{name} is accepted"))
    }

    #[test]
    fn devices_have_the_names_of_the_list() {
        assert!(gpu("cpu", false).is_ok_and(|gpu| gpu.is_none()));
        // A caster works on the CPU alone, which "auto" may choose.
        assert!(gpu("auto", true).is_ok_and(|gpu| gpu.is_none()));
        for (name, has_caster, part) in
            [("abacus", false, "gpu:1"), ("gpu:", false, "gpu:1"), ("gpu", true, "caster"), ("gpu:0", true, "caster")]
        {
            let fault = refused(name, has_caster);
            assert!(
                fault.status() == PmStatus::InvalidArgument && fault.text().contains(part),
                "{name}: {}",
                fault.text()
            );
        }
        assert_eq!(refused("gpu:no such device", false).status(), PmStatus::NoDevice);

        let mut text = [0; 4096];
        // SAFETY: a buffer of 4096 bytes.
        let length = unsafe { pm_devices(text.as_mut_ptr(), text.len()) };
        assert_eq!(length, gpu::list().map_or(0, |lines| lines.join("\n").len()));
        let Ok(lines) = gpu::list() else { return };
        let bytes = text[..length].iter().map(|&byte| byte as u8).collect();
        assert_eq!(String::from_utf8(bytes).ok(), Some(lines.join("\n")));
    }
}
