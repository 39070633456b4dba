//! Photons leave the lights.

use bytemuck::{Pod, Zeroable};
use photon_core::{Batch, Emitter, PhotonRay, Result};

use super::random_number;
use crate::buffer::VulkanBuffer;
use crate::scene::VulkanScene;
use crate::shaders;
use crate::vulkan::Vulkan;

const GROUP: u32 = 128;

/// Sends photons out in proportion to the power of the lights.
#[derive(Debug)]
pub(crate) struct VulkanEmitter;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Push {
    scene: u64,
    rays: u64,
    seed: [u32; 2],
    pass: u32,
    first: u32,
    count: u32,
    pad: u32,
}

impl Emitter<Vulkan> for VulkanEmitter {
    fn emit(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &mut VulkanBuffer<PhotonRay>,
    ) -> Result<()> {
        let asked = batch.paths.len() as u64;
        let count = asked.min(rays.capacity());
        let pass = batch.pass;
        let kernel =
            on.kernel(&shaders::PHOTONS_EMIT, &[scene.features().bits(), GROUP, random_number(pass.random)])?;
        let push = Push {
            scene: scene.address(),
            rays: rays.data_address(),
            seed: [pass.seed as u32, (pass.seed >> 32) as u32],
            pass: pass.index,
            first: batch.paths.start,
            count: count as u32,
            pad: 0,
        };
        on.dispatch(&kernel, &push, count.div_ceil(u64::from(GROUP)))?;
        on.set_length(rays, asked)
    }
}
