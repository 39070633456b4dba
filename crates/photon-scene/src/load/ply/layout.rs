//! Uses of the properties of PLY elements.

use super::header::{Element, Kind, Property};

/// Use of a number of an element.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    Position(usize),
    Normal(usize),
    /// Red, green, blue.
    Color(usize),
    Alpha,
    Uv(usize),
    /// The list of the vertices of a face or strip.
    Indices,
    /// The list of the texture coordinates of the corners of a face.
    Corners,
    /// The number of the image of a face.
    Texture,
}

/// Properties that are used together or not at all: alternative names of each, and whether they are lists.
type Role = (&'static [&'static [&'static str]], bool, fn(usize) -> Place);

const COLOR: Role = (
    &[&["red", "diffuse_red", "r"], &["green", "diffuse_green", "g"], &["blue", "diffuse_blue", "b"]],
    false,
    Place::Color,
);
const ALPHA: Role = (&[&["alpha", "diffuse_alpha", "a"]], false, |_| Place::Alpha);
const INDICES: Role = (&[&["vertex_indices", "vertex_index"]], true, |_| Place::Indices);

fn roles(element: &str) -> &'static [Role] {
    match element {
        "vertex" => &[
            (&[&["x"], &["y"], &["z"]], false, Place::Position),
            (&[&["nx"], &["ny"], &["nz"]], false, Place::Normal),
            COLOR,
            ALPHA,
            (&[&["s", "u", "texture_u"], &["t", "v", "texture_v"]], false, Place::Uv),
        ],
        "face" => &[
            INDICES,
            COLOR,
            ALPHA,
            (&[&["texcoord"]], true, |_| Place::Corners),
            (&[&["texnumber"]], false, |_| Place::Texture),
        ],
        "tristrips" => &[INDICES],
        _ => &[],
    }
}

/// The uses of the properties of an element.
pub(super) struct Layout {
    /// The use of each property; `None` for those that are not read.
    pub(super) places: Vec<Option<Place>>,
}

impl Layout {
    pub(super) fn of(element: &Element) -> Self {
        let mut places = vec![None; element.properties.len()];
        for (parts, is_list, place) in roles(&element.name) {
            let is = |property: &Property, names: &[&str]| {
                property.length.is_some() == *is_list && names.contains(&property.name.as_str())
            };
            let find = |names: &&[&str]| element.properties.iter().position(|property| is(property, names));
            let found: Option<Vec<usize>> = parts.iter().map(find).collect();
            for (part, property) in found.into_iter().flatten().enumerate() {
                places[property] = Some(place(part));
            }
        }
        Self { places }
    }

    /// The type of the numbers that go there.
    pub(super) fn kind(&self, element: &Element, place: Place) -> Option<Kind> {
        let at = self.places.iter().position(|known| *known == Some(place))?;
        Some(element.properties[at].kind)
    }

    /// Names of properties that are not read.
    pub(super) fn unread<'a>(&self, element: &'a Element) -> Vec<&'a str> {
        let all = self.places.iter().zip(&element.properties);
        all.filter(|(place, _)| place.is_none()).map(|(_, property)| property.name.as_str()).collect()
    }
}
