//! What every backend can do.

use photon_core::{Backend, Element, Error, Fill, IndexKind, MapStages, Result, Stage, StageTimings};

use crate::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::vulkan::Vulkan;

impl Backend for Vulkan {
    type Buffer<T: Element> = VulkanBuffer<T>;
    type PhotonMap = VulkanMap;

    fn name(&self) -> &'static str {
        "vulkan"
    }

    fn device(&self) -> String {
        format!("{}, {}", self.limits().name, self.limits().driver)
    }

    fn alloc<T: Element>(&mut self, label: &'static str, capacity: u64) -> Result<VulkanBuffer<T>> {
        VulkanBuffer::new(self, label, capacity)
    }

    fn upload<T: Element>(&mut self, label: &'static str, data: &[T]) -> Result<VulkanBuffer<T>> {
        let mut buffer = VulkanBuffer::new(self, label, data.len() as u64)?;
        self.write(&buffer.data, 0, bytemuck::cast_slice(data))?;
        self.set_length(&mut buffer, data.len() as u64)?;
        Ok(buffer)
    }

    fn download<T: Element>(&mut self, from: &VulkanBuffer<T>, to: &mut Vec<T>) -> Result<()> {
        let Fill { length, needed, capacity } = Backend::fill(self, from)?;
        if needed > capacity {
            return Err(Error::CapacityExceeded { label: from.label(), needed, capacity });
        }
        to.clear();
        to.resize(length as usize, bytemuck::Zeroable::zeroed());
        self.read(&from.data, 0, bytemuck::cast_slice_mut(to))?;
        self.surface()
    }

    fn fill<T: Element>(&mut self, buffer: &VulkanBuffer<T>) -> Result<Fill> {
        let needed = self.needed(buffer)?;
        self.surface()?;
        Ok(Fill { length: needed.min(buffer.capacity()), needed, capacity: buffer.capacity() })
    }

    fn clear<T: Element>(&mut self, buffer: &mut VulkanBuffer<T>) -> Result<()> {
        self.set_length(buffer, 0)
    }

    fn map_stages(&mut self, _index: IndexKind) -> Result<MapStages<Self>> {
        Err(Error::Backend { backend: "vulkan: photon maps are being written", source: "not yet".into() })
    }

    fn mark(&mut self, stage: Option<Stage>) {
        if let Err(error) = self.profile.mark(&mut self.recorder, stage) {
            self.fault.get_or_insert(error);
        }
    }

    fn timings(&mut self) -> Result<StageTimings> {
        let timings = self.profile.take(&mut self.recorder)?;
        self.surface()?;
        Ok(timings)
    }
}

impl Vulkan {
    /// An error that was found where none could be returned.
    fn surface(&mut self) -> Result<()> {
        self.fault.take().map_or(Ok(()), Err)
    }
}
