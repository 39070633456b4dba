//! The maps of a pipeline: one slot for each that is required.

use crate::backend::Backend;
use crate::backend::stages::EstimateParams;
use crate::error::Result;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::Photon;

/// The photons of one map, and how far they are searched.
pub(super) struct MapSlot<B: Backend> {
    pub(super) kind: MapKind,
    /// `None` before they are allocated, and while they are arranged in a map.
    pub(super) photons: Option<B::Buffer<Photon>>,
    /// Photons that there is room for.
    pub(super) capacity: u64,
    /// Of the first pass, normalised space.
    pub(super) radius: f32,
}

impl<B: Backend> MapSlot<B> {
    /// One for each map that is required, in their order, without memory; all with the same radius.
    pub(super) fn of(required: &PerMap<bool>, radius: f32) -> Vec<Self> {
        let slots = required.iter().filter(|(_, required)| **required);
        slots.map(|(kind, _)| Self { kind, photons: None, capacity: 0, radius }).collect()
    }

    /// A buffer for so many photons, in the place of what there was.
    pub(super) fn allocate(&mut self, on: &mut B, capacity: u64, photon_format: PhotonFormat) -> Result<()> {
        self.photons = None;
        self.capacity = capacity;
        self.photons = Some(on.alloc_photons(self.kind.label(), capacity, photon_format)?);
        Ok(())
    }
}

/// A map of the present pass.
pub(super) struct BuiltMap<B: Backend> {
    pub(super) kind: MapKind,
    pub(super) map: B::PhotonMap,
    /// Photons in it.
    pub(super) length: u64,
    /// How it is read.
    pub(super) gather: EstimateParams,
    /// Paths that filled it.
    pub(super) paths: u64,
}

/// Whether the last pass and the last restart ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// They did.
    Ready,
    /// The last pass ended in an error: its photons may be lost, and tallies hold paths that no film has.
    PassFailed,
    /// A restart ended in an error: what there is belongs to two pictures.
    RestartFailed,
}
