//! Command buffers in flight, in order, on one queue.

use std::collections::VecDeque;
use std::sync::Arc;

use ash::vk;
use photon_core::Result;

use super::fault::during;
use super::logical::Device;
use super::parameters::ParameterBlocks;

/// Maximum number of submissions in flight.
const FLYING: usize = 4;

/// A command buffer and the parameters of its dispatches. Both are reused when the device has executed it.
#[derive(Debug)]
pub(crate) struct Recording {
    pub(crate) commands: vk::CommandBuffer,
    pub(crate) parameters: ParameterBlocks,
}

/// Command buffers, and the timeline semaphore that counts completed ones.
#[derive(Debug)]
pub(crate) struct Queue {
    device: Arc<Device>,
    pool: vk::CommandPool,
    done: vk::Semaphore,
    /// Semaphore value that the last submission will signal.
    submitted: u64,
    idle: Vec<Recording>,
    flying: VecDeque<(u64, Recording)>,
}

impl Queue {
    pub(crate) fn new(device: &Arc<Device>) -> Result<Self> {
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER | vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is alive, here and below.
        let pool = unsafe { device.raw.create_command_pool(&info, None) }.map_err(during("a command pool"))?;
        device.name(pool, "commands");
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: as above.
        let done = unsafe { device.raw.create_semaphore(&info, None) }.map_err(during("a semaphore"))?;
        device.name(done, "submissions done");
        Ok(Self { device: device.clone(), pool, done, submitted: 0, idle: Vec::new(), flying: VecDeque::new() })
    }

    /// Returns a command buffer in the recording state, without parameters.
    pub(crate) fn open(&mut self) -> Result<Recording> {
        while self.flying.len() >= FLYING {
            let value = self.flying[0].0;
            self.wait_for(value)?;
        }
        let recording = match self.idle.pop() {
            Some(mut recording) => {
                recording.parameters.clear();
                recording
            }
            None => {
                let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
                // SAFETY: the pool is alive.
                let new = unsafe { self.device.raw.allocate_command_buffers(&info) };
                let new = new.map_err(during("a command buffer"))?[0];
                self.device.name(new, "commands");
                Recording { commands: new, parameters: ParameterBlocks::default() }
            }
        };
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: it is not in flight; beginning resets it.
        unsafe { self.device.raw.begin_command_buffer(recording.commands, &info) }.map_err(during("recording"))?;
        Ok(recording)
    }

    /// Ends and submits a command buffer.
    pub(crate) fn submit(&mut self, recording: Recording) -> Result<()> {
        // SAFETY: it is open.
        unsafe { self.device.raw.end_command_buffer(recording.commands) }.map_err(during("recording"))?;
        self.device.injection.submit()?;
        let value = self.submitted + 1;
        let (buffers, semaphores, values) = ([recording.commands], [self.done], [value]);
        let mut timeline = vk::TimelineSemaphoreSubmitInfo::default().signal_semaphore_values(&values);
        let info = [vk::SubmitInfo::default()
            .command_buffers(&buffers)
            .signal_semaphores(&semaphores)
            .push_next(&mut timeline)];
        // SAFETY: only one thread submits: the one that holds the backend.
        unsafe { self.device.raw.queue_submit(self.device.queue, &info, vk::Fence::null()) }
            .map_err(during("submitting"))?;
        self.submitted = value;
        self.flying.push_back((value, recording));
        Ok(())
    }

    /// Waits until everything submitted is complete.
    pub(crate) fn wait(&mut self) -> Result<()> {
        self.wait_for(self.submitted)
    }

    fn wait_for(&mut self, value: u64) -> Result<()> {
        self.device.injection.alive()?;
        let (semaphores, values) = ([self.done], [value]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the semaphore is alive.
        unsafe { self.device.raw.wait_semaphores(&info, u64::MAX) }.map_err(during("waiting for the device"))?;
        while self.flying.front().is_some_and(|(flying, _)| *flying <= value) {
            self.idle.extend(self.flying.pop_front().map(|(_, recording)| recording));
        }
        Ok(())
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        // SAFETY: after the wait nothing is in flight; a lost device has nothing in flight either.
        unsafe {
            let _ = self.device.raw.device_wait_idle();
            self.device.raw.destroy_semaphore(self.done, None);
            self.device.raw.destroy_command_pool(self.pool, None);
        }
    }
}
