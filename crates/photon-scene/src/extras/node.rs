//! Extras of lights and cameras.

use serde::{Deserialize, Serialize};

use super::exact::{Exact, Triple, exact, plain};
use crate::describe::{CameraDesc, LightDesc, Projection, ThinLens};

/// Extras of a node that holds a light or a camera.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct NodeExtras {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) light: Option<LightExtras>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) camera: Option<CameraExtras>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum LightExtras {
    Point { position: Triple, intensity: Triple },
    Spot { position: Triple, direction: Triple, intensity: Triple, inner_angle: Exact, outer_angle: Exact },
    Directional { direction: Triple, irradiance: Triple },
}

impl LightExtras {
    pub(crate) fn new(desc: &LightDesc) -> Self {
        match *desc {
            LightDesc::Point { position, intensity } => {
                Self::Point { position: exact(position), intensity: exact(intensity) }
            }
            LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle } => Self::Spot {
                position: exact(position),
                direction: exact(direction),
                intensity: exact(intensity),
                inner_angle: Exact(inner_angle),
                outer_angle: Exact(outer_angle),
            },
            LightDesc::Directional { direction, irradiance } => {
                Self::Directional { direction: exact(direction), irradiance: exact(irradiance) }
            }
        }
    }

    pub(crate) fn desc(self) -> LightDesc {
        match self {
            Self::Point { position, intensity } => {
                LightDesc::Point { position: plain(position), intensity: plain(intensity) }
            }
            Self::Spot { position, direction, intensity, inner_angle, outer_angle } => LightDesc::Spot {
                position: plain(position),
                direction: plain(direction),
                intensity: plain(intensity),
                inner_angle: inner_angle.0,
                outer_angle: outer_angle.0,
            },
            Self::Directional { direction, irradiance } => {
                LightDesc::Directional { direction: plain(direction), irradiance: plain(irradiance) }
            }
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraExtras {
    position: Triple,
    direction: Triple,
    up: Triple,
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical_fov: Option<Exact>,
    #[serde(skip_serializing_if = "Option::is_none")]
    half_height: Option<Exact>,
    /// Diameter and focus distance of the lens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lens: Option<[Exact; 2]>,
}

impl CameraExtras {
    pub(crate) fn new(desc: &CameraDesc) -> Self {
        let CameraDesc { position, direction, up, projection, lens } = *desc;
        let (vertical_fov, half_height) = match projection {
            Projection::Perspective { vertical_fov } => (Some(Exact(vertical_fov)), None),
            Projection::Orthographic { half_height } => (None, Some(Exact(half_height))),
        };
        let (position, direction, up) = (exact(position), exact(direction), exact(up));
        let lens = lens.map(|lens| [lens.diameter, lens.focus_distance].map(Exact));
        Self { position, direction, up, vertical_fov, half_height, lens }
    }

    /// The camera; `None` without a projection, or with two.
    pub(crate) fn desc(self) -> Option<CameraDesc> {
        let projection = match (self.vertical_fov, self.half_height) {
            (Some(fov), None) => Projection::Perspective { vertical_fov: fov.0 },
            (None, Some(half_height)) => Projection::Orthographic { half_height: half_height.0 },
            _ => return None,
        };
        let (position, direction, up) = (plain(self.position), plain(self.direction), plain(self.up));
        let lens = self.lens.map(|[diameter, focus]| ThinLens { diameter: diameter.0, focus_distance: focus.0 });
        Some(CameraDesc { position, direction, up, projection, lens })
    }
}
