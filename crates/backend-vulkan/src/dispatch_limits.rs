//! Limits on the work of a dispatch.

use crate::device::Limits;

/// Upper bounds on the work of one dispatch, so that none runs for seconds on a slow device, and on the
/// intermediate results stored between two of them. The image does not depend on them: it is identical bit for
/// bit, except for the rounding of sums over the rays of one query.
// Exhaustive: in `low_level`, which is not stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DispatchLimits {
    /// Pixels whose camera paths are traced.
    pub pixels: u32,
    /// Pixels of camera samples that are traced together.
    pub pixels_of_samples: u32,
    /// Query slots that are compacted, 64 bytes each.
    pub places: u32,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Shadow rays of one query.
    pub shadow_rays_of_query: u32,
    /// Final-gather rays, 96 bytes each.
    pub gather_rays: u32,
    /// Final-gather rays of one query.
    pub gather_rays_of_query: u32,
}

impl Default for DispatchLimits {
    /// Large enough to keep a GPU busy. Rays of one query stay far below the 65 535 loop iterations in total
    /// after which Mesa's software device ends a kernel.
    fn default() -> Self {
        Self {
            pixels: 1 << 23,
            pixels_of_samples: 1 << 20,
            places: 1 << 20,
            shadow_rays: 1 << 25,
            shadow_rays_of_query: 256,
            gather_rays: 1 << 20,
            gather_rays_of_query: 1 << 14,
        }
    }
}

impl DispatchLimits {
    /// Those for a device.
    pub(crate) fn of(device: &Limits) -> Self {
        // A processor is busy with any number.
        let pixels_of_samples = if device.is_software() { 1 << 12 } else { 1 << 20 };
        Self { pixels_of_samples, ..Self::default() }
    }
}
