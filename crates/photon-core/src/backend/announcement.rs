//! Needs of the passes of a picture.

use crate::backend::stages::{EstimateParams, View};
use crate::requirements::Requirements;
use crate::requirements::map_kind::MapKind;
use crate::requirements::map_place::MapPlace;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::settings::Settings;

/// Needs of the passes of a picture, as far as they are known before the scene is prepared.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Announcement<'a> {
    /// The scene.
    pub scene: &'a SceneView<'a>,
    /// The view, within the scene.
    pub view: View,
    /// The settings.
    pub settings: &'a Settings,
    /// Needs of scene and settings.
    pub required: &'a Requirements,
    /// Whether paths are aimed; a guess until it is known where to.
    pub is_aimed: bool,
    /// Whether radii are derived from a pilot pass.
    pub has_pilot: bool,
    /// The maps.
    pub maps: Vec<AnnouncedMap>,
}

/// A map of a pass.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct AnnouncedMap {
    /// Its kind.
    pub kind: MapKind,
    /// Place of its photons.
    pub place: MapPlace,
    /// Format of its photons.
    pub photon_format: PhotonFormat,
    /// Whether visible points are estimated from it directly.
    pub is_shown: bool,
    /// Parameters of its estimates; the radius is not known yet.
    pub gather: EstimateParams,
}
