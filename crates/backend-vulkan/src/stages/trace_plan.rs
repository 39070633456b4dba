//! How the tracing kernel distributes paths over invocations.

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
    /// A plan for the given subgroup size.
    pub(crate) fn for_subgroups(size: u32) -> Self {
        // Measured as the fastest on an NVIDIA H200, for paths through glass (4.4 ms per million) and in an
        // empty room (0.94 ms). Replacing rays early never paid off there.
        let (threads, quota, surfaces, places) = if size >= 16 {
            (1 << 17, 8, 16, 1 << 23)
        } else {
            // A CPU (software device) runs all lanes of a subgroup until the last one ends, so that each gets several paths
            // even if there are few; for fewer surfaces, since its loops are limited.
            (1 << 10, 8, 8, 1 << 22)
        };
        Self { group: 64, threads, quota, busy: 0, shared_groups: 0, surfaces, places }
    }
}
