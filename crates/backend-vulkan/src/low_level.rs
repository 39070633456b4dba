//! Tuning, measurement and fault injection, for benchmarks and tests.
//!
//! What is here depends on how kernels are written, and may change in any release. Pictures do not depend on it,
//! except where faults are injected.

use photon_core::{Hit, RadianceEstimator, Ray, Result};

use crate::scene::VulkanScene;
use crate::vulkan::Vulkan;

pub use crate::dispatch_limits::DispatchLimits;
pub use crate::index::bench as index_bench;
pub use crate::rays::RayPlan;
pub use crate::stages::TracePlan;

/// Opens a device for a test, with validation enabled; dropping it panics if the layer has reported anything.
/// Returns `None`, with a message on standard error, where there is no Vulkan. `PHOTON_VALIDATION=0` disables the
/// layer, for machines that have a GPU but not the layer.
///
/// # Panics
///
/// If there is no Vulkan, but `PHOTON_REQUIRE_VULKAN` is set to anything but 0.
#[must_use]
pub fn for_tests() -> Option<Vulkan> {
    Vulkan::for_tests()
}

/// How photons are traced.
#[must_use]
pub fn trace_plan(on: &Vulkan) -> TracePlan {
    on.trace_plan
}

/// Sets how photons are traced by stages that are created from now on; the photons do not depend on it.
pub fn set_trace_plan(on: &mut Vulkan, plan: TracePlan) {
    on.trace_plan = plan;
}

/// Sets how much work a dispatch does.
pub fn set_dispatch_limits(on: &mut Vulkan, limits: DispatchLimits) {
    on.dispatch_limits = limits;
}

/// As [`Vulkan::cast_rays`], with an explicit plan.
///
/// # Errors
/// As [`Vulkan::cast_rays`].
pub fn cast_rays(on: &mut Vulkan, scene: &VulkanScene, rays: &[Ray], plan: RayPlan) -> Result<Vec<Option<Hit>>> {
    on.cast_rays_by(scene, rays, plan)
}

/// Device time in seconds for the nearest hits of all rays: for each plan, `rounds` measurements.
///
/// # Errors
/// As [`Vulkan::cast_rays`].
pub fn time_rays(
    on: &mut Vulkan,
    scene: &VulkanScene,
    rays: &[Ray],
    plans: &[RayPlan],
    rounds: u32,
) -> Result<Vec<Vec<f64>>> {
    on.time_rays(scene, rays, plans, rounds)
}

/// An estimator that never sorts queries, however many there are: the baseline for measuring the gain of sorting.
#[must_use]
pub fn estimator_without_sorting() -> Box<dyn RadianceEstimator<Vulkan>> {
    crate::map::estimate::estimator_without_sorting()
}

/// Makes every memory allocation from number `no_memory_at` on, and every submission from number `lost_at` on, fail
/// as if memory were exhausted and the device lost; `None`: none fails. Both are counted from when the device was
/// opened: see [`work_so_far`].
pub fn inject_faults(on: &Vulkan, no_memory_at: Option<u64>, lost_at: Option<u64>) {
    on.device.injection.set(no_memory_at.unwrap_or(u64::MAX), lost_at.unwrap_or(u64::MAX));
}

/// Numbers of allocations and of submissions since the device was opened.
#[must_use]
pub fn work_so_far(on: &Vulkan) -> (u64, u64) {
    on.device.injection.counts()
}
