//! Which physical device: by name or number if asked, else the most capable one.

use std::ffi::CStr;

use ash::vk;

/// A physical device, and whether it will do.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its number, in the order in which Vulkan lists it.
    pub index: usize,
    /// The driver's name for it.
    pub name: String,
    /// Discrete, integrated, virtual, software or other.
    pub kind: &'static str,
    /// The Vulkan version that it offers.
    pub version: (u32, u32),
    /// What it lacks, in words; empty if it is suitable.
    pub lacks: Vec<String>,
    pub(crate) handle: vk::PhysicalDevice,
    pub(crate) family: u32,
    rank: u32,
}

/// All devices that Vulkan lists here, suitable or not.
///
/// # Errors
/// [`photon_core::Error::Backend`] if there is no loader or no driver.
pub fn devices() -> photon_core::Result<Vec<Candidate>> {
    let (_entry, instance) = super::instance::bare_instance()?;
    let found = candidates(&instance);
    // SAFETY: created above, and nothing made from it is left.
    unsafe { instance.destroy_instance(None) };
    found
}

pub(crate) fn candidates(instance: &ash::Instance) -> photon_core::Result<Vec<Candidate>> {
    // SAFETY: the instance is alive.
    let handles = unsafe { instance.enumerate_physical_devices() };
    let handles = handles.map_err(super::fault::during("listing devices"))?;
    Ok(handles.into_iter().enumerate().map(|(index, handle)| candidate(instance, index, handle)).collect())
}

fn candidate(instance: &ash::Instance, index: usize, handle: vk::PhysicalDevice) -> Candidate {
    // SAFETY: the handle comes from this instance.
    let properties = unsafe { instance.get_physical_device_properties(handle) };
    let name = properties.device_name_as_c_str().map_or("unnamed", |name| name.to_str().unwrap_or("unnamed"));
    let version = (vk::api_version_major(properties.api_version), vk::api_version_minor(properties.api_version));
    let (kind, rank) = match properties.device_type {
        vk::PhysicalDeviceType::DISCRETE_GPU => ("discrete GPU", 4),
        vk::PhysicalDeviceType::INTEGRATED_GPU => ("integrated GPU", 3),
        vk::PhysicalDeviceType::VIRTUAL_GPU => ("virtual GPU", 2),
        vk::PhysicalDeviceType::CPU => ("software", 1),
        _ => ("other", 0),
    };
    let mut lacks = Vec::new();
    if version < (1, 2) {
        lacks.push(format!("Vulkan 1.2 (it has {}.{})", version.0, version.1));
    } else {
        lacks.extend(missing_features(instance, handle));
    }
    let limits = &properties.limits;
    let floors = [
        ("push constants of 128 bytes", limits.max_push_constants_size >= 128),
        ("32 KiB of shared memory", limits.max_compute_shared_memory_size >= 32 * 1024),
        ("workgroups of 256", limits.max_compute_work_group_invocations >= 256),
    ];
    lacks.extend(floors.iter().filter(|(_, there)| !there).map(|(what, _)| (*what).to_owned()));
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(handle) };
    let compute = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
    let family = families.iter().position(compute);
    if family.is_none() {
        lacks.push("a queue that computes".to_owned());
    }
    Candidate { index, name: name.to_owned(), kind, version, lacks, handle, family: family.unwrap_or(0) as u32, rank }
}

/// What of the baseline a Vulkan 1.2 device lacks.
fn missing_features(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Vec<String> {
    let mut twelve = vk::PhysicalDeviceVulkan12Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut twelve);
    // SAFETY: the handle comes from this instance, and the chain is of the structures that it names.
    unsafe { instance.get_physical_device_features2(handle, &mut features) };
    // Address arithmetic of buffer references.
    let wide = features.features.shader_int64 == vk::TRUE;
    let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut subgroup);
    // SAFETY: likewise.
    unsafe { instance.get_physical_device_properties2(handle, &mut properties) };
    let operations = vk::SubgroupFeatureFlags::BASIC
        | vk::SubgroupFeatureFlags::VOTE
        | vk::SubgroupFeatureFlags::ARITHMETIC
        | vk::SubgroupFeatureFlags::BALLOT
        | vk::SubgroupFeatureFlags::SHUFFLE;
    let in_compute = subgroup.supported_stages.contains(vk::ShaderStageFlags::COMPUTE);
    let size = subgroup.subgroup_size;
    let baseline = [
        ("shaderInt64", wide),
        ("bufferDeviceAddress", twelve.buffer_device_address == vk::TRUE),
        ("scalarBlockLayout", twelve.scalar_block_layout == vk::TRUE),
        ("timelineSemaphore", twelve.timeline_semaphore == vk::TRUE),
        ("hostQueryReset", twelve.host_query_reset == vk::TRUE),
        ("subgroup operations in compute", in_compute && subgroup.supported_operations.contains(operations)),
        ("subgroups of 4 to 128", (4..=128).contains(&size)),
    ];
    baseline.iter().filter(|(_, there)| !there).map(|(what, _)| (*what).to_owned()).collect()
}

/// The device that `wanted` names by number or part of its name; without it, the most capable of
/// the suitable ones, discrete before integrated before virtual before software.
///
/// # Errors
/// [`photon_core::Error::NoDevice`] says of each device what it lacks.
pub(crate) fn choose(found: Vec<Candidate>, wanted: Option<&str>) -> photon_core::Result<Candidate> {
    let named = |candidate: &Candidate| match wanted {
        None => true,
        Some(wanted) => match wanted.parse::<usize>() {
            Ok(index) => candidate.index == index,
            Err(_) => candidate.name.to_lowercase().contains(&wanted.to_lowercase()),
        },
    };
    let best = found
        .iter()
        .filter(|candidate| candidate.lacks.is_empty() && named(candidate))
        .max_by_key(|candidate| (candidate.rank, std::cmp::Reverse(candidate.index)));
    if let Some(best) = best {
        return Ok(best.clone());
    }
    let why = |candidate: &Candidate| {
        if candidate.lacks.is_empty() {
            format!("is not the {} that was asked for", wanted.unwrap_or_default())
        } else {
            format!("lacks {}", candidate.lacks.join(", "))
        }
    };
    Err(photon_core::Error::NoDevice { rejected: found.iter().map(|c| (c.name.clone(), why(c))).collect() })
}

/// Whether a list of extensions or layers has one.
pub(crate) fn has(names: impl IntoIterator<Item = [std::ffi::c_char; 256]>, wanted: &CStr) -> bool {
    names.into_iter().any(|name| {
        let bytes: Vec<u8> = name.iter().take_while(|&&c| c != 0).map(|&c| c as u8).collect();
        bytes == wanted.to_bytes()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(index: usize, name: &str, rank: u32, lacks: &[&str]) -> Candidate {
        Candidate {
            index,
            name: name.to_owned(),
            kind: "other",
            version: (1, 2),
            lacks: lacks.iter().map(|&lack| lack.to_owned()).collect(),
            handle: vk::PhysicalDevice::null(),
            family: 0,
            rank,
        }
    }

    fn three() -> Vec<Candidate> {
        vec![
            candidate(0, "Soft pipe", 1, &[]),
            candidate(1, "Old card", 4, &["hostQueryReset"]),
            candidate(2, "New card", 4, &[]),
        ]
    }

    #[test]
    fn the_most_capable_suitable_device_is_taken() {
        assert_eq!(choose(three(), None).unwrap().index, 2);
    }

    #[test]
    fn a_number_or_a_part_of_the_name_chooses() {
        assert_eq!(choose(three(), Some("0")).unwrap().index, 0);
        assert_eq!(choose(three(), Some("soft")).unwrap().index, 0);
    }

    #[test]
    fn each_rejected_device_says_why() {
        let Err(photon_core::Error::NoDevice { rejected }) = choose(three(), Some("old")) else { panic!("a device") };
        assert_eq!(rejected.len(), 3);
        assert!(rejected[1].1.contains("hostQueryReset"));
        assert!(rejected[0].1.contains("old"));
    }
}
