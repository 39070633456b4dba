//! The beam radiance estimate: light that photons of a medium scatter along a segment.

use photon_core::{BeamEstimator, BeamParams, EstimateBuffers, Kernel, PhotonFormat, Query, Result};

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
        buffers: EstimateBuffers<'_, Vulkan>,
    ) -> Result<()> {
        map.photon_format().check_full("photons in media")?;
        let EstimateBuffers { estimates, error_moments } = buffers;
        let mut question = question(params.kernel, params.radius, &scene.kind, scene.address());
        let mut capacity = estimates.capacity();
        if let Some(moments) = &error_moments {
            question.error_moments = moments.data_address();
            capacity = capacity.min(moments.capacity());
        }
        let result = (estimates.data_address(), estimates.count_address(), capacity);
        // Segments of neighbouring pixels are close to each other already.
        self.search.ask(on, map, (segments, 0..segments.capacity()), &question, 0, result)?;
        estimates.touch();
        let Some(moments) = error_moments else { return Ok(()) };
        let count = on.length(segments)?.min(capacity);
        on.set_length(moments, count)
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

/// Requests the kernel, with or without moments of errors.
pub(crate) fn announce(on: &mut Vulkan, kernel: Kernel, scene: &SceneKind, moments: bool) {
    let question = Question { error_moments: moments.into(), ..question(kernel, 1.0, scene, 0) };
    MapSearch::default().kernel(on, &question, PhotonFormat::Full, false);
}
