//! Choice between a GPU and the CPU, with the reasons in words.

use crate::device::{Candidate, devices, preferred};
use crate::vulkan::{Vulkan, chain};

/// The environment variable that selects a device.
const DEVICE: &str = "PHOTON_VK_DEVICE";

/// Indices of all suitable devices that are not software drivers, at least one.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn gpus() -> Result<Vec<String>, String> {
    let found = devices().map_err(|error| why_not(&error))?;
    worth_it(&found.iter().map(Summary::from).collect::<Vec<_>>())?;
    let suitable = found.iter().filter(|device| device.lacks.is_empty() && device.kind != SOFTWARE);
    Ok(suitable.map(|device| device.index.to_string()).collect())
}

/// Whether the device that the library prefers, or that the user selected, is a GPU and no software driver; none is opened.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn prefers_gpu() -> Result<(), String> {
    if is_selected() {
        let selected = preferred().map_err(|error| why_not(&error))?;
        if selected.kind == SOFTWARE {
            return Err(format!("{DEVICE} selects {}, which is a software driver", selected.name));
        }
        return Ok(());
    }
    let found = devices().map_err(|error| why_not(&error))?;
    worth_it(&found.iter().map(Summary::from).collect::<Vec<_>>())
}

/// Whether the user selected a device.
fn is_selected() -> bool {
    std::env::var_os(DEVICE).is_some_and(|value| !value.is_empty())
}

/// Opens the device that the user selected by PHOTON_VK_DEVICE, of whatever kind, else a GPU: without a selection never a
/// software driver, which is slower than the cores of the CPU.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn requested_gpu() -> Result<Vulkan, String> {
    if !is_selected() {
        prefers_gpu()?;
    }
    Vulkan::new().map_err(|error| chain(&error))
}

const SOFTWARE: &str = "software";

/// The properties of a candidate that determine the choice.
struct Summary<'a> {
    name: &'a str,
    kind: &'a str,
    lacks: &'a [String],
}

impl<'a> From<&'a Candidate> for Summary<'a> {
    fn from(candidate: &'a Candidate) -> Self {
        Self { name: &candidate.name, kind: candidate.kind, lacks: &candidate.lacks }
    }
}

/// Whether some device is expected to be faster than the CPU.
fn worth_it(found: &[Summary<'_>]) -> Result<(), String> {
    if found.iter().any(|device| device.lacks.is_empty() && device.kind != SOFTWARE) {
        return Ok(());
    }
    let why = |device: &Summary<'_>| {
        if device.lacks.is_empty() {
            format!("{} is a software driver", device.name)
        } else {
            format!("{} lacks {}", device.name, device.lacks.join(", "))
        }
    };
    let all: Vec<String> = found.iter().map(why).collect();
    Err(match all.as_slice() {
        [] => "Vulkan lists no device".to_owned(),
        all => format!("no Vulkan device is a suitable GPU: {}", all.join("; ")),
    })
}

/// Why Vulkan is not available, and what to do about it.
#[must_use]
pub fn why_not(error: &photon_core::Error) -> String {
    let rejected = match error {
        photon_core::Error::NoDevice { rejected } => rejected,
        photon_core::Error::UnknownDevice { wanted, .. } => {
            let is_variable = std::env::var_os(DEVICE).is_some_and(|value| value == wanted.as_str());
            let place = if is_variable { format!("{DEVICE}: ") } else { String::new() };
            return format!("{place}{error}, or use --backend cpu");
        }
        other => return chain(other),
    };
    let hint = format!(
        "update its driver, select another by --device or {DEVICE} (`photonmap devices` lists them), or use --backend cpu"
    );
    if rejected.is_empty() {
        return format!("Vulkan lists no device: {hint}");
    }
    let each: Vec<String> = rejected.iter().map(|(name, why)| format!("{name} {why}")).collect();
    format!("no suitable Vulkan device; there are: {}; {hint}", each.join("; "))
}

/// One line for each device that Vulkan lists.
///
/// # Errors
/// That there is no loader or no driver, in words.
pub fn list() -> Result<Vec<String>, String> {
    let found = devices().map_err(|error| why_not(&error))?;
    let line = |device: &Candidate| {
        let (major, minor) = device.version;
        let verdict =
            if device.lacks.is_empty() { "suitable".to_owned() } else { format!("lacks {}", device.lacks.join(", ")) };
        format!("{}: {}, {}, Vulkan {major}.{minor}, {verdict}", device.index, device.name, device.kind)
    };
    Ok(found.iter().map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_suitable_gpu_is_worth_leaving_the_processor() {
        let lack = ["bufferDeviceAddress".to_owned()];
        let soft = || Summary { name: "Soft", kind: SOFTWARE, lacks: &[] };
        let old = || Summary { name: "Old", kind: "discrete GPU", lacks: &lack };
        let new = || Summary { name: "New", kind: "integrated GPU", lacks: &[] };
        assert!(worth_it(&[soft(), old(), new()]).is_ok());
        let why = worth_it(&[soft(), old()]).unwrap_err();
        assert!(why.contains("Soft is a software driver") && why.contains("Old lacks bufferDeviceAddress"), "{why}");
        assert!(worth_it(&[]).unwrap_err().contains("no device"));
    }

    #[test]
    fn each_rejected_device_is_named_with_what_it_lacks() {
        let rejected = vec![("Old".to_owned(), "lacks timelineSemaphore".to_owned())];
        let text = why_not(&photon_core::Error::NoDevice { rejected });
        assert!(
            text.contains("Old lacks timelineSemaphore; update its driver") && text.contains("--backend cpu"),
            "{text}"
        );
        let known = vec!["number 0 is New".to_owned()];
        let text = why_not(&photon_core::Error::UnknownDevice { wanted: "7".to_owned(), known });
        assert!(text.contains("number 0 is New; give a number") && !text.contains("update"), "{text}");
    }
}
