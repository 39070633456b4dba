//! Faults on demand, for tests: memory that is not there, a device that is lost.

use std::sync::atomic::{AtomicU64, Ordering};

use photon_core::{Error, Result};

/// How many allocations and submissions there have been, and the first of each that fails.
#[derive(Debug)]
pub(crate) struct Injection {
    allocations: AtomicU64,
    submissions: AtomicU64,
    no_memory_at: AtomicU64,
    lost_at: AtomicU64,
}

impl Default for Injection {
    fn default() -> Self {
        let [allocations, submissions] = [0, 0].map(AtomicU64::new);
        let [no_memory_at, lost_at] = [u64::MAX, u64::MAX].map(AtomicU64::new);
        Self { allocations, submissions, no_memory_at, lost_at }
    }
}

impl Injection {
    /// From that allocation and that submission on, counted from the first of the device's, all fail.
    pub(crate) fn set(&self, no_memory_at: u64, lost_at: u64) {
        self.no_memory_at.store(no_memory_at, Ordering::Relaxed);
        self.lost_at.store(lost_at, Ordering::Relaxed);
    }

    /// Allocations and submissions so far.
    pub(crate) fn counts(&self) -> (u64, u64) {
        (self.allocations.load(Ordering::Relaxed), self.submissions.load(Ordering::Relaxed))
    }

    /// Counts an allocation, and says whether there is memory for it.
    pub(crate) fn allocate(&self) -> bool {
        self.allocations.fetch_add(1, Ordering::Relaxed) < self.no_memory_at.load(Ordering::Relaxed)
    }

    /// Counts a submission.
    pub(crate) fn submit(&self) -> Result<()> {
        let count = self.submissions.fetch_add(1, Ordering::Relaxed);
        if count < self.lost_at.load(Ordering::Relaxed) { Ok(()) } else { Err(Error::DeviceLost) }
    }

    /// Whether the device is still there: a lost one is not waited for either.
    pub(crate) fn alive(&self) -> Result<()> {
        let (_, submissions) = self.counts();
        if submissions <= self.lost_at.load(Ordering::Relaxed) { Ok(()) } else { Err(Error::DeviceLost) }
    }
}
