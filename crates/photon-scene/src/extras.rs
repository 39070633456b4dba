//! The contents of `extras.photonmap` in glTF files written by this crate: the numbers of a scene in double precision,
//! and properties that glTF cannot express.
//!
//! ```json
//! "materials": [{ …, "extras": { "photonmap": { "kind": "glass", "parameters": { "ior": ["1.33"], … }, … } } }],
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
use crate::describe::MaterialDesc;
use crate::parameter::{self, Kind, Parameter, Value};
use crate::texture::TexturesDesc;

/// The extras of one object, parts of which may belong to other programs.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Extras<T> {
    pub(crate) photonmap: T,
}

/// Extras of a material. Parameters that are not given have the values of [`Kind::surface`] and of [`MaterialDesc::new`].
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MaterialExtras {
    kind: Kind,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    parameters: BTreeMap<String, Vec<Exact>>,
    emission: Triple,
    emits_both_sides: bool,
    /// Absorption of the share of a glossy surface that is glass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    transmission_absorption: Option<Triple>,
    #[serde(default)]
    priority: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dispersion: Option<DispersionExtras>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    phase: Option<PhaseExtras>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    textures: Option<TexturesExtras>,
}

impl MaterialExtras {
    pub(crate) fn new(desc: &MaterialDesc) -> Self {
        let kind = Kind::of(&desc.surface);
        let usual = MaterialDesc::new("", kind.surface());
        let given = parameter::values(desc).filter(|(parameter, value)| parameter.value(&usual) != Some(*value));
        let exact_numbers = |value: Value| value.numbers().iter().copied().map(Exact).collect();
        Self {
            kind,
            parameters: given.map(|(parameter, value)| (parameter.key.to_owned(), exact_numbers(value))).collect(),
            emission: exact(desc.emission),
            emits_both_sides: desc.emits_both_sides,
            transmission_absorption: desc.transmission_absorption.filter(|_| desc.transmission > 0.0).map(exact),
            priority: desc.priority,
            dispersion: desc.dispersion.filter(|_| desc.is_solid()).map(DispersionExtras::new),
            phase: PhaseExtras::new(desc.phase),
            textures: TexturesExtras::new(&desc.textures),
        }
    }

    /// The material, if its parameters exist and its textures agree with those of the file.
    pub(crate) fn desc(self, name: String, found: TexturesDesc) -> Option<MaterialDesc> {
        let mut desc = MaterialDesc::new(name, self.kind.surface());
        for (key, numbers) in self.parameters {
            let numbers: Vec<f64> = numbers.into_iter().map(|number| number.0).collect();
            let is_set = Parameter::find(&key)?.set(&mut desc, Value::from_numbers(&numbers)?);
            is_set.then_some(())?;
        }
        Some(MaterialDesc {
            emission: plain(self.emission),
            emits_both_sides: self.emits_both_sides,
            transmission_absorption: self.transmission_absorption.map(plain),
            priority: self.priority,
            dispersion: self.dispersion.map(DispersionExtras::plain),
            phase: self.phase.map_or(desc.phase, PhaseExtras::plain),
            textures: self.textures.map_or(Some(found), |textures| textures.refine(found))?,
            ..desc
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describe::Dispersion;

    fn again(desc: &MaterialDesc) -> Option<MaterialDesc> {
        let text = serde_json::to_string(&MaterialExtras::new(desc)).unwrap();
        serde_json::from_str::<MaterialExtras>(&text).unwrap().desc(desc.name.clone(), desc.textures)
    }

    /// Properties of solids are not written of other materials.
    #[test]
    fn metal_has_no_dispersion() {
        let glass = MaterialDesc::plastic("a", [0.5; 3], 0.25).with_transmission(0.5, Some([1.0; 3]));
        let glass = glass.with_dispersion(Dispersion::Abbe(30.0)).with_priority(2);
        assert_eq!(again(&glass), Some(glass.clone()));
        let metal = MaterialDesc { transmission: 0.0, ..glass };
        let found = again(&metal).unwrap();
        assert_eq!((found.dispersion, found.transmission_absorption), (None, None));
    }

    #[test]
    fn unknown_parameters_are_refused() {
        let with = |parameters: &str| {
            let text = format!(
                r#"{{"kind": "glass", "parameters": {{{parameters}}}, "emission": ["0", "0", "0"], "emits_both_sides": false}}"#
            );
            serde_json::from_str::<MaterialExtras>(&text).unwrap().desc("a".into(), TexturesDesc::default())
        };
        assert!(with(r#""ior": ["1.25"]"#).is_some_and(|desc| desc.ior() == Some(1.25)));
        for wrong in
            [r#""iro": ["1.25"]"#, r#""ior": ["1", "2"]"#, r#""ior": ["1", "2", "3"]"#, r#""sheen": ["1", "1", "1"]"#]
        {
            assert_eq!(with(wrong), None, "{wrong}");
        }
    }
}
