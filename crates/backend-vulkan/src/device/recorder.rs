//! Records all commands and places all barriers.
//!
//! Every command waits for those before it, by one barrier over all memory: a barrier between kernels costs
//! only microseconds, and no code has to track which buffers were written. Commands that do not access each
//! other's memory can be grouped by [`Recorder::set_ordered`].

use std::sync::Arc;

use ash::vk;
use gpu_allocator::MemoryLocation;
use photon_core::{Result, StopCondition};

use super::logical::Device;
use super::memory::Memory;
use super::queue::{Queue, Recording};
use crate::parameters::MAX_PUSHED;

/// Commands after which a submission is made, so that the device starts while the host goes on recording.
const PILE: u32 = 256;
/// Size in bytes of the staging buffer for downloads.
pub(crate) const READ_BACK: u64 = 32 << 20;
/// Up to this size, uploads are embedded in the command buffer.
const INLINE: usize = 32 << 10;

/// Records commands, submits them, and waits for them.
#[derive(Debug)]
pub(crate) struct Recorder {
    device: Arc<Device>,
    queue: Queue,
    open: Option<Recording>,
    recorded: u32,
    ordered: bool,
    /// The condition under which no more of a pass is submitted.
    stop: Option<StopCondition>,
    read_back: Option<Memory>,
    /// Whether the host writes parameters directly where it can.
    maps_parameters: bool,
}

impl Recorder {
    pub(crate) fn new(device: &Arc<Device>) -> Result<Self> {
        let queue = Queue::new(device)?;
        Ok(Self {
            device: device.clone(),
            queue,
            open: None,
            recorded: 0,
            ordered: true,
            stop: None,
            read_back: None,
            maps_parameters: true,
        })
    }

    /// The open command buffer, with a barrier against all earlier commands.
    pub(crate) fn commands(&mut self) -> Result<vk::CommandBuffer> {
        if self.recorded >= PILE && self.ordered {
            self.check_stop()?;
            self.submit()?;
        }
        let commands = match &self.open {
            Some(recording) => recording.commands,
            None => {
                let commands = self.open.insert(self.queue.open()?).commands;
                self.barrier(commands);
                self.recorded += 1;
                return Ok(commands);
            }
        };
        if self.ordered {
            self.barrier(commands);
        }
        self.recorded += 1;
        Ok(commands)
    }

    fn barrier(&self, commands: vk::CommandBuffer) {
        let stages = vk::PipelineStageFlags::COMPUTE_SHADER | vk::PipelineStageFlags::TRANSFER;
        let after = stages | vk::PipelineStageFlags::DRAW_INDIRECT | vk::PipelineStageFlags::HOST;
        let writes = vk::AccessFlags::SHADER_WRITE | vk::AccessFlags::TRANSFER_WRITE;
        let reads = vk::AccessFlags::SHADER_READ
            | vk::AccessFlags::TRANSFER_READ
            | vk::AccessFlags::INDIRECT_COMMAND_READ
            | vk::AccessFlags::HOST_READ;
        let all = [vk::MemoryBarrier::default().src_access_mask(writes).dst_access_mask(reads | writes)];
        // SAFETY: the command buffer is open.
        unsafe {
            self.device.raw.cmd_pipeline_barrier(commands, stages, after, vk::DependencyFlags::empty(), &all, &[], &[]);
        }
    }

    /// Whether commands wait for each other from now on; the next one waits in any case.
    pub(crate) fn set_ordered(&mut self, ordered: bool) -> Result<()> {
        if self.ordered && !ordered {
            // The first command of the group waits for all earlier ones.
            self.commands()?;
        }
        self.ordered = ordered;
        Ok(())
    }

    pub(crate) fn dispatch(
        &mut self,
        layout: vk::PipelineLayout,
        pipeline: vk::Pipeline,
        parameters: &[u8],
        groups: Groups<'_>,
    ) -> Result<()> {
        let commands = self.commands()?;
        let address;
        let push: &[u8] = if parameters.len() <= MAX_PUSHED {
            parameters
        } else {
            address = self.place(parameters)?.to_ne_bytes();
            &address
        };
        let device = &self.device.raw;
        // SAFETY: the pipeline and the layout are alive, and the push constants fit its range.
        unsafe {
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, pipeline);
            device.cmd_push_constants(commands, layout, vk::ShaderStageFlags::COMPUTE, 0, push);
            match groups {
                Groups::Flat(count) => {
                    let rows = count.div_ceil(32_768);
                    device.cmd_dispatch(commands, count.div_ceil(rows.max(1)) as u32, rows as u32, 1);
                }
                Groups::Indirect(memory, offset) => {
                    device.cmd_dispatch_indirect(commands, memory.buffer(), memory.offset() + offset);
                }
            }
        }
        Ok(())
    }

    /// Writes parameters to memory that lives as long as the open command buffer; returns their address.
    fn place(&mut self, parameters: &[u8]) -> Result<u64> {
        let Some(Recording { commands, parameters: blocks }) = &mut self.open else {
            return Err(super::Fault::Other("parameters without a command buffer".to_owned()).into());
        };
        let commands = *commands;
        let place = blocks.place(&self.device, parameters, self.maps_parameters)?;
        let address = place.address;
        if let Some((to, offset)) = place.unwritten {
            // No earlier command uses that memory, but the dispatch has to wait for this one.
            // SAFETY: within the buffer, a multiple of 4, at most 64 KiB.
            unsafe { self.device.raw.cmd_update_buffer(commands, to.buffer(), to.offset() + offset, parameters) };
            self.barrier(commands);
        }
        Ok(address)
    }

    /// Writes parameters by commands, as on a device whose memory the host cannot write to.
    #[cfg(test)]
    pub(crate) fn write_parameters_by_commands(&mut self) {
        self.maps_parameters = false;
    }

    pub(crate) fn fill(&mut self, to: &Memory, offset: u64, bytes: u64, word: u32) -> Result<()> {
        if bytes == 0 {
            return Ok(());
        }
        let commands = self.commands()?;
        // SAFETY: the range lies within the buffer, which `Vulkan::fill_words` checks.
        unsafe { self.device.raw.cmd_fill_buffer(commands, to.buffer(), to.offset() + offset, bytes, word) };
        Ok(())
    }

    pub(crate) fn copy(&mut self, from: (&Memory, u64), to: (&Memory, u64), bytes: u64) -> Result<()> {
        if bytes == 0 {
            return Ok(());
        }
        let region =
            [vk::BufferCopy { src_offset: from.0.offset() + from.1, dst_offset: to.0.offset() + to.1, size: bytes }];
        let commands = self.commands()?;
        // SAFETY: both ranges lie within their buffers, which `Vulkan::copy` checks.
        unsafe { self.device.raw.cmd_copy_buffer(commands, from.0.buffer(), to.0.buffer(), &region) };
        Ok(())
    }

    /// Writes in order with all other commands; the data are copied.
    pub(crate) fn write(&mut self, to: &Memory, offset: u64, data: &[u8]) -> Result<()> {
        if data.is_empty() {
            return Ok(());
        }
        if data.len() <= INLINE && data.len().is_multiple_of(4) {
            let commands = self.commands()?;
            // SAFETY: within the buffer, a multiple of 4, at most 64 KiB.
            unsafe { self.device.raw.cmd_update_buffer(commands, to.buffer(), to.offset() + offset, data) };
            return Ok(());
        }
        let mut staging = Memory::new(&self.device, "upload", data.len() as u64, MemoryLocation::CpuToGpu)?;
        match staging.mapped() {
            Some(mapped) => mapped[..data.len()].copy_from_slice(data),
            None => return Err(super::Fault::Other("memory for uploads is not host-visible".to_owned()).into()),
        }
        // The staging buffer is dropped here, and freed when the device no longer uses it.
        self.copy((&staging, 0), (to, offset), data.len() as u64)
    }

    /// Submits everything, waits, and copies the data.
    pub(crate) fn read(&mut self, from: &Memory, offset: u64, to: &mut [u8]) -> Result<()> {
        for (part, to) in to.chunks_mut(READ_BACK as usize).enumerate() {
            let range = (from, offset + part as u64 * READ_BACK);
            self.read_parts(&[range], to.len() as u64, |bytes| to.copy_from_slice(bytes))?;
        }
        Ok(())
    }

    /// Submits everything, waits, and calls `take` with the data of these parts, `bytes` of each, one after another. They are
    /// copied without barriers between them.
    pub(crate) fn read_parts(&mut self, parts: &[(&Memory, u64)], bytes: u64, take: impl FnOnce(&[u8])) -> Result<()> {
        let all = parts.len() as u64 * bytes;
        let mut through = match self.read_back.take() {
            Some(memory) if memory.bytes() >= all => memory,
            _ => {
                let size = if all <= 65_536 { 65_536 } else { READ_BACK.max(all) };
                Memory::new(&self.device, "download", size, MemoryLocation::GpuToCpu)?
            }
        };
        self.set_ordered(false)?;
        let mut parts = parts.iter().enumerate();
        let copied = parts.try_for_each(|(i, &from)| self.copy(from, (&through, i as u64 * bytes), bytes));
        self.set_ordered(true)?;
        copied?;
        self.commands()?;
        self.wait()?;
        match through.mapped() {
            Some(mapped) => take(&mapped[..all as usize]),
            None => return Err(super::Fault::Other("memory for downloads is not host-visible".to_owned()).into()),
        }
        self.read_back = Some(through);
        Ok(())
    }

    /// Submits the recorded commands.
    pub(crate) fn submit(&mut self) -> Result<()> {
        self.recorded = 0;
        match self.open.take() {
            Some(recording) => self.queue.submit(recording),
            None => Ok(()),
        }
    }

    /// Submits the recorded commands and waits until everything is complete.
    pub(crate) fn wait(&mut self) -> Result<()> {
        self.check_stop()?;
        self.submit()?;
        self.queue.wait()?;
        self.device.bury();
        Ok(())
    }

    /// Discards recorded commands that were not submitted.
    #[cfg(test)]
    pub(crate) fn forget(&mut self) {
        self.open = None;
    }

    /// Lets submissions and waits end with an error when the condition is met. What has been recorded stays, and is submitted
    /// later.
    pub(crate) fn stop_when(&mut self, condition: Option<StopCondition>) {
        self.stop = condition;
    }

    fn check_stop(&self) -> Result<()> {
        self.stop.as_ref().map_or(Ok(()), StopCondition::check)
    }

    /// Writes a timestamp when all earlier commands are complete.
    pub(crate) fn stamp(&mut self, pool: vk::QueryPool, index: u32) -> Result<()> {
        let commands = self.commands()?;
        // SAFETY: the query was reset by the host and the pool is alive.
        unsafe {
            self.device.raw.cmd_write_timestamp(commands, vk::PipelineStageFlags::BOTTOM_OF_PIPE, pool, index);
        }
        Ok(())
    }

    /// Begins (with a name) or ends a group of commands, for debuggers.
    pub(crate) fn label(&mut self, name: Option<&str>) -> Result<()> {
        if self.device.debug.is_none() {
            return Ok(());
        }
        let commands = self.commands()?;
        if let Some(debug) = &self.device.debug {
            let name = name.map(|name| std::ffi::CString::new(name).unwrap_or_default());
            let name = name.unwrap_or_else(|| c"-".to_owned());
            let info = vk::DebugUtilsLabelEXT::default().label_name(&name);
            // SAFETY: the command buffer is open and the name is null-terminated.
            unsafe { debug.cmd_insert_debug_utils_label(commands, &info) };
        }
        Ok(())
    }
}

/// Number of workgroups of a dispatch.
pub(crate) enum Groups<'a> {
    /// A flat number, laid out in rows of at most 32 768.
    Flat(u64),
    /// Indirect: three words at an offset.
    Indirect(&'a Memory, u64),
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // Commands recorded but not submitted are discarded; buffers they refer to are freed with the device,
        // which waits first.
        self.open = None;
        if let Err(error) = self.queue.wait() {
            log::error!("{error}");
        }
    }
}
