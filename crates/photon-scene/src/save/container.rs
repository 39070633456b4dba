//! The container of a GLB: header and chunks.

use crate::error::SceneError;

/// Assembles header and chunks (glTF 2.0 specification, section 4.4).
pub(super) fn pack(json: &[u8], bin: &[u8]) -> Result<Vec<u8>, SceneError> {
    let length = 12 + 8 + json.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    let Ok(total) = u32::try_from(length) else {
        return Err(SceneError::Extreme {
            what: "the size of the file".to_owned(),
            value: format!("{length} bytes"),
            hint: "a .glb holds at most 4 GiB; split the scene",
        });
    };
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(total.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)].into_iter().filter(|(_, chunk)| !chunk.is_empty()) {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    Ok(file)
}
