//! A host's device whose driver fails when it is told to: what becomes of it here.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use backend_vulkan::ash::{self, vk};
use backend_vulkan::{RawDevice, Vulkan};
use photon_core::{Backend, Error, Photon, Pipeline, Render, Settings, View};

/// From here on every submission finds the device lost.
static LOST: AtomicBool = AtomicBool::new(false);
/// From here on there is no memory left.
static FULL: AtomicBool = AtomicBool::new(false);
/// The driver's own functions.
static SUBMIT: OnceLock<vk::PFN_vkQueueSubmit> = OnceLock::new();
static WAIT: OnceLock<vk::PFN_vkWaitSemaphores> = OnceLock::new();
static ALLOCATE: OnceLock<vk::PFN_vkAllocateMemory> = OnceLock::new();

unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    what: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    if LOST.load(Ordering::SeqCst) {
        return vk::Result::ERROR_DEVICE_LOST;
    }
    // SAFETY: as the caller promises the driver.
    unsafe { SUBMIT.get().unwrap()(queue, count, what, fence) }
}

unsafe extern "system" fn wait(device: vk::Device, what: *const vk::SemaphoreWaitInfo<'_>, timeout: u64) -> vk::Result {
    if LOST.load(Ordering::SeqCst) {
        return vk::Result::ERROR_DEVICE_LOST;
    }
    // SAFETY: likewise.
    unsafe { WAIT.get().unwrap()(device, what, timeout) }
}

unsafe extern "system" fn allocate(
    device: vk::Device,
    what: *const vk::MemoryAllocateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    memory: *mut vk::DeviceMemory,
) -> vk::Result {
    if FULL.load(Ordering::SeqCst) {
        return vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
    }
    // SAFETY: likewise.
    unsafe { ALLOCATE.get().unwrap()(device, what, callbacks, memory) }
}

/// A host: the loader, its instance and its device.
struct Host {
    _entry: ash::Entry,
    raw: RawDevice,
}

impl Host {
    /// On the first suitable device, if there is one.
    fn new() -> Option<Self> {
        drop(Vulkan::for_tests()?);
        let chosen = backend_vulkan::devices().unwrap().into_iter().find(|device| device.lacks.is_empty())?;
        // SAFETY: each handle is made from the one before it, and the structures live until after the
        // calls; the tables of functions are those of the device, but for three that pass on what they
        // are called with.
        unsafe {
            let entry = ash::Entry::load().unwrap();
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None).unwrap();
            let physical = instance.enumerate_physical_devices().unwrap()[chosen.index];
            let families = instance.get_physical_device_queue_family_properties(physical);
            let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
            let family = families.iter().position(computes).unwrap() as u32;
            let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
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
            let device = instance.create_device(physical, &info, None).unwrap();
            let queue = device.get_device_queue(family, 0);
            let (mut zero, mut two) = (device.fp_v1_0().clone(), device.fp_v1_2().clone());
            SUBMIT.get_or_init(|| zero.queue_submit);
            WAIT.get_or_init(|| two.wait_semaphores);
            ALLOCATE.get_or_init(|| zero.allocate_memory);
            (zero.queue_submit, two.wait_semaphores, zero.allocate_memory) = (submit, wait, allocate);
            let device = ash::Device::from_parts_1_3(
                device.handle(),
                zero,
                device.fp_v1_1().clone(),
                two,
                device.fp_v1_3().clone(),
            );
            Some(Self { _entry: entry, raw: RawDevice { instance, physical, device, queue, family } })
        }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the library's part was dropped before.
        unsafe {
            self.raw.device.destroy_device(None);
            self.raw.instance.destroy_instance(None);
        }
    }
}

/// Every call after it says so, by an error of its own kind; nothing waits for ever, and all of it can
/// still be dropped. Then the same of memory: one test, since what the driver does is one for all.
#[test]
fn a_driver_that_fails_is_reported_by_kind() {
    let Some(host) = Host::new() else { return };
    let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let settings = Settings { photons: 2000, ..Settings::default() };
    // SAFETY: the handles belong together and outlive what is made of them, the features are on, and
    // nobody else uses the queue.
    let open = || unsafe { Vulkan::from_raw(host.raw.clone()) }.unwrap();
    let mut renderer = Pipeline::new(open(), &scene.view(), view, settings.clone()).unwrap();
    renderer.pass(0, &mut ()).unwrap();
    LOST.store(true, Ordering::SeqCst);
    let lost = renderer.pass(1, &mut ());
    assert!(matches!(lost, Err(Error::DeviceLost)), "{lost:?}");
    let film = renderer.film();
    assert!(matches!(film, Err(Error::DeviceLost)), "{:?}", film.map(|film| film.passes));
    drop(renderer);
    LOST.store(false, Ordering::SeqCst);

    let mut on = open();
    FULL.store(true, Ordering::SeqCst);
    // Larger than the blocks that small buffers share.
    let bytes = 512 << 20;
    let full = on.alloc::<Photon>("photons: caustic", bytes / 32).map(drop);
    assert!(matches!(full, Err(Error::OutOfMemory { label: "photons: caustic", bytes: b }) if b == bytes), "{full:?}");
    // And from within a render: a picture of 16 million pixels.
    let view = View { camera: scene.camera(None, 4096, 4096).unwrap(), width: 4096, height: 4096 };
    let full = Pipeline::new(on, &scene.view(), view, settings).map(drop);
    assert!(matches!(full, Err(Error::OutOfMemory { .. })), "{full:?}");
    FULL.store(false, Ordering::SeqCst);
    // It goes on where there is memory again.
    let mut on = open();
    on.alloc::<Photon>("photons: caustic", 1000).unwrap();
}
