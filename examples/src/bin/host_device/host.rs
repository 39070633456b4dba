//! What a renderer with its own Vulkan device already has: instance, device, queue, buffers, and a compute
//! shader that fills the buffers.

use std::error::Error;

use backend_vulkan::RawDevice;
use backend_vulkan::ash::{self, vk};

/// The host's kernel, compiled from `shaders-glsl/example/photons.comp`.
const KERNEL: &[u8] = include_bytes!("../../../../crates/backend-vulkan/spirv/example_photons.spv");

/// The host's device and the objects created on it.
pub(crate) struct Host {
    // Keeps the loader library in memory.
    _entry: ash::Entry,
    pub(crate) device: RawDevice,
    memory_types: vk::PhysicalDeviceMemoryProperties,
    pool: vk::CommandPool,
    buffers: Vec<(vk::Buffer, vk::DeviceMemory)>,
    pipeline: (vk::Pipeline, vk::PipelineLayout, vk::ShaderModule),
}

/// Push constants of the kernel.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct Push {
    pub(crate) photons: u64,
    pub(crate) queries: u64,
    pub(crate) photon_count: u32,
    pub(crate) query_side: u32,
    pub(crate) power: f32,
    pub(crate) side: f32,
    pub(crate) radius: f32,
    /// Padding that rounds the record up to a multiple of its alignment.
    pub(crate) reserved: u32,
}

impl Host {
    /// Opens the first suitable device, preferring hardware.
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let listed = backend_vulkan::devices()?;
        let hardware = |device: &&backend_vulkan::Candidate| device.lacks.is_empty() && device.kind != "software";
        let chosen = listed.iter().find(hardware).or(listed.iter().find(|device| device.lacks.is_empty()));
        let chosen = chosen.ok_or("no suitable Vulkan device: `photonmap devices` says what each lacks")?;
        // SAFETY: the loader is the system's; the structures live until after the calls that take them,
        // and each handle is created from the one before it.
        unsafe {
            let entry = ash::Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None)?;
            let physical = instance.enumerate_physical_devices()?[chosen.index];
            let families = instance.get_physical_device_queue_family_properties(physical);
            let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
            let family = families.iter().position(computes).unwrap_or(0) as u32;
            let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
            // The features that the library requires; a host adds those that it needs itself.
            let (features, mut twelve) = RawDevice::features();
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_features(&features)
                .push_next(&mut twelve);
            let device = instance.create_device(physical, &info, None)?;
            let queue = device.get_device_queue(family, 0);
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
            let pool = device.create_command_pool(&info, None)?;
            let memory_types = instance.get_physical_device_memory_properties(physical);
            let pipeline = pipeline(&device)?;
            let device = RawDevice { instance, physical, device, queue, family };
            Ok(Self { _entry: entry, device, memory_types, pool, buffers: Vec::new(), pipeline })
        }
    }

    /// A device-local buffer and its address.
    pub(crate) fn buffer(&mut self, bytes: u64) -> Result<(vk::Buffer, u64), Box<dyn Error>> {
        let device = &self.device.device;
        // The usages that the library requires of borrowed buffers.
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        let info = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        // SAFETY: the device is alive, the memory is of a type and size that the buffer takes, and is
        // bound before the address is queried.
        unsafe {
            let buffer = device.create_buffer(&info, None)?;
            let needs = device.get_buffer_memory_requirements(buffer);
            let fits = |&index: &u32| {
                let flags = self.memory_types.memory_types[index as usize].property_flags;
                needs.memory_type_bits >> index & 1 == 1 && flags.contains(vk::MemoryPropertyFlags::DEVICE_LOCAL)
            };
            let kind = (0..self.memory_types.memory_type_count).find(fits).unwrap_or(0);
            let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
            let info = vk::MemoryAllocateInfo::default()
                .allocation_size(needs.size)
                .memory_type_index(kind)
                .push_next(&mut flags);
            let memory = device.allocate_memory(&info, None)?;
            self.buffers.push((buffer, memory));
            device.bind_buffer_memory(buffer, memory, 0)?;
            let address = device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(buffer));
            Ok((buffer, address))
        }
    }

    /// Submits the kernel without waiting for it: later submissions to the same queue wait.
    pub(crate) fn run(&self, push: &Push) -> Result<(), Box<dyn Error>> {
        let device = &self.device.device;
        let threads = push.photon_count.max(push.query_side * push.query_side);
        // SAFETY: a record of whole words without gaps.
        let bytes = unsafe { std::slice::from_raw_parts(std::ptr::from_ref(push).cast(), size_of::<Push>()) };
        // SAFETY: the pipeline, the pool and the buffers whose addresses are in `push` live until the
        // host is dropped, which waits for the queue.
        unsafe {
            let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
            let commands = device.allocate_command_buffers(&info)?[0];
            let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
            device.begin_command_buffer(commands, &once)?;
            let (pipeline, layout, _) = self.pipeline;
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, pipeline);
            device.cmd_push_constants(commands, layout, vk::ShaderStageFlags::COMPUTE, 0, bytes);
            device.cmd_dispatch(commands, threads.div_ceil(128), 1, 1);
            // Makes the kernel's writes visible to everything that follows on the queue.
            let barrier = [vk::MemoryBarrier::default()
                .src_access_mask(vk::AccessFlags::SHADER_WRITE)
                .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE)];
            let (from, to) = (vk::PipelineStageFlags::COMPUTE_SHADER, vk::PipelineStageFlags::ALL_COMMANDS);
            device.cmd_pipeline_barrier(commands, from, to, vk::DependencyFlags::empty(), &barrier, &[], &[]);
            device.end_command_buffer(commands)?;
            let commands = [commands];
            let submit = [vk::SubmitInfo::default().command_buffers(&commands)];
            device.queue_submit(self.device.queue, &submit, vk::Fence::null())?;
            Ok(())
        }
    }
}

fn pipeline(device: &ash::Device) -> Result<(vk::Pipeline, vk::PipelineLayout, vk::ShaderModule), Box<dyn Error>> {
    let words: Vec<u32> = KERNEL.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let range =
        [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(size_of::<Push>() as u32)];
    // SAFETY: the words are a valid module, and the structures live until after the calls.
    unsafe {
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        let module = device.create_shader_module(&info, None)?;
        let info = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&range);
        let layout = device.create_pipeline_layout(&info, None)?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main");
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
        let made = device.create_compute_pipelines(vk::PipelineCache::null(), &info, None);
        let pipeline = made.map_err(|(_, result)| result)?[0];
        Ok((pipeline, layout, module))
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        let RawDevice { instance, device, .. } = &self.device;
        // SAFETY: nothing is in use after the wait; the library's part was dropped before. A lost
        // device has nothing left to wait for.
        unsafe {
            let _ = device.device_wait_idle();
            for (buffer, memory) in self.buffers.drain(..) {
                device.destroy_buffer(buffer, None);
                device.free_memory(memory, None);
            }
            let (pipeline, layout, module) = self.pipeline;
            device.destroy_pipeline(pipeline, None);
            device.destroy_pipeline_layout(layout, None);
            device.destroy_shader_module(module, None);
            device.destroy_command_pool(self.pool, None);
            device.destroy_device(None);
            instance.destroy_instance(None);
        }
    }
}
