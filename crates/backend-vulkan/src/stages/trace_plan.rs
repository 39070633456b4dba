//! How the tracing kernel distributes paths over invocations.

use crate::device::Limits;

/// How many invocations share the paths, and how. The photons do not depend on it.
// Exhaustive: in `low_level`, which is not stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TracePlan {
    /// Invocations per workgroup, a power of two.
    pub group: u32,
    /// Invocations that share the paths of a chunk; more if the quota requires it.
    pub threads: u64,
    /// Maximum number of paths per invocation under an even distribution.
    pub quota: u64,
    /// When fewer rays of a subgroup than this are being traced, the finished ones are shaded or replaced
    /// first; 0: only when no ray is being traced.
    pub busy: u32,
    /// Entries of each ray's traversal stack (groups of nodes) that are held in shared memory.
    pub shared_groups: u32,
    /// Maximum number of surfaces of a path traced in one dispatch.
    pub surfaces: u32,
    /// Capacity of the scratch buffer for unordered photons, 40 bytes each.
    pub places: u64,
}

impl TracePlan {
    /// The plan for a device.
    pub(crate) fn of(limits: &Limits) -> Self {
        // Measured as the fastest on an NVIDIA H200, for paths through glass (4.4 ms per million) and in an
        // empty room (0.94 ms). Replacing rays early never paid off there.
        let (quota, places) = if limits.subgroup_size >= 16 { (8, 1 << 23) } else { (4, 1 << 22) };
        let plan = Self { group: 64, threads: 1 << 17, quota, busy: 0, shared_groups: 0, surfaces: 16, places };
        if limits.loop_turns == 0 {
            return plan;
        }
        // A CPU runs few lanes at a time: each takes several paths, so that few wait for the longest. Loops end after so many
        // turns that the surfaces of a dispatch must be few.
        Self { threads: 1 << 10, quota: 8, surfaces: 4, ..plan }
    }
}
