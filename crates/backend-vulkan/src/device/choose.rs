//! Selects the physical device: by name or index if requested, otherwise the most capable one.

use std::ffi::CStr;

use ash::vk;

/// A physical device, and whether it is suitable.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Candidate {
    /// Its index, in the order in which Vulkan enumerates devices.
    pub index: usize,
    /// Name of the device, from the driver.
    pub name: String,
    /// Device type: discrete, integrated, virtual, software or other.
    pub kind: &'static str,
    /// The Vulkan version it supports.
    pub version: (u32, u32),
    /// Required features that it lacks, in words; empty if it is suitable.
    pub lacks: Vec<String>,
    pub(crate) handle: vk::PhysicalDevice,
    pub(crate) family: u32,
    rank: u32,
}

/// All Vulkan devices of this machine, suitable or not.
///
/// # Errors
/// [`photon_core::Error::Backend`] if there is no loader or no driver.
pub fn devices() -> photon_core::Result<Vec<Candidate>> {
    candidates(&super::instance::Instance::shared(false)?.raw)
}

/// The device that [`crate::Vulkan::new`] would open, without opening it.
///
/// # Errors
/// Those of [`crate::Vulkan::new`].
pub fn preferred() -> photon_core::Result<Candidate> {
    choose(devices()?, super::logical::from_environment().as_deref())
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
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(handle) };
    let compute = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
    let family = families.iter().position(compute);
    let mut offer = Offer { version, limits: properties.limits, computes: family.is_some(), ..Offer::default() };
    if version >= (1, 2) {
        offer.ask(instance, handle);
    }
    let lacks = offer.lacks();
    Candidate { index, name: name.to_owned(), kind, version, lacks, handle, family: family.unwrap_or(0) as u32, rank }
}

/// The features and limits of a device that the baseline requires.
#[derive(Clone, Copy, Default)]
struct Offer {
    version: (u32, u32),
    /// 64-bit integers, for address arithmetic of buffer references.
    int64: bool,
    address: bool,
    scalar: bool,
    timeline: bool,
    reset: bool,
    /// Subgroup operations supported in compute shaders.
    subgroup: vk::SubgroupFeatureFlags,
    subgroup_size: u32,
    limits: vk::PhysicalDeviceLimits,
    computes: bool,
}

impl Offer {
    const OPERATIONS: vk::SubgroupFeatureFlags = vk::SubgroupFeatureFlags::from_raw(
        vk::SubgroupFeatureFlags::BASIC.as_raw()
            | vk::SubgroupFeatureFlags::VOTE.as_raw()
            | vk::SubgroupFeatureFlags::ARITHMETIC.as_raw()
            | vk::SubgroupFeatureFlags::BALLOT.as_raw()
            | vk::SubgroupFeatureFlags::SHUFFLE.as_raw()
            | vk::SubgroupFeatureFlags::SHUFFLE_RELATIVE.as_raw(),
    );

    /// Queries the features of a device with Vulkan 1.2 or later.
    fn ask(&mut self, instance: &ash::Instance, handle: vk::PhysicalDevice) {
        let mut twelve = vk::PhysicalDeviceVulkan12Features::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut twelve);
        // SAFETY: the handle comes from this instance, and the chain consists of the structures that it names.
        unsafe { instance.get_physical_device_features2(handle, &mut features) };
        self.int64 = features.features.shader_int64 == vk::TRUE;
        self.address = twelve.buffer_device_address == vk::TRUE;
        self.scalar = twelve.scalar_block_layout == vk::TRUE;
        self.timeline = twelve.timeline_semaphore == vk::TRUE;
        self.reset = twelve.host_query_reset == vk::TRUE;
        let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut subgroup);
        // SAFETY: likewise.
        unsafe { instance.get_physical_device_properties2(handle, &mut properties) };
        self.subgroup_size = subgroup.subgroup_size;
        if subgroup.supported_stages.contains(vk::ShaderStageFlags::COMPUTE) {
            self.subgroup = subgroup.supported_operations;
        }
    }

    /// The baseline requirements that are missing. For devices with an older version only the version and the
    /// limits are known.
    fn lacks(&self) -> Vec<String> {
        let mut lacks = Vec::new();
        if self.version < (1, 2) {
            lacks.push(format!("Vulkan 1.2 (it has {}.{})", self.version.0, self.version.1));
        } else {
            let features = [
                ("shaderInt64", self.int64),
                ("bufferDeviceAddress", self.address),
                ("scalarBlockLayout", self.scalar),
                ("timelineSemaphore", self.timeline),
                ("hostQueryReset", self.reset),
                ("subgroup operations in compute", self.subgroup.contains(Self::OPERATIONS)),
                ("subgroups of 4 to 128", (4..=128).contains(&self.subgroup_size)),
            ];
            lacks.extend(features.iter().filter(|(_, there)| !there).map(|(what, _)| (*what).to_owned()));
        }
        let limits = &self.limits;
        let floors = [
            ("32 KiB of shared memory", limits.max_compute_shared_memory_size >= 32 * 1024),
            ("workgroups of 256", limits.max_compute_work_group_invocations >= 256),
            ("a compute queue", self.computes),
        ];
        lacks.extend(floors.iter().filter(|(_, there)| !there).map(|(what, _)| (*what).to_owned()));
        lacks
    }
}

/// The device that `wanted` selects by index or part of its name; without it, the most capable suitable one:
/// discrete before integrated before virtual before software.
///
/// # Errors
/// [`photon_core::Error::UnknownDevice`] lists the devices; [`photon_core::Error::NoDevice`] states what each that was
/// selected lacks.
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
    let rejected = found.iter().filter(|candidate| named(candidate));
    let rejected = rejected.map(|c| (c.name.clone(), format!("lacks {}", c.lacks.join(", ")))).collect::<Vec<_>>();
    match wanted {
        Some(wanted) if rejected.is_empty() && !found.is_empty() => {
            let known =
                found.iter().map(|candidate| format!("number {} is {}", candidate.index, candidate.name)).collect();
            Err(photon_core::Error::UnknownDevice { wanted: wanted.to_owned(), known })
        }
        _ => Err(photon_core::Error::NoDevice { rejected }),
    }
}

/// Whether a list of extensions or layers contains `wanted`.
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
        assert_eq!(rejected.len(), 1);
        assert!(rejected[0].1.contains("hostQueryReset"));
    }

    #[test]
    fn an_unknown_device_lists_those_there_are() {
        for wanted in ["7", "matrox"] {
            let text = choose(three(), Some(wanted)).map(drop).unwrap_err().to_string();
            assert!(text.starts_with(&format!("there is no device '{wanted}'; number 0 is ")), "{text}");
            assert!(
                three().iter().all(|known| text.contains(&format!("number {} is {}", known.index, known.name))),
                "{text}"
            );
        }
        let none = choose(Vec::new(), Some("7"));
        assert!(matches!(none, Err(photon_core::Error::NoDevice { rejected }) if rejected.is_empty()));
    }

    /// A device that just meets the baseline.
    fn enough() -> Offer {
        let limits = vk::PhysicalDeviceLimits {
            max_compute_shared_memory_size: 32 * 1024,
            max_compute_work_group_invocations: 256,
            ..Default::default()
        };
        Offer {
            version: (1, 2),
            int64: true,
            address: true,
            scalar: true,
            timeline: true,
            reset: true,
            subgroup: Offer::OPERATIONS,
            subgroup_size: 4,
            limits,
            computes: true,
        }
    }

    /// A missing requirement as reported, and a change that causes it.
    type Harm = (&'static str, fn(&mut Offer));

    /// Every missing baseline requirement is named.
    #[test]
    fn whatever_is_missing_is_named() {
        assert_eq!(enough().lacks(), Vec::<String>::new());
        let harms: [Harm; 12] = [
            ("Vulkan 1.2 (it has 1.1)", |offer| offer.version = (1, 1)),
            ("shaderInt64", |offer| offer.int64 = false),
            ("bufferDeviceAddress", |offer| offer.address = false),
            ("scalarBlockLayout", |offer| offer.scalar = false),
            ("timelineSemaphore", |offer| offer.timeline = false),
            ("hostQueryReset", |offer| offer.reset = false),
            ("subgroup operations in compute", |offer| offer.subgroup &= !vk::SubgroupFeatureFlags::SHUFFLE),
            ("subgroups of 4 to 128", |offer| offer.subgroup_size = 1),
            ("subgroups of 4 to 128", |offer| offer.subgroup_size = 256),
            ("32 KiB of shared memory", |offer| offer.limits.max_compute_shared_memory_size = 16 * 1024),
            ("workgroups of 256", |offer| offer.limits.max_compute_work_group_invocations = 128),
            ("a compute queue", |offer| offer.computes = false),
        ];
        for (what, harm) in harms {
            let mut offer = enough();
            harm(&mut offer);
            assert_eq!(offer.lacks(), [what]);
        }
    }
}
