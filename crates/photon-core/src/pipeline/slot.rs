//! The maps of a pipeline: one slot per required map.

use super::estimate::is_shown;
use crate::backend::Backend;
use crate::backend::stages::EstimateParams;
use crate::error::Result;
use crate::requirements::Requirements;
use crate::requirements::map_kind::MapKind;
use crate::requirements::map_place::MapPlace;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::Photon;
use crate::settings::Settings;

/// The photons of one map, and its search radius.
pub(super) struct MapSlot<B: Backend> {
    pub(super) kind: MapKind,
    pub(super) place: MapPlace,
    /// `None` before allocation, and while the photons are in a map.
    pub(super) photons: Option<B::Buffer<Photon>>,
    /// Maximum number of photons.
    pub(super) capacity: u64,
    /// Radius of the first pass, normalised space.
    pub(super) radius: f32,
    /// The larger of which it is, if it is derived: a radius by the density of photons, and the least for the pixels.
    pub(super) derived: Option<(f32, f32)>,
}

impl<B: Backend> MapSlot<B> {
    /// One slot per required map on surfaces, in order; then one for caustics in reflections, those in media that are shown, and
    /// one for light from media where final gathering does not find it, if there are such stages. Without memory, and all with
    /// the same radius.
    pub(super) fn of(
        settings: &Settings,
        required: &Requirements,
        (reflects, has_media): (bool, bool),
        radius: f32,
    ) -> Vec<Self> {
        let maps = || required.maps.iter().filter(|(_, required)| **required).map(|(kind, _)| kind);
        // Light straight from a light source is found by shadow rays in media.
        let is_seen = |kind| has_media && kind != MapKind::Direct && is_shown(settings, kind, MapPlace::Medium);
        let in_media = maps().filter(|&kind| is_seen(kind));
        let all = maps().map(|kind| (kind, MapPlace::Surface));
        let all = all.chain(reflects.then_some((MapKind::Caustic, MapPlace::Reflection)));
        let all = all.chain(in_media.map(|kind| (kind, MapPlace::Medium)));
        let is_apart = has_media && required.final_gather;
        let all = all.chain(is_apart.then_some((MapKind::Global, MapPlace::FromMedium)));
        all.map(|(kind, place)| Self { kind, place, photons: None, capacity: 0, radius, derived: None }).collect()
    }

    /// Photon format of the map, where those on surfaces have `format`.
    pub(super) fn photon_format(&self, format: PhotonFormat) -> PhotonFormat {
        match self.place {
            MapPlace::Surface | MapPlace::FromMedium => format,
            MapPlace::Reflection | MapPlace::Medium => PhotonFormat::Full,
        }
    }

    /// Replaces the buffer by one for `capacity` photons; `photon_format` is that of maps on surfaces.
    pub(super) fn allocate(&mut self, on: &mut B, capacity: u64, photon_format: PhotonFormat) -> Result<()> {
        let photon_format = self.photon_format(photon_format);
        self.photons = None;
        self.capacity = capacity;
        self.photons = Some(on.alloc_photons(self.label(), capacity, photon_format)?);
        Ok(())
    }

    /// Label of its buffer, in reports and errors.
    pub(super) fn label(&self) -> &'static str {
        match (self.place, self.kind) {
            (MapPlace::Surface, kind) => kind.label(),
            (MapPlace::Reflection, _) => "photons: caustic, reflected",
            (MapPlace::Medium, MapKind::Caustic) => "photons: caustic, in media",
            (MapPlace::Medium, _) => "photons: global, in media",
            (MapPlace::FromMedium, _) => "photons: global, from media",
        }
    }
}

/// A map of the current pass.
pub(super) struct BuiltMap<B: Backend> {
    pub(super) kind: MapKind,
    pub(super) place: MapPlace,
    pub(super) map: B::PhotonMap,
    /// Number of photons.
    pub(super) length: u64,
    /// Its estimate parameters; in media the search radius and the kernel count.
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
