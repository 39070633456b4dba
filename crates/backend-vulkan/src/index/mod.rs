//! Photon maps built on the device: the same slots in the same order as those of the CPU's index of the same
//! kind, bit for bit.

pub mod bench;
mod bounds;
mod lists;
mod map_storage;
mod median;
mod morton;
mod oversized_runs;
mod regular;
#[cfg(test)]
mod tests;
mod vvh;
mod vvh_nodes;

use photon_core::{IndexKind, KdTreeBuilder, Photon, PhotonFormat, Result, kd_tree};

use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Module};
use crate::map::VulkanMap;
use crate::vulkan::Vulkan;
use map_storage::MapStorage;
use median::Median;
use morton::Morton;
use regular::{Ordered, Regular};
use vvh::Vvh;
use vvh_nodes::VvhNodes;

/// Points per leaf, and children per node.
const WIDTH: u64 = kd_tree::WIDTH as u64;

specialized!(
    reading_constants: ReadingConstants => INDEX_ARRANGE INDEX_BOUNDS INDEX_CODES INDEX_KEYS INDEX_MEDIAN_FINISH
        INDEX_MEDIAN_SIDES INDEX_PICK INDEX_REFINE INDEX_VVH_FINISH INDEX_VVH_PLAN,
    2 format: PhotonFormat
);

/// The kernel of a module that reads photons of a format.
fn reading(on: &mut Vulkan, module: &'static Module, workgroup: u32, format: PhotonFormat) -> ComputePipeline {
    on.kernel(module, workgroup, &ReadingConstants { format })
}

/// Requests the kernels that read photons of a format; the others are requested when a builder is made.
pub(crate) fn announce(on: &mut Vulkan, kind: IndexKind, format: PhotonFormat) -> Result<()> {
    bounds::kernel(on, format);
    regular::kernel(on, format);
    match kind {
        IndexKind::Median => {
            lists::kernel(on, format);
            median::kernels(on, format);
        }
        IndexKind::Vvh => {
            lists::kernel(on, format);
            vvh::kernels(on, format);
        }
        IndexKind::Morton => {
            morton::kernels(on, format)?;
        }
    }
    Ok(())
}

/// Builds photon maps.
#[derive(Debug)]
pub(crate) struct VulkanBuilder {
    kind: IndexKind,
    arrange: Arrange,
    regular: Regular,
    /// Storage of reclaimed maps.
    spare: Vec<MapStorage>,
}

#[derive(Debug)]
enum Arrange {
    Median(Box<Median>),
    Morton(Box<Morton>),
    Vvh(Box<(Vvh, VvhNodes)>),
}

impl VulkanBuilder {
    /// # Errors
    /// Errors of the device.
    pub(crate) fn new(on: &mut Vulkan, kind: IndexKind) -> Result<Self> {
        let arrange = match kind {
            IndexKind::Median => Arrange::Median(Box::new(Median::new(on)?)),
            IndexKind::Vvh => Arrange::Vvh(Box::new((Vvh::new(on)?, VvhNodes::new(on)?))),
            IndexKind::Morton => Arrange::Morton(Box::new(Morton::new(on)?)),
        };
        Ok(Self { kind, arrange, regular: Regular::new(on), spare: Vec::new() })
    }
}

impl KdTreeBuilder<Vulkan> for VulkanBuilder {
    fn build(&mut self, on: &mut Vulkan, photons: VulkanBuffer<Photon>) -> Result<VulkanMap> {
        let length = on.length(&photons)?;
        let nodes = match self.kind {
            IndexKind::Vvh => VvhNodes::nodes(length),
            IndexKind::Median | IndexKind::Morton => Regular::nodes(length),
        };
        // The buffer is cleared as soon as its length is known, since reclaiming the map has no access to the
        // device.
        let words = [0, photons.capacity().min(u64::from(u32::MAX)) as u32, 0, 0];
        on.write(&photons.count, 0, bytemuck::cast_slice(&words))?;
        let mut storage = self.spare.pop().map_or_else(|| MapStorage::new(on), Ok)?;
        storage.grow(on, length, nodes, photons.photon_format())?;
        let order = match &mut self.arrange {
            Arrange::Median(median) => median.order(on, &photons, length)?,
            Arrange::Morton(morton) => morton.order(on, &photons, length)?,
            Arrange::Vvh(both) => both.0.order(on, &photons, length)?,
        };
        let ordered = Ordered { photons: &photons, length, order, storage: &storage };
        match &mut self.arrange {
            Arrange::Median(_) | Arrange::Morton(_) => self.regular.arrange(on, ordered)?,
            Arrange::Vvh(both) => {
                let (vvh, nodes) = &mut **both;
                nodes.arrange(on, &self.regular, ordered, vvh.splits.address())?;
            }
        }
        // The original photon buffer is reported separately.
        on.note_memory(&format!("map of {}", photons.label()), storage.bytes());
        let MapStorage { positions, power, ids, nodes: of_nodes, totals } = storage;
        Ok(VulkanMap {
            kind: self.kind,
            photons,
            length: length as u32,
            positions,
            power,
            ids,
            nodes: of_nodes,
            totals,
            node_count: nodes as u32,
        })
    }

    fn reclaim(&mut self, map: VulkanMap) -> VulkanBuffer<Photon> {
        let VulkanMap { mut photons, positions, power, ids, nodes, totals, .. } = map;
        self.spare.push(MapStorage { positions, power, ids, nodes, totals });
        // `build` has already cleared it on the device.
        photons.is_now(0);
        photons
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}
