//! How the tracing kernel goes about it.

/// How many invocations share paths, and how. The photons are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TracePlan {
    /// Invocations per workgroup, a power of two.
    pub group: u32,
    /// Invocations that share the paths of a stretch, unless it takes more for the quota's sake.
    pub threads: u64,
    /// Paths for each of them, if they were shared out evenly, at most.
    pub quota: u64,
    /// When fewer rays than this of a subgroup are under way, the others are seen to first; 0: when
    /// none is.
    pub busy: u32,
    /// Groups of nodes of each ray that wait in shared memory.
    pub shared_groups: u32,
    /// Surfaces that a path is followed for in one dispatch.
    pub surfaces: u32,
    /// Photons that are stored before they are put in order, 40 bytes each.
    pub places: u64,
}

impl TracePlan {
    /// For subgroups of so many invocations.
    pub(crate) fn for_subgroups(size: u32) -> Self {
        // As measured best on an NVIDIA H200, for paths through glass (4.4 ms a million) and through an
        // empty room (0.94 ms). Looking around for rays to replace never paid there. A processor runs
        // few invocations at a time, and is given few paths to each.
        let (quota, places) = if size >= 16 { (8, 1 << 23) } else { (4, 1 << 22) };
        Self { group: 64, threads: 1 << 17, quota, busy: 0, shared_groups: 0, surfaces: 16, places }
    }
}
