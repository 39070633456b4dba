//! Photon emission from the lights.

use photon_core::{Batch, Emitter, Features, PhotonRay, ProjectionMap, RandomKind, Result};

use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::scene::{SceneKind, VulkanScene};
use crate::shaders;
use crate::vulkan::Vulkan;

const GROUP: u32 = 128;

/// Emits photons, by [`photon_core::SceneView::light_cdf`].
#[derive(Debug)]
pub(crate) struct VulkanEmitter;

parameters! {
    struct Push => STAGES_EMIT {
        scene: u64,
        rays: u64,
        seed: [u32; 2],
        pass: u32,
        first: u32,
        count: u32,
        portal_count: u32,
        /// `ProjectionRef` of projection.glsl; 0 without a projection map.
        projection: u64,
        /// `PortalTable` of portals.glsl; 0 without portals.
        portals: u64,
    }
}

specialized!(
    emit_constants: EmitConstants => STAGES_EMIT,
    0 features: Features, 2 random: u32, 3 aimed: bool; default shared_groups
);

impl Emitter<Vulkan> for VulkanEmitter {
    fn emit(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &mut VulkanBuffer<PhotonRay>,
    ) -> Result<()> {
        emit(on, scene, batch, rays, 0)
    }
}

/// Emits photons towards specular surfaces, by a projection map.
#[derive(Debug)]
pub(crate) struct VulkanAimedEmitter {
    /// One `ProjectionRef`, which holds the addresses of the tables.
    record: Memory,
    _tables: [Memory; 3],
}

host_struct! {
    /// `ProjectionRef` of projection.glsl.
    struct ProjectionRef {
        targets: u64,
        starts: u64,
        cells: u64,
        count: u32,
        pad: u32,
    }
}

impl VulkanAimedEmitter {
    /// Uploads the tables of the projection map.
    ///
    /// # Errors
    /// [`photon_core::Error::OutOfMemory`].
    pub(crate) fn new(on: &mut Vulkan, projection: &ProjectionMap) -> Result<Self> {
        let mut table = |bytes: &[u8]| {
            let memory = on.memory("aimed photons", bytes.len() as u64)?;
            on.write(&memory, 0, bytes)?;
            Ok::<_, photon_core::Error>(memory)
        };
        let tables = [
            table(bytemuck::cast_slice(projection.targets()))?,
            table(bytemuck::cast_slice(projection.starts()))?,
            table(bytemuck::cast_slice(projection.cells()))?,
        ];
        let record = ProjectionRef {
            targets: tables[0].address(),
            starts: tables[1].address(),
            cells: tables[2].address(),
            count: projection.targets().len() as u32,
            pad: 0,
        };
        let record = table(bytemuck::bytes_of(&record))?;
        on.note_memory("aimed photons", projection.bytes());
        Ok(Self { record, _tables: tables })
    }

    /// Address of the projection map.
    pub(crate) fn address(&self) -> u64 {
        self.record.address()
    }
}

impl Emitter<Vulkan> for VulkanAimedEmitter {
    fn emit(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &mut VulkanBuffer<PhotonRay>,
    ) -> Result<()> {
        emit(on, scene, batch, rays, self.address())
    }
}

/// The kernel, for aimed paths or others.
pub(crate) fn kernel(on: &mut Vulkan, scene: &SceneKind, random: RandomKind, aimed: bool) -> ComputePipeline {
    let constants = EmitConstants { features: scene.features, random: random as u32, aimed };
    on.kernel(&shaders::STAGES_EMIT, GROUP, &constants)
}

/// Emits the paths of a batch, by the projection map at address `projection` unless that is 0.
fn emit(
    on: &mut Vulkan,
    scene: &VulkanScene,
    batch: &Batch,
    rays: &mut VulkanBuffer<PhotonRay>,
    projection: u64,
) -> Result<()> {
    let asked = batch.paths.len() as u64;
    let count = asked.min(rays.capacity());
    let pass = batch.pass;
    let kernel = kernel(on, &scene.kind, pass.random, projection != 0);
    let push = Push {
        scene: scene.address(),
        rays: rays.data_address(),
        seed: [pass.seed as u32, (pass.seed >> 32) as u32],
        pass: pass.index,
        first: batch.paths.start,
        count: count as u32,
        portal_count: scene.portals().1,
        projection,
        portals: scene.portals().0,
    };
    on.dispatch(&kernel, &push, count.div_ceil(u64::from(GROUP)))?;
    on.set_length(rays, asked)
}
