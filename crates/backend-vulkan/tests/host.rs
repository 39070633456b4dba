//! A host's device whose driver functions are intercepted and fail on demand: how the backend reacts.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock};

use backend_vulkan::ash::{self, vk};
use backend_vulkan::{RawDevice, Vulkan, low_level};
use photon_core::{Backend, Error, Indirect, PassEnd, Photon, Pipeline, Render, Settings, View};

/// If set, every submission reports that the device is lost.
static LOST: AtomicBool = AtomicBool::new(false);
/// If set, every allocation reports that memory is exhausted.
static FULL: AtomicBool = AtomicBool::new(false);
/// Bytes copied from buffer to buffer, which is how all data are read back.
static COPIED: AtomicU64 = AtomicU64::new(0);
/// Serializes the tests, since the state above is global.
static ALONE: Mutex<()> = Mutex::new(());
/// The driver's own functions.
static SUBMIT: OnceLock<vk::PFN_vkQueueSubmit> = OnceLock::new();
static WAIT: OnceLock<vk::PFN_vkWaitSemaphores> = OnceLock::new();
static ALLOCATE: OnceLock<vk::PFN_vkAllocateMemory> = OnceLock::new();
static COPY: OnceLock<vk::PFN_vkCmdCopyBuffer> = OnceLock::new();

unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    what: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    if LOST.load(Ordering::SeqCst) {
        return vk::Result::ERROR_DEVICE_LOST;
    }
    // SAFETY: as the caller guarantees to the driver.
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

unsafe extern "system" fn copy(
    commands: vk::CommandBuffer,
    from: vk::Buffer,
    to: vk::Buffer,
    count: u32,
    regions: *const vk::BufferCopy,
) {
    // SAFETY: as the caller guarantees to the driver.
    unsafe {
        let bytes = std::slice::from_raw_parts(regions, count as usize).iter().map(|region| region.size).sum();
        COPIED.fetch_add(bytes, Ordering::SeqCst);
        COPY.get().unwrap()(commands, from, to, count, regions);
    }
}

/// A host application: the loader, its instance and its device.
struct Host {
    _entry: ash::Entry,
    raw: RawDevice,
}

impl Host {
    /// Opens the first suitable device, if there is one.
    fn new() -> Option<Self> {
        drop(low_level::for_tests()?);
        let chosen = backend_vulkan::devices().unwrap().into_iter().find(|device| device.lacks.is_empty())?;
        // SAFETY: each handle is made from the one before it, and the structures live until after the calls;
        // the function tables are those of the device, except for four functions that forward their arguments.
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
            let (features, mut twelve) = RawDevice::features();
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
            COPY.get_or_init(|| zero.cmd_copy_buffer);
            zero.cmd_copy_buffer = copy;
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
        // SAFETY: the backend was dropped before.
        unsafe {
            self.raw.device.destroy_device(None);
            self.raw.instance.destroy_instance(None);
        }
    }
}

/// After the device is lost, every call returns the corresponding error, nothing waits for ever, and everything
/// can still be dropped. Then the same for exhausted memory, in the same test, since the intercepted functions
/// are global.
#[test]
fn a_driver_that_fails_is_reported_by_kind() {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let Some(host) = Host::new() else { return };
    let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let settings = Settings { photons: 2000, ..Settings::default() };
    // SAFETY: the handles belong together and outlive everything made from them, the features are enabled, and
    // no other code uses the queue.
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
    // And within a render: an image of 16 million pixels.
    let view = View { camera: scene.camera(None, 4096, 4096).unwrap(), width: 4096, height: 4096 };
    let full = Pipeline::new(on, &scene.view(), view, settings).map(drop);
    assert!(matches!(full, Err(Error::OutOfMemory { .. })), "{full:?}");
    FULL.store(false, Ordering::SeqCst);
    // Works again once there is memory.
    let mut on = open();
    on.alloc::<Photon>("photons: caustic", 1000).unwrap();
}

/// Between emission and film only counts are read back: a pass that stores half a megabyte of photons or more
/// copies less than 4 KiB. The image is copied only when it is requested.
#[test]
fn a_pass_stays_on_the_device() {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let Some(host) = Host::new() else { return };
    let scene = photon_scene::builtin("cornell-glass").unwrap().build().unwrap();
    for indirect in [Indirect::Map, Indirect::Gather] {
        let view = View { camera: scene.camera(None, 64, 64).unwrap(), width: 64, height: 64 };
        let settings = Settings { photons: 30_000, indirect, gather_rays: 2, ..Settings::default() };
        // SAFETY: as above.
        let on = unsafe { Vulkan::from_raw(host.raw.clone()) }.unwrap();
        let mut renderer = Pipeline::new(on, &scene.view(), view, settings).unwrap();
        let copied = |work: &mut dyn FnMut()| {
            let before = COPIED.load(Ordering::SeqCst);
            work();
            COPIED.load(Ordering::SeqCst) - before
        };
        // The first pass may have to allocate.
        renderer.pass(0, &mut ()).unwrap();
        let mut stored = 0;
        let in_pass = copied(&mut || {
            if let Ok(PassEnd::Done(report)) = renderer.pass(1, &mut ()) {
                let tally = report.tally;
                stored = tally.stored.values().sum();
            }
        });
        let in_film = copied(&mut || drop(renderer.film().unwrap()));
        assert!(stored * 32 > 1 << 19, "{indirect:?}: only {stored} photons stored");
        assert!((1..4096).contains(&in_pass), "{indirect:?}: {in_pass} bytes copied in a pass");
        assert!(in_film >= 64 * 64 * 24, "{indirect:?}: {in_film} bytes copied for the image");
    }
}
