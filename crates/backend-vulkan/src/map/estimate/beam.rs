//! The beam radiance estimate: light that photons of a medium scatter along a segment.

use photon_core::{BeamEstimator, BeamParams, Estimate, Kernel, PhotonFormat, Query, Result};

use super::search::{MapSearch, Mode, Question, Weighting};
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::scene::{SceneKind, VulkanScene};
use crate::vulkan::Vulkan;

/// Estimates along segments.
#[derive(Debug, Default)]
pub(crate) struct VulkanBeamEstimator {
    search: MapSearch,
}

impl BeamEstimator<Vulkan> for VulkanBeamEstimator {
    fn estimate(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        map: &VulkanMap,
        segments: &VulkanBuffer<Query>,
        params: &BeamParams,
        estimates: &mut VulkanBuffer<Estimate>,
    ) -> Result<()> {
        map.photon_format().check_full("photons in media")?;
        let question = question(params.kernel, params.radius, &scene.kind, scene.address());
        let result = (estimates.data_address(), estimates.count_address(), estimates.capacity());
        // Segments of neighbouring pixels are close to each other already.
        self.search.ask(on, map, (segments, 0..segments.capacity()), &question, 0, result)?;
        estimates.touch();
        Ok(())
    }
}

/// The search in a scene at this address.
fn question(kernel: Kernel, radius: f32, scene: &SceneKind, address: u64) -> Question {
    Question {
        mode: Mode::Segment,
        kernel,
        filter: false,
        flat: false,
        shading: Weighting::Medium(address, scene.media),
        marked: false,
        k: 0,
        radius,
        min_cosine: -1.0,
        max_plane_distance: 0.0,
        parameter: 0.0,
        threshold: 0,
        error_moments: 0,
    }
}

/// Requests the kernel.
pub(crate) fn announce(on: &mut Vulkan, kernel: Kernel, scene: &SceneKind) {
    MapSearch::default().kernel(on, &question(kernel, 1.0, scene, 0), PhotonFormat::Full, false);
}
