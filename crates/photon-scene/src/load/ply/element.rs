//! The properties of PLY elements that are used.

use ply_rs_bw::ply::{Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use crate::color::srgb_to_linear;

/// A vertex, face or other element.
#[derive(Default)]
pub(super) struct Element {
    pub(super) position: [f64; 3],
    /// Which coordinates were present, as bits.
    pub(super) axes: u8,
    pub(super) indices: Vec<i64>,
    pub(super) normal: [f64; 3],
    /// Linear red, green and blue.
    pub(super) color: [f64; 3],
    /// With v as in the file, upwards.
    pub(super) uv: [f64; 2],
}

/// Where the value of a property goes.
enum Place {
    Axis(usize),
    Normal(usize),
    Color(usize),
    Uv(usize),
}

impl Place {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "x" => Self::Axis(0),
            "y" => Self::Axis(1),
            "z" => Self::Axis(2),
            "nx" => Self::Normal(0),
            "ny" => Self::Normal(1),
            "nz" => Self::Normal(2),
            "red" | "diffuse_red" | "r" => Self::Color(0),
            "green" | "diffuse_green" | "g" => Self::Color(1),
            "blue" | "diffuse_blue" | "b" => Self::Color(2),
            "s" | "u" | "texture_u" => Self::Uv(0),
            "t" | "v" | "texture_v" => Self::Uv(1),
            _ => return None,
        })
    }
}

/// Upper bound on the numbers in all lists of a file of `length` bytes.
pub(super) fn most_indices(header: &Header, length: u64) -> u64 {
    // A number of a text takes a digit and a space.
    let bytes = |kind: &ScalarType| match kind {
        _ if header.encoding == Encoding::Ascii => 2,
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let (mut rest, mut least) = (length, None);
    for element in header.elements.values() {
        for property in element.properties.values() {
            // All that each element takes at least, a list without its numbers.
            let (alone, number) = match &property.data_type {
                PropertyType::Scalar(kind) => (bytes(kind), None),
                PropertyType::List(count, kind) => (bytes(count), Some(bytes(kind))),
            };
            rest = rest.saturating_sub((element.count as u64).saturating_mul(alone));
            least = least.into_iter().chain(number).min();
        }
    }
    least.map_or(0, |least| rest / least)
}

/// Whether the vertices of a file have all properties of a group; each is a list of alternatives.
pub(super) fn has(known: impl Fn(&str) -> bool, groups: &[&[&str]]) -> bool {
    groups.iter().all(|names| names.iter().any(|name| known(name)))
}

pub(super) const NORMAL: &[&[&str]] = &[&["nx"], &["ny"], &["nz"]];
pub(super) const COLOR: &[&[&str]] =
    &[&["red", "diffuse_red", "r"], &["green", "diffuse_green", "g"], &["blue", "diffuse_blue", "b"]];
pub(super) const UV: &[&[&str]] = &[&["s", "u", "texture_u"], &["t", "v", "texture_v"]];

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if matches!(name, "vertex_indices" | "vertex_index") {
            return self.set_indices(property);
        }
        let Some(place) = Place::of(name) else { return PropertyAccessResult::Ignored };
        // Integers are shares of their type's largest number, as colours.
        let (value, largest): (f64, f64) = match property {
            Property::Char(value) => (value.into(), i8::MAX.into()),
            Property::UChar(value) => (value.into(), u8::MAX.into()),
            Property::Short(value) => (value.into(), i16::MAX.into()),
            Property::UShort(value) => (value.into(), u16::MAX.into()),
            Property::Int(value) => (value.into(), i32::MAX.into()),
            Property::UInt(value) => (value.into(), u32::MAX.into()),
            Property::Float(value) => (value.into(), 0.0),
            Property::Double(value) => (value, 0.0),
            // Lists are no positions; other properties of that name are not used.
            _ if matches!(place, Place::Axis(_)) => return PropertyAccessResult::UnsupportedType,
            _ => return PropertyAccessResult::Ignored,
        };
        match place {
            Place::Axis(axis) => {
                self.position[axis] = value;
                self.axes |= 1 << axis;
            }
            Place::Normal(axis) => self.normal[axis] = value,
            // Integers are those of a screen, sRGB; floats are linear.
            Place::Color(channel) if largest > 0.0 => {
                self.color[channel] = srgb_to_linear((value / largest).clamp(0.0, 1.0));
            }
            Place::Color(channel) => self.color[channel] = if value.is_nan() { 0.0 } else { value },
            Place::Uv(axis) => self.uv[axis] = value,
        }
        PropertyAccessResult::Set
    }
}

impl Element {
    fn set_indices(&mut self, property: Property) -> PropertyAccessResult {
        fn wide<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
            list.into_iter().map(Into::into).collect()
        }
        self.indices = match property {
            Property::ListChar(list) => wide(list),
            Property::ListUChar(list) => wide(list),
            Property::ListShort(list) => wide(list),
            Property::ListUShort(list) => wide(list),
            Property::ListInt(list) => wide(list),
            Property::ListUInt(list) => wide(list),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
