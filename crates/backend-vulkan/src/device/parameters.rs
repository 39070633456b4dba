//! Memory for the parameters of dispatches: written while they are recorded, read when the device executes them.

use std::sync::Arc;

use gpu_allocator::MemoryLocation;
use photon_core::Result;

use super::logical::Device;
use super::memory::Memory;

/// Size in bytes of a block: enough for the dispatches of most submissions.
const BLOCK: u64 = 64 << 10;
/// Distance in bytes between parameters: they share no line of a cache.
const ALIGNMENT: u64 = 64;

/// The parameters of all dispatches of one submission.
#[derive(Debug, Default)]
pub(crate) struct ParameterBlocks {
    blocks: Vec<Block>,
    /// Index of the block to write to, and number of bytes used there.
    next: (usize, u64),
}

#[derive(Debug)]
struct Block {
    memory: Memory,
    /// Whether the host writes to it directly. A device that has no memory of its own which the host can write to would
    /// read each parameter from the host's memory: there, commands write them.
    is_mapped: bool,
}

/// The location of parameters.
pub(crate) struct Place<'a> {
    pub(crate) address: u64,
    /// Buffer and offset that a command must write the parameters to, unless they are already there.
    pub(crate) unwritten: Option<(&'a Memory, u64)>,
}

impl ParameterBlocks {
    /// Forgets all parameters, which the device has read, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.next = (0, 0);
    }

    /// Finds room for parameters, and writes them there if the host can and `may_map`.
    pub(crate) fn place(&mut self, device: &Arc<Device>, parameters: &[u8], may_map: bool) -> Result<Place<'_>> {
        let bytes = parameters.len() as u64;
        if self.next.1 + bytes > BLOCK {
            self.next = (self.next.0 + 1, 0);
        }
        let (index, offset) = self.next;
        if index == self.blocks.len() {
            self.blocks.push(Block::new(device, may_map)?);
        }
        let block = &mut self.blocks[index];
        self.next.1 = (offset + bytes).next_multiple_of(ALIGNMENT);
        let address = block.memory.address() + offset;
        match block.memory.mapped().filter(|_| block.is_mapped) {
            Some(mapped) => {
                mapped[offset as usize..][..parameters.len()].copy_from_slice(parameters);
                Ok(Place { address, unwritten: None })
            }
            None => Ok(Place { address, unwritten: Some((&self.blocks[index].memory, offset)) }),
        }
    }
}

impl Block {
    fn new(device: &Arc<Device>, may_map: bool) -> Result<Self> {
        if may_map {
            let mut memory = Memory::new(device, "parameters", BLOCK, MemoryLocation::CpuToGpu)?;
            if memory.is_device_local() && memory.mapped().is_some() {
                return Ok(Self { memory, is_mapped: true });
            }
        }
        let memory = Memory::new(device, "parameters", BLOCK, MemoryLocation::GpuOnly)?;
        Ok(Self { memory, is_mapped: false })
    }
}
