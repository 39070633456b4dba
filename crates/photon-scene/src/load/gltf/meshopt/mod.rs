//! Compressed buffer views: `KHR_meshopt_compression` and `EXT_meshopt_compression`, decoded as appendices A and B of the
//! former's specification say; the latter is a part of it.

mod attributes;
mod filters;
mod indices;
mod stream;
mod triangles;

use gltf::json::buffer::View;
use gltf::json::{Value, deserialize};
use serde::Deserialize;

use super::fault::{AGAIN, Fault};

/// The names of the extension.
pub(super) const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// No stream shrinks by more than this factor: blocks of up to 256 equal records take a quarter of a byte for each byte
/// of a record. A view that claims more is damaged, and is refused before memory is allocated for it.
const MAX_RATIO: u64 = 1024;

/// How and where a buffer view is compressed.
#[derive(Debug, Deserialize)]
pub(super) struct Compressed {
    /// The buffer with the compressed bytes.
    pub(super) buffer: usize,
    #[serde(rename = "byteOffset", default)]
    pub(super) offset: u64,
    #[serde(rename = "byteLength")]
    pub(super) length: u64,
    #[serde(rename = "byteStride")]
    stride: usize,
    count: u64,
    mode: Mode,
    #[serde(default)]
    filter: Filter,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Compressed {
    /// The compression of a view, if it has one; `part` is named in errors.
    ///
    /// # Errors
    /// Parameters that are missing, unknown or contradict each other.
    pub(super) fn of(view: &View, part: &str) -> Result<Option<Self>, Fault> {
        let extensions = view.extensions.as_ref();
        let Some((name, json)) = NAMES.iter().find_map(|name| Some((name, extensions?.others.get(*name)?))) else {
            return Ok(None);
        };
        let wrong = |why: String| Fault::new(part, format!("{name}: {why}"), AGAIN);
        let found: Self = from_value(json).map_err(&wrong)?;
        found.check(view.byte_length.0).map_err(wrong)?;
        Ok(Some(found))
    }

    /// The conditions of the specification; `size` is the length of the decoded view.
    fn check(&self, size: u64) -> Result<(), String> {
        let Self { stride, count, mode, filter, length, .. } = *self;
        if count.checked_mul(stride as u64) != Some(size) {
            return Err(format!("{count} elements of {stride} bytes do not fill a view of {size} bytes"));
        }
        let is_valid_stride = match mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles | Mode::Indices => stride == 2 || stride == 4,
        };
        if !is_valid_stride {
            return Err(format!("mode {mode:?} cannot have a stride of {stride} bytes"));
        }
        if mode == Mode::Triangles && !count.is_multiple_of(3) {
            return Err(format!("{count} indices make no whole number of triangles"));
        }
        let suits = match filter {
            Filter::None => true,
            Filter::Octahedral | Filter::Color => mode == Mode::Attributes && (stride == 4 || stride == 8),
            Filter::Quaternion => mode == Mode::Attributes && stride == 8,
            Filter::Exponential => mode == Mode::Attributes,
        };
        if !suits {
            return Err(format!("filter {filter:?} does not suit mode {mode:?} and a stride of {stride} bytes"));
        }
        if size > length.saturating_mul(MAX_RATIO) {
            return Err(format!("{length} bytes cannot hold {count} elements of {stride} bytes"));
        }
        Ok(())
    }

    /// Length of the decoded bytes.
    pub(super) fn decoded_length(&self) -> u64 {
        self.count.saturating_mul(self.stride as u64)
    }

    /// Decodes the bytes of the view.
    ///
    /// # Errors
    /// Why the bytes are no valid stream.
    pub(super) fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, &'static str> {
        let count = usize::try_from(self.count).map_err(|_| "it is too large")?;
        match self.mode {
            Mode::Triangles => Ok(packed(&triangles::decode(bytes, count)?, self.stride)),
            Mode::Indices => Ok(packed(&indices::decode(bytes, count)?, self.stride)),
            Mode::Attributes => {
                let mut decoded = attributes::decode(bytes, count, self.stride)?;
                match self.filter {
                    Filter::None => {}
                    Filter::Octahedral => filters::octahedral(&mut decoded, self.stride),
                    Filter::Quaternion => filters::quaternion(&mut decoded),
                    Filter::Exponential => filters::exponential(&mut decoded),
                    Filter::Color => filters::color(&mut decoded, self.stride),
                }
                Ok(decoded)
            }
        }
    }
}

/// Reads the parameters from their JSON.
fn from_value(json: &Value) -> Result<Compressed, String> {
    deserialize::from_value(json.clone()).map_err(|error| error.to_string())
}

/// Little-endian indices of 2 or 4 bytes; 2 bytes drop the upper half, as the specification says.
fn packed(indices: &[u32], stride: usize) -> Vec<u8> {
    match stride {
        2 => indices.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect(),
        _ => indices.iter().flat_map(|&index| index.to_le_bytes()).collect(),
    }
}

#[cfg(test)]
mod tests;
