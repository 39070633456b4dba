//! `Backend` for Vulkan: buffers, map stages and timings.

use photon_core::{
    Backend, Element, Error, Fill, IndexKind, KdTreeBuilder, MapStages, Photon, PhotonFormat, Result, Stage,
    StageTimings,
};

use crate::device::buffer::VulkanBuffer;
use crate::index::VulkanBuilder;
use crate::map::VulkanMap;
use crate::map::estimate::VulkanEstimator;
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

    fn alloc_photons(
        &mut self,
        label: &'static str,
        capacity: u64,
        photon_format: PhotonFormat,
    ) -> Result<VulkanBuffer<Photon>> {
        VulkanBuffer::photons(self, label, capacity, photon_format)
    }

    fn upload<T: Element>(&mut self, label: &'static str, data: &[T]) -> Result<VulkanBuffer<T>> {
        let mut buffer = VulkanBuffer::new(self, label, data.len() as u64)?;
        self.write(&buffer.data, 0, bytemuck::cast_slice(data))?;
        self.set_length(&mut buffer, data.len() as u64)?;
        buffer.foreign = true;
        Ok(buffer)
    }

    fn download<T: Element>(&mut self, from: &VulkanBuffer<T>, to: &mut Vec<T>) -> Result<()> {
        let Fill { length, needed, capacity } = Backend::fill(self, from)?;
        if needed > capacity {
            return Err(Error::CapacityExceeded { label: from.label(), needed, capacity });
        }
        from.photon_format().check_full(from.label())?;
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

    fn map_stages(&mut self, index: IndexKind) -> Result<MapStages<Self>> {
        Ok(MapStages {
            builder: Box::new(CheckedBuilder(VulkanBuilder::new(self, index)?)),
            estimator: Box::new(VulkanEstimator::default()),
        })
    }

    fn mark(&mut self, stage: Option<Stage>) {
        if let Err(error) = self.profile.mark(&mut self.recorder, stage) {
            self.fault.get_or_insert(error);
        }
    }

    fn timings(&mut self) -> Result<StageTimings> {
        let mut timings = self.profile.take(&mut self.recorder)?;
        timings.add(Stage::Compile, self.compile_seconds());
        self.surface()?;
        Ok(timings)
    }
}

/// Builds maps and validates photons supplied by the caller. That costs a wait, which photons of the backend's
/// own tracer, always finite, do not need.
struct CheckedBuilder(VulkanBuilder);

impl KdTreeBuilder<Vulkan> for CheckedBuilder {
    fn build(&mut self, on: &mut Vulkan, photons: VulkanBuffer<Photon>) -> Result<VulkanMap> {
        let foreign = photons.foreign;
        let map = self.0.build(on, photons)?;
        if foreign {
            map.check(on)?;
        }
        Ok(map)
    }

    fn reclaim(&mut self, map: VulkanMap) -> VulkanBuffer<Photon> {
        self.0.reclaim(map)
    }

    fn required_format(&self) -> PhotonFormat {
        self.0.required_format()
    }
}

impl Vulkan {
    /// Returns the error that a method without a `Result` deferred, if any.
    fn surface(&mut self) -> Result<()> {
        self.fault.take().map_or(Ok(()), Err)
    }
}
