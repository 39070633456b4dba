//! The contents of `extras.photonmap` in glTF files written by this crate: the numbers of a scene in double precision,
//! and properties that glTF cannot express.
//!
//! ```json
//! "materials": [{ …, "extras": { "photonmap": { "kind": "glass", "ior": "1.5", "tint": ["1.0", "1.0", "1.0"], … } } }],
//! "nodes":     [{ …, "extras": { "photonmap": { "camera": { "position": ["0.0", "1.0", "3.2"], … } } } }],
//! "meshes":    [{ "primitives": [{ …, "extras": { "photonmap": { "positions": 2 } } }] }]
//! ```
//!
//! Numbers are decimal strings, since JSON readers may round numbers. `positions` is the index of a buffer view
//! with three 64-bit floats per vertex; `normals`, `tangents`, `colors` and `uvs` are such views too. `floats` of an image
//! is the view with its texels as four 32-bit floats each, of which the PNG is an approximation. The extras only refine the standard glTF content: if another program changes a
//! scene but keeps the extras, its changes take precedence, see [`Agrees`].

mod agrees;
pub(crate) mod standard;
mod texture;

use std::collections::BTreeMap;
use std::str::FromStr;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) use self::agrees::Agrees;
pub(crate) use self::texture::{ImageExtras, TexturesExtras, agreeing_floats, fallback};
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Projection, Surface, ThinLens};
use crate::texture::TexturesDesc;

/// An f64 that is serialized without loss, as a string.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exact(pub(crate) f64);

impl Default for Exact {
    fn default() -> Self {
        Self(0.0)
    }
}

impl Exact {
    /// Whether it need not be written.
    fn is_zero(&self) -> bool {
        self.0.to_bits() == 0
    }
}

impl Serialize for Exact {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The shortest text that parses to the same number.
        serializer.collect_str(&format_args!("{:?}", self.0))
    }
}

impl<'de> Deserialize<'de> for Exact {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        f64::from_str(&text).map(Self).map_err(|why| D::Error::custom(format!("{text:?}: {why}")))
    }
}

type Triple = [Exact; 3];

fn exact(values: [f64; 3]) -> Triple {
    values.map(Exact)
}

fn plain(values: Triple) -> [f64; 3] {
    values.map(|value| value.0)
}

/// The extras of one object, parts of which may belong to other programs.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Extras<T> {
    pub(crate) photonmap: T,
}

/// Extras of a material.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum MaterialExtras {
    Lambert {
        albedo: Triple,
        emission: Triple,
        emits_both_sides: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        textures: Option<TexturesExtras>,
        /// Weight and roughness.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clearcoat: Option<[Exact; 2]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        diffuse_transmission: Option<TransmissionExtras>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sheen: Option<SheenExtras>,
    },
    Mirror {
        albedo: Triple,
        emission: Triple,
        emits_both_sides: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        textures: Option<TexturesExtras>,
        /// Weight and roughness.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clearcoat: Option<[Exact; 2]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sheen: Option<SheenExtras>,
    },
    Glass {
        ior: Exact,
        absorption: Triple,
        tint: Triple,
        #[serde(default, skip_serializing_if = "Exact::is_zero")]
        roughness: Exact,
        #[serde(default)]
        priority: u32,
        emission: Triple,
        emits_both_sides: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        textures: Option<TexturesExtras>,
    },
    Thin {
        ior: Exact,
        tint: Triple,
        #[serde(default, skip_serializing_if = "Exact::is_zero")]
        roughness: Exact,
        emission: Triple,
        emits_both_sides: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        textures: Option<TexturesExtras>,
    },
    Glossy {
        albedo: Triple,
        metallic: Exact,
        roughness: Exact,
        specular: Exact,
        ior: Exact,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        specular_color: Option<Triple>,
        emission: Triple,
        emits_both_sides: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        textures: Option<TexturesExtras>,
        /// Weight and roughness.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clearcoat: Option<[Exact; 2]>,
        /// Strength and rotation.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        anisotropy: Option<[Exact; 2]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        diffuse_transmission: Option<TransmissionExtras>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sheen: Option<SheenExtras>,
    },
}

/// Diffuse transmission: share and colour.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TransmissionExtras {
    factor: Exact,
    color: Triple,
}

impl TransmissionExtras {
    fn new(desc: &MaterialDesc) -> Option<Self> {
        let color = exact(desc.diffuse_transmission_color);
        (desc.diffuse_transmission > 0.0).then_some(Self { factor: Exact(desc.diffuse_transmission), color })
    }
}

/// Sheen: colour and roughness.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SheenExtras {
    color: Triple,
    roughness: Exact,
}

impl SheenExtras {
    fn new(desc: &MaterialDesc) -> Option<Self> {
        let found = Self { color: exact(desc.sheen_color), roughness: Exact(desc.sheen_roughness) };
        (desc.sheen_color != [0.0; 3]).then_some(found)
    }
}

impl MaterialExtras {
    pub(crate) fn new(desc: &MaterialDesc) -> Self {
        let MaterialDesc { surface, emission, emits_both_sides, priority, textures, .. } = desc;
        let textures = TexturesExtras::new(textures);
        let clearcoat = (desc.clearcoat > 0.0).then_some([Exact(desc.clearcoat), Exact(desc.clearcoat_roughness)]);
        let (diffuse_transmission, sheen) = (TransmissionExtras::new(desc), SheenExtras::new(desc));
        let (emission, emits_both_sides) = (exact(*emission), *emits_both_sides);
        match *surface {
            Surface::Lambert { albedo } => {
                let albedo = exact(albedo);
                Self::Lambert { albedo, emission, emits_both_sides, textures, clearcoat, diffuse_transmission, sheen }
            }
            Surface::Mirror { reflectance } => {
                Self::Mirror { albedo: exact(reflectance), emission, emits_both_sides, textures, clearcoat, sheen }
            }
            Surface::Dielectric { ior, absorption, tint, roughness } => Self::Glass {
                ior: Exact(ior),
                absorption: exact(absorption),
                tint: exact(tint),
                roughness: Exact(roughness),
                priority: *priority,
                emission,
                emits_both_sides,
                textures,
            },
            Surface::Thin { ior, tint, roughness } => Self::Thin {
                ior: Exact(ior),
                tint: exact(tint),
                roughness: Exact(roughness),
                emission,
                emits_both_sides,
                textures,
            },
            Surface::Glossy { base_color, metallic, roughness, specular, ior } => Self::Glossy {
                albedo: exact(base_color),
                metallic: Exact(metallic),
                roughness: Exact(roughness),
                specular: Exact(specular),
                ior: Exact(ior),
                clearcoat,
                anisotropy: (desc.anisotropy > 0.0)
                    .then_some([Exact(desc.anisotropy), Exact(desc.anisotropy_rotation)]),
                diffuse_transmission,
                sheen,
                specular_color: (desc.specular_color != [1.0; 3]).then(|| exact(desc.specular_color)),
                emission,
                emits_both_sides,
                textures,
            },
        }
    }

    /// The material, if its textures agree with those of the file.
    pub(crate) fn desc(self, name: String, found: TexturesDesc) -> Option<MaterialDesc> {
        let (Self::Lambert { textures, .. }
        | Self::Mirror { textures, .. }
        | Self::Glass { textures, .. }
        | Self::Thin { textures, .. }
        | Self::Glossy { textures, .. }) = &self;
        let textures = textures.as_ref().map_or(Some(found), |textures| textures.refine(found))?;
        // Priority applies only to solids.
        let priority = if let Self::Glass { priority, .. } = self { priority } else { 0 };
        let [clearcoat, clearcoat_roughness] = match &self {
            Self::Lambert { clearcoat: Some(both), .. }
            | Self::Mirror { clearcoat: Some(both), .. }
            | Self::Glossy { clearcoat: Some(both), .. } => both.map(|value| value.0),
            _ => [0.0; 2],
        };
        let [anisotropy, rotation] = match &self {
            Self::Glossy { anisotropy: Some(both), .. } => both.map(|value| value.0),
            _ => [0.0; 2],
        };
        let (share, color) = match &self {
            Self::Lambert { diffuse_transmission: Some(found), .. }
            | Self::Glossy { diffuse_transmission: Some(found), .. } => (found.factor.0, plain(found.color)),
            _ => (0.0, [1.0; 3]),
        };
        let (sheen_color, sheen_roughness) = match &self {
            Self::Lambert { sheen: Some(found), .. }
            | Self::Mirror { sheen: Some(found), .. }
            | Self::Glossy { sheen: Some(found), .. } => (plain(found.color), found.roughness.0),
            _ => ([0.0; 3], 0.0),
        };
        let specular_color = match &self {
            Self::Glossy { specular_color: Some(color), .. } => plain(*color),
            _ => [1.0; 3],
        };
        let (surface, emission, emits_both_sides) = match self {
            Self::Lambert { albedo, emission, emits_both_sides, .. } => {
                (Surface::Lambert { albedo: plain(albedo) }, emission, emits_both_sides)
            }
            Self::Mirror { albedo, emission, emits_both_sides, .. } => {
                (Surface::Mirror { reflectance: plain(albedo) }, emission, emits_both_sides)
            }
            Self::Glass { ior, absorption, tint, roughness, emission, emits_both_sides, .. } => {
                let surface = Surface::Dielectric {
                    ior: ior.0,
                    absorption: plain(absorption),
                    tint: plain(tint),
                    roughness: roughness.0,
                };
                (surface, emission, emits_both_sides)
            }
            Self::Thin { ior, tint, roughness, emission, emits_both_sides, .. } => {
                let surface = Surface::Thin { ior: ior.0, tint: plain(tint), roughness: roughness.0 };
                (surface, emission, emits_both_sides)
            }
            Self::Glossy { albedo, metallic, roughness, specular, ior, emission, emits_both_sides, .. } => {
                let surface = Surface::Glossy {
                    base_color: plain(albedo),
                    metallic: metallic.0,
                    roughness: roughness.0,
                    specular: specular.0,
                    ior: ior.0,
                };
                (surface, emission, emits_both_sides)
            }
        };
        let emission = plain(emission);
        let base = MaterialDesc::new(name, surface).with_specular_color(specular_color);
        let base = base.with_clearcoat(clearcoat, clearcoat_roughness).with_anisotropy(anisotropy, rotation);
        let base = base.with_diffuse_transmission(share, color).with_sheen(sheen_color, sheen_roughness);
        Some(MaterialDesc { emission, emits_both_sides, priority, textures, ..base })
    }
}

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

/// Extras of a primitive: indices of buffer views with values in double precision.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PrimitiveExtras {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) positions: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) normals: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tangents: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colors: Option<usize>,
    /// By the number of the UV set.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) uvs: BTreeMap<String, usize>,
}

/// Parses the extras of an object; `None` if it has none of ours.
///
/// # Errors
/// A text for the report, if they are ours but invalid.
pub(crate) fn read<T: for<'de> Deserialize<'de>>(extras: Option<&str>) -> Result<Option<T>, String> {
    let Some(text) = extras.filter(|text| text.contains("\"photonmap\"")) else { return Ok(None) };
    let parsed: Result<Extras<T>, _> = serde_json::from_str(text);
    parsed.map(|extras| Some(extras.photonmap)).map_err(|why| format!("its extras.photonmap is ignored: {why}"))
}

/// Report text for extras that no longer agree with the rest of the file.
pub(crate) const CHANGED: &str =
    "was changed after it was exported; what glTF says is used, in single precision, and its extras are ignored";
