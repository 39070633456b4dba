//! How much a dispatch takes on.

/// Upper bounds on the work of one dispatch, so that none runs for seconds on a slow device, and on what
/// lies in memory between two of them. The picture is the same whatever they are: to the bit, but for the
/// rounding of sums over the rays of one query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DispatchLimits {
    /// Pixels that are looked at.
    pub pixels: u32,
    /// Queries that close ranks, 64 bytes each.
    pub places: u32,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Of them, those of one query.
    pub shadow_rays_of_query: u32,
    /// Rays of final gathering, 96 bytes each.
    pub gather_rays: u32,
    /// Of them, those of one query.
    pub gather_rays_of_query: u32,
}

impl Default for DispatchLimits {
    /// Large enough for a GPU to be busy. Rays of one query stay far below the 65 535 rounds of all
    /// loops together after which Mesa's software device leaves a kernel.
    fn default() -> Self {
        Self {
            pixels: 1 << 23,
            places: 1 << 20,
            shadow_rays: 1 << 25,
            shadow_rays_of_query: 256,
            gather_rays: 1 << 20,
            gather_rays_of_query: 1 << 14,
        }
    }
}
