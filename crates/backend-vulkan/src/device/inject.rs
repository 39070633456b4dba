//! Fault injection for tests: exhausted memory, a lost device.

use std::sync::atomic::{AtomicU64, Ordering};

use photon_core::{Error, Result};

/// Counts of allocations and submissions, and the first of each that fails.
#[derive(Debug)]
pub(crate) struct Injection {
    allocations: AtomicU64,
    submissions: AtomicU64,
    no_memory_at: AtomicU64,
    lost_at: AtomicU64,
    #[cfg(test)]
    refuses_kernels: std::sync::atomic::AtomicBool,
}

impl Default for Injection {
    fn default() -> Self {
        let [allocations, submissions] = [0, 0].map(AtomicU64::new);
        let [no_memory_at, lost_at] = [u64::MAX, u64::MAX].map(AtomicU64::new);
        Self {
            allocations,
            submissions,
            no_memory_at,
            lost_at,
            #[cfg(test)]
            refuses_kernels: std::sync::atomic::AtomicBool::default(),
        }
    }
}

impl Injection {
    /// All allocations and submissions from these numbers on fail, counted since the device was opened.
    pub(crate) fn set(&self, no_memory_at: u64, lost_at: u64) {
        self.no_memory_at.store(no_memory_at, Ordering::Relaxed);
        self.lost_at.store(lost_at, Ordering::Relaxed);
    }

    /// Number of allocations and submissions so far.
    pub(crate) fn counts(&self) -> (u64, u64) {
        (self.allocations.load(Ordering::Relaxed), self.submissions.load(Ordering::Relaxed))
    }

    /// Counts an allocation; false if it must fail.
    pub(crate) fn allocate(&self) -> bool {
        self.allocations.fetch_add(1, Ordering::Relaxed) < self.no_memory_at.load(Ordering::Relaxed)
    }

    /// Counts a submission; an error if it must fail.
    pub(crate) fn submit(&self) -> Result<()> {
        let count = self.submissions.fetch_add(1, Ordering::Relaxed);
        if count < self.lost_at.load(Ordering::Relaxed) { Ok(()) } else { Err(Error::DeviceLost) }
    }

    /// An error if the device counts as lost: a lost device is not waited for either.
    pub(crate) fn alive(&self) -> Result<()> {
        let (_, submissions) = self.counts();
        if submissions <= self.lost_at.load(Ordering::Relaxed) { Ok(()) } else { Err(Error::DeviceLost) }
    }

    /// Whether kernels fail to compile from now on.
    #[cfg(test)]
    pub(crate) fn refuse_kernels(&self, refuse: bool) {
        self.refuses_kernels.store(refuse, Ordering::SeqCst);
    }

    /// An error if a kernel must fail to compile.
    #[cfg(test)]
    pub(crate) fn compile(&self) -> std::result::Result<(), ash::vk::Result> {
        let refuses = self.refuses_kernels.load(Ordering::SeqCst);
        if refuses { Err(ash::vk::Result::ERROR_INVALID_SHADER_NV) } else { Ok(()) }
    }
}
