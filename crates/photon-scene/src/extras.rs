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
mod dispersion;
mod exact;
mod node;
mod phase;
pub(crate) mod standard;
mod texture;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub(crate) use self::agrees::Agrees;
use self::dispersion::DispersionExtras;
pub(crate) use self::exact::Exact;
use self::exact::{Triple, exact, plain};
pub(crate) use self::node::{CameraExtras, LightExtras, NodeExtras};
use self::phase::PhaseExtras;
pub(crate) use self::texture::{ImageExtras, TexturesExtras, agreeing_floats, fallback};
use crate::describe::{MaterialDesc, PhaseDesc, Surface};
use crate::texture::TexturesDesc;

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
    Boundary {
        absorption: Triple,
        #[serde(default)]
        priority: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scattering: Option<Triple>,
        #[serde(default, skip_serializing_if = "Exact::is_zero")]
        anisotropy: Exact,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        phase: Option<PhaseExtras>,
    },
    Glass {
        ior: Exact,
        absorption: Triple,
        tint: Triple,
        #[serde(default, skip_serializing_if = "Exact::is_zero")]
        roughness: Exact,
        #[serde(default)]
        priority: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        dispersion: Option<DispersionExtras>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scattering: Option<Triple>,
        #[serde(default, skip_serializing_if = "Exact::is_zero")]
        anisotropy: Exact,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        phase: Option<PhaseExtras>,
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
        #[serde(default, skip_serializing_if = "Option::is_none")]
        transmission: Option<GlassExtras>,
    },
}

/// The share of a surface that is glass: that share, absorption and priority if it is a solid.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GlassExtras {
    factor: Exact,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    absorption: Option<Triple>,
    #[serde(default)]
    priority: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dispersion: Option<DispersionExtras>,
}

impl GlassExtras {
    fn new(desc: &MaterialDesc) -> Option<Self> {
        let absorption = desc.transmission_absorption.map(exact);
        let dispersion = desc.dispersion.map(DispersionExtras::new);
        let found = Self { factor: Exact(desc.transmission), absorption, priority: desc.priority, dispersion };
        (desc.transmission > 0.0).then_some(found)
    }
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
                dispersion: desc.dispersion.map(DispersionExtras::new),
                scattering: (desc.scattering != [0.0; 3]).then(|| exact(desc.scattering)),
                anisotropy: PhaseExtras::new(desc.phase).0,
                phase: PhaseExtras::new(desc.phase).1,
                emission,
                emits_both_sides,
                textures,
            },
            Surface::Boundary { absorption } => Self::Boundary {
                absorption: exact(absorption),
                priority: *priority,
                scattering: (desc.scattering != [0.0; 3]).then(|| exact(desc.scattering)),
                anisotropy: PhaseExtras::new(desc.phase).0,
                phase: PhaseExtras::new(desc.phase).1,
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
                transmission: GlassExtras::new(desc),
                specular_color: (desc.specular_color != [1.0; 3]).then(|| exact(desc.specular_color)),
                emission,
                emits_both_sides,
                textures,
            },
        }
    }

    /// The material, if its textures agree with those of the file.
    pub(crate) fn desc(self, name: String, found: TexturesDesc) -> Option<MaterialDesc> {
        let textures = match &self {
            Self::Boundary { .. } => None,
            Self::Lambert { textures, .. }
            | Self::Mirror { textures, .. }
            | Self::Glass { textures, .. }
            | Self::Thin { textures, .. }
            | Self::Glossy { textures, .. } => textures.as_ref(),
        };
        let textures = textures.map_or(Some(found), |textures| textures.refine(found))?;
        // Priority and dispersion apply only to solids.
        let (transmission, absorption, priority, dispersion) = match &self {
            Self::Glossy { transmission: Some(found), .. } => {
                (found.factor.0, found.absorption.map(plain), found.priority, found.dispersion)
            }
            Self::Glass { priority, dispersion, .. } => (0.0, None, *priority, *dispersion),
            Self::Boundary { priority, .. } => (0.0, None, *priority, None),
            _ => (0.0, None, 0, None),
        };
        let dispersion = dispersion.map(DispersionExtras::plain);
        let (scattering, phase) = match &self {
            Self::Glass { scattering, anisotropy, phase, .. }
            | Self::Boundary { scattering, anisotropy, phase, .. } => {
                (scattering.map_or([0.0; 3], plain), PhaseExtras::plain(*anisotropy, *phase))
            }
            _ => ([0.0; 3], PhaseDesc::default()),
        };
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
            Self::Boundary { absorption, .. } => {
                (Surface::Boundary { absorption: plain(absorption) }, exact([0.0; 3]), false)
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
        let base = base.with_transmission(transmission, absorption).with_scattering(scattering, phase);
        Some(MaterialDesc { emission, emits_both_sides, priority, dispersion, textures, ..base })
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
