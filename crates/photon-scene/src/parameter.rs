//! Parameters of materials as data: checks, override files, starter files, extras, and glTF in both directions follow from
//! these tables. A parameter is a field of [`MaterialDesc`] and a line of [`PARAMETERS`]; a texture is a field of
//! [`TexturesDesc`] and a line of [`TEXTURES`].

mod named;
mod table;
mod texture;

use std::fmt;

use crate::describe::{MaterialDesc, Surface};

pub(crate) use self::table::PARAMETERS;
#[cfg(feature = "files")]
pub(crate) use self::texture::{BASE_COLOR, EMISSION, Encoding, METALLIC_ROUGHNESS, NORMAL, SPECULAR, TRANSMISSION};
pub(crate) use self::texture::{Channel, TEXTURES, TextureParameter};

/// The kinds of [`Surface`], by their names in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub(crate) enum Kind {
    Lambert,
    Mirror,
    Glass,
    Boundary,
    Thin,
    Glossy,
}

impl Kind {
    pub(crate) const ALL: [Self; 6] =
        [Self::Lambert, Self::Mirror, Self::Glass, Self::Boundary, Self::Thin, Self::Glossy];

    /// The kind of a surface.
    pub(crate) fn of(surface: &Surface) -> Self {
        match surface {
            Surface::Lambert { .. } => Self::Lambert,
            Surface::Mirror { .. } => Self::Mirror,
            Surface::Dielectric { .. } => Self::Glass,
            Surface::Boundary { .. } => Self::Boundary,
            Surface::Thin { .. } => Self::Thin,
            Surface::Glossy { .. } => Self::Glossy,
        }
    }

    /// The name in files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lambert => "lambert",
            Self::Mirror => "mirror",
            Self::Glass => "glass",
            Self::Boundary => "boundary",
            Self::Thin => "thin",
            Self::Glossy => "glossy",
        }
    }

    /// The surface that a material of this kind has unless something else is given.
    pub(crate) fn surface(self) -> Surface {
        match self {
            Self::Lambert => Surface::Lambert { albedo: [0.5; 3] },
            Self::Mirror => Surface::Mirror { reflectance: [1.0; 3] },
            Self::Glass => Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.0 },
            Self::Boundary => Surface::Boundary { absorption: [0.0; 3] },
            Self::Thin => Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness: 0.0 },
            Self::Glossy => {
                Surface::Glossy { base_color: [0.5; 3], metallic: 0.0, roughness: 0.5, specular: 1.0, ior: 1.5 }
            }
        }
    }
}

/// Numbers of a parameter.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    Color([f64; 3]),
}

impl Value {
    pub(crate) fn numbers(&self) -> &[f64] {
        match self {
            Self::Number(number) => std::slice::from_ref(number),
            Self::Color(color) => color,
        }
    }

    /// The value of one or three numbers.
    pub(crate) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        match *numbers {
            [number] => Some(Self::Number(number)),
            [r, g, b] => Some(Self::Color([r, g, b])),
            _ => None,
        }
    }
}

/// Formats the numbers themselves.
impl fmt::Debug for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Color(color) => color.fmt(f),
        }
    }
}

/// The place of a value in a description.
pub(crate) enum Field<'a> {
    Number(&'a mut f64),
    Color(&'a mut [f64; 3]),
}

/// Finds the place; `None` if the surface has no such parameter.
type Access = fn(&mut MaterialDesc) -> Option<Field<'_>>;

/// Values that a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Range {
    /// Each number from 0 to 1.
    Share,
    /// Each number finite and at least 0.
    NotNegative,
    /// A finite number.
    Finite,
}

/// Part of a material beside its surface, which is absent by default.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// Field of [`MaterialDesc`], for messages.
    pub(crate) field: &'static str,
    pub(crate) range: Range,
    pub(crate) default: Value,
    /// Key of the parameter that makes it appear by differing from its default.
    pub(crate) leader: &'static str,
    /// Extension of glTF and the factor in it, if it has any.
    pub(crate) gltf: Option<(&'static str, &'static str)>,
}

/// A parameter of materials.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameter {
    /// Key of override files.
    pub(crate) key: &'static str,
    /// Kinds of surfaces that have it.
    pub(crate) kinds: &'static [Kind],
    /// Whether override files have it in degrees, where the description has radians.
    pub(crate) is_angle: bool,
    /// `None` for parameters of the surface itself.
    pub(crate) layer: Option<Layer>,
    /// Field of the texture that multiplies it.
    texture: Option<&'static str>,
    get: fn(&MaterialDesc) -> Option<Value>,
    access: Access,
}

impl Parameter {
    /// The parameter with this key.
    pub(crate) fn find(key: &str) -> Option<&'static Self> {
        PARAMETERS.iter().find(|parameter| parameter.key == key)
    }

    /// The kinds of materials that have it, and the verb.
    pub(crate) fn kinds_with(&self) -> String {
        match self.kinds {
            _ if self.key == "absorption" => "glass, boundary and glossy with a transmission have".to_owned(),
            [only] => format!("{} has", only.name()),
            [rest @ .., last] => {
                let rest: Vec<&str> = rest.iter().map(|kind| kind.name()).collect();
                format!("{} and {} have", rest.join(", "), last.name())
            }
            [] => "nothing has".to_owned(),
        }
    }

    /// Whether the surface has it.
    pub(crate) fn is_of(&self, desc: &MaterialDesc) -> bool {
        self.kinds.contains(&Kind::of(&desc.surface))
    }

    /// The value; `None` for surfaces that do not have it.
    pub(crate) fn value(&self, desc: &MaterialDesc) -> Option<Value> {
        (self.get)(desc).filter(|_| self.is_of(desc))
    }

    /// The value with an angle in degrees.
    pub(crate) fn in_degrees(&self, value: Value) -> Value {
        match value {
            Value::Number(radians) if self.is_angle => Value::Number(radians.to_degrees()),
            other => other,
        }
    }

    /// The value, of which an angle is in degrees, in radians.
    pub(crate) fn in_radians(&self, value: Value) -> Value {
        match value {
            Value::Number(degrees) if self.is_angle => Value::Number(degrees.to_radians()),
            other => other,
        }
    }

    /// Multiplies the value by the mean of a texture, of which a number takes one channel.
    pub(crate) fn multiply(&self, desc: &mut MaterialDesc, by: [f64; 3], channel: f64) {
        match (self.access)(desc) {
            Some(Field::Number(number)) => *number *= channel,
            Some(Field::Color(color)) => *color = std::array::from_fn(|at| color[at] * by[at]),
            None => {}
        }
    }

    /// Whether all numbers of the value are 0.
    pub(crate) fn is_zero(&self, desc: &MaterialDesc) -> bool {
        (self.get)(desc).is_some_and(|value| value.numbers().iter().all(|&number| number == 0.0))
    }

    /// Sets the value. Returns whether the surface has the parameter, of this number of numbers.
    pub(crate) fn set(&self, desc: &mut MaterialDesc, value: Value) -> bool {
        if !self.is_of(desc) {
            return false;
        }
        match ((self.access)(desc), value) {
            (Some(Field::Number(number)), Value::Number(value)) => *number = value,
            (Some(Field::Color(color)), Value::Color(value)) => *color = value,
            _ => return false,
        }
        true
    }

    /// The texture that may multiply it.
    pub(crate) fn texture(&self) -> Option<&'static TextureParameter> {
        self.texture.and_then(TextureParameter::find)
    }

    /// Removes the texture, and gives the parameter of a layer its default, also on surfaces without that layer.
    pub(crate) fn remove(&self, desc: &mut MaterialDesc) {
        let Some(layer) = self.layer else { return };
        match ((self.access)(desc), layer.default) {
            (Some(Field::Number(number)), Value::Number(default)) => *number = default,
            (Some(Field::Color(color)), Value::Color(default)) => *color = default,
            _ => {}
        }
        if let Some(texture) = self.texture() {
            *texture.of_mut(&mut desc.textures) = None;
        }
    }

    /// Whether a texture multiplies it.
    pub(crate) fn is_textured(&self, desc: &MaterialDesc) -> bool {
        self.texture().is_some_and(|texture| texture.of(&desc.textures).is_some())
    }

    /// Whether the layer with this parameter, if it is of one, shows.
    pub(crate) fn is_present(&self, desc: &MaterialDesc) -> bool {
        let Some(layer) = self.layer else { return self.is_of(desc) };
        let Some(leader) = Self::find(layer.leader) else { return false };
        let default = leader.layer.map(|layer| layer.default);
        self.is_of(desc) && (leader.get)(desc) != default
    }
}

/// The parameters that the surface of a material has, with their values.
pub(crate) fn values(desc: &MaterialDesc) -> impl Iterator<Item = (&'static Parameter, Value)> {
    PARAMETERS.iter().filter_map(|parameter| Some((parameter, parameter.value(desc)?)))
}

/// The parameters of layers with their values, also of layers that the surface does not have.
pub(crate) fn layers(desc: &MaterialDesc) -> impl Iterator<Item = (&'static Parameter, Layer, Value)> {
    PARAMETERS.iter().filter_map(|parameter| Some((parameter, parameter.layer?, (parameter.get)(desc)?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names in the tables that nothing else checks.
    #[test]
    fn names_of_the_tables_exist() {
        for parameter in PARAMETERS {
            let key = parameter.key;
            assert_eq!(PARAMETERS.iter().filter(|other| other.key == key).count(), 1, "{key}");
            assert_eq!(parameter.texture.is_some(), parameter.texture().is_some(), "{key}");
            let Some(layer) = parameter.layer else { continue };
            let leader = Parameter::find(layer.leader).unwrap();
            assert!(leader.layer.is_some_and(|leading| leading.leader == layer.leader), "{key}");
            assert_eq!(leader.kinds, parameter.kinds, "{key}");
        }
    }

    /// Each parameter is in the surfaces of its kinds, and can be set there alone. The defaults are those of a new material.
    #[test]
    fn kinds_have_the_parameters() {
        for kind in Kind::ALL {
            let desc = MaterialDesc::new("", kind.surface());
            assert_eq!(Kind::of(&desc.surface), kind);
            for parameter in PARAMETERS {
                let found = values(&desc).find(|(other, _)| other.key == parameter.key);
                assert_eq!(found.is_some(), parameter.kinds.contains(&kind), "{} of {kind:?}", parameter.key);
                let mut changed = desc.clone();
                let value = found.map_or(Value::Number(0.25), |(_, value)| match value {
                    Value::Number(_) => Value::Number(0.25),
                    Value::Color(_) => Value::Color([0.25; 3]),
                });
                assert_eq!(parameter.set(&mut changed, value), found.is_some());
                assert_eq!(
                    values(&changed).any(|(other, found)| other.key == parameter.key && found == value),
                    found.is_some()
                );
            }
            let mut bare = desc.clone();
            PARAMETERS.iter().for_each(|parameter| parameter.remove(&mut bare));
            assert_eq!(bare, desc);
        }
    }
}
