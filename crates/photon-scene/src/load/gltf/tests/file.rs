//! Small glTF files, assembled from parts.

use std::collections::BTreeMap;
use std::path::Path;

use super::super::assemble;
use super::super::fault::Fault;
use crate::builder::SceneBuilder;
use crate::report::LoadReport;

/// The top-level parts of a file: by default one triangle, `(0,0,0) (1,0,0) (0,1,0)`, at one node.
#[derive(Clone)]
pub(in crate::load::gltf) struct File(BTreeMap<&'static str, String>);

impl File {
    pub(in crate::load::gltf) fn new() -> Self {
        let mut data: Vec<u8> = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
        for index in [0_u16, 1, 2, 0] {
            data.extend(index.to_le_bytes());
        }
        Self(BTreeMap::new())
            .with("asset", r#"{"version": "2.0"}"#)
            .data(&data)
            .with(
                "bufferViews",
                r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}]"#,
            )
            .with(
                "accessors",
                r#"[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]"#,
            )
            .with(
                "meshes",
                r#"[{"name": "tri", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]"#,
            )
            .with("materials", r#"[{"name": "grey"}]"#)
            .with("nodes", r#"[{"mesh": 0}]"#)
            .with("scenes", r#"[{"nodes": [0]}]"#)
    }

    /// Replaces or adds a part.
    pub(in crate::load::gltf) fn with(mut self, key: &'static str, json: impl Into<String>) -> Self {
        self.0.insert(key, json.into());
        self
    }

    /// Removes a part.
    pub(in crate::load::gltf) fn without(mut self, key: &str) -> Self {
        self.0.remove(key);
        self
    }

    /// Replaces the material, given by the JSON text between its braces.
    pub(in crate::load::gltf) fn material(self, json: &str) -> Self {
        self.with("materials", format!(r#"[{{"name": "it", {json}}}]"#))
    }

    /// Replaces the bytes of the only buffer.
    pub(in crate::load::gltf) fn data(self, bytes: &[u8]) -> Self {
        let (length, uri) = (bytes.len(), data_uri("application/octet-stream", bytes));
        self.with("buffers", format!(r#"[{{"byteLength": {length}, "uri": "{uri}"}}]"#))
    }

    pub(in crate::load::gltf) fn json(&self) -> String {
        let parts: Vec<String> = self.0.iter().map(|(key, json)| format!("\"{key}\": {json}")).collect();
        format!("{{{}}}", parts.join(",\n"))
    }

    pub(in crate::load::gltf) fn try_load(&self) -> Result<(SceneBuilder, LoadReport), Fault> {
        assemble(self.json().as_bytes(), Path::new("."))
    }

    #[track_caller]
    pub(in crate::load::gltf) fn load(&self) -> (SceneBuilder, LoadReport) {
        self.try_load().unwrap_or_else(|fault| panic!("{fault}"))
    }

    /// Loads the file and builds the scene, to see the errors that a user would see.
    #[track_caller]
    pub(in crate::load::gltf) fn error(&self) -> String {
        match self.try_load() {
            Err(fault) => fault.to_string(),
            Ok((builder, _)) => match builder.build() {
                Err(error) => error.to_string(),
                Ok(_) => panic!("no error is found in {}", self.json()),
            },
        }
    }
}

pub(in crate::load::gltf) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub(in crate::load::gltf) fn data_uri(kind: &str, bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = format!("data:{kind};base64,");
    for group in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, at| bits << 8 | u32::from(*group.get(at).unwrap_or(&0)));
        for digit in 0..4 {
            let used = digit <= group.len();
            let sextet = DIGITS[(bits >> (18 - 6 * digit) & 63) as usize];
            text.push(if used { char::from(sextet) } else { '=' });
        }
    }
    text
}

/// A GLB of a JSON text and a binary chunk.
pub(in crate::load::gltf) fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    for (kind, contents, filler) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", bin, 0)] {
        let mut contents = contents.to_vec();
        contents.resize(contents.len().next_multiple_of(4), filler);
        body.extend((contents.len() as u32).to_le_bytes());
        body.extend(kind);
        body.extend(contents);
    }
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((12 + body.len() as u32).to_le_bytes());
    file.extend(body);
    file
}

/// A PNG of 8-bit RGBA pixels in one row.
pub(in crate::load::gltf) fn png(pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.len() as u32, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(pixels.as_flattened()).unwrap();
    bytes
}

/// Whether a line of the report contains both words.
pub(in crate::load::gltf) fn says(report: &LoadReport, subject: &str, text: &str) -> bool {
    report.lines.iter().any(|line| line.subject.contains(subject) && line.text.contains(text))
}
