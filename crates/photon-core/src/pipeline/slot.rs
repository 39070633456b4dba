//! The maps of a pipeline: one slot per required map.

use crate::backend::Backend;
use crate::backend::stages::EstimateParams;
use crate::error::Result;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::Photon;

/// The photons of one map, and its search radius.
pub(super) struct MapSlot<B: Backend> {
    pub(super) kind: MapKind,
    /// `None` before allocation, and while the photons are in a map.
    pub(super) photons: Option<B::Buffer<Photon>>,
    /// Maximum number of photons.
    pub(super) capacity: u64,
    /// Radius of the first pass, normalised space.
    pub(super) radius: f32,
}

impl<B: Backend> MapSlot<B> {
    /// One slot per required map, in order, without memory; all with the same radius.
    pub(super) fn of(required: &PerMap<bool>, radius: f32) -> Vec<Self> {
        let slots = required.iter().filter(|(_, required)| **required);
        slots.map(|(kind, _)| Self { kind, photons: None, capacity: 0, radius }).collect()
    }

    /// Replaces the buffer by one for `capacity` photons.
    pub(super) fn allocate(&mut self, on: &mut B, capacity: u64, photon_format: PhotonFormat) -> Result<()> {
        self.photons = None;
        self.capacity = capacity;
        self.photons = Some(on.alloc_photons(self.kind.label(), capacity, photon_format)?);
        Ok(())
    }
}

/// A map of the current pass.
pub(super) struct BuiltMap<B: Backend> {
    pub(super) kind: MapKind,
    pub(super) map: B::PhotonMap,
    /// Number of photons.
    pub(super) length: u64,
    /// Its estimate parameters.
    pub(super) gather: EstimateParams,
    /// Number of paths that filled it.
    pub(super) paths: u64,
}

/// Whether the last pass and the last restart succeeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Both succeeded.
    Ready,
    /// The last pass failed: its photons may be lost, and tallies contain paths that are in no film.
    PassFailed,
    /// A restart failed: the state is a mix of two pictures.
    RestartFailed,
}
