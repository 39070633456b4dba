//! Text of files in formats that do not define an encoding.

use std::path::Path;

use photon_core::FileKind;

use crate::error::SceneError;

/// First bytes of text in other encodings.
const WIDE: [(&[u8], &str); 4] = [
    (&[0xFF, 0xFE, 0, 0], "text in UTF-32"),
    (&[0, 0, 0xFE, 0xFF], "text in UTF-32"),
    (&[0xFF, 0xFE], UTF_16),
    (&[0xFE, 0xFF], UTF_16),
];
const UTF_16: &str = "text in UTF-16";

/// Checks that a file with one of these extensions is not of another known kind.
///
/// # Errors
/// [`SceneError::OtherKind`], with the remedy.
pub(super) fn check_kind(path: &Path, bytes: &[u8], extensions: &[&str]) -> Result<(), SceneError> {
    let kind = FileKind::other_than(extensions, bytes);
    kind.map_or(Ok(()), |kind| Err(SceneError::OtherKind { path: path.to_owned(), kind }))
}

/// The content of a file of text, or with a header of text, behind its byte order mark.
///
/// # Errors
/// Those of [`check_kind`]; text in UTF-16 or UTF-32.
pub(super) fn content<'a>(path: &Path, bytes: &'a [u8], extensions: &[&str]) -> Result<&'a [u8], SceneError> {
    check_kind(path, bytes, extensions)?;
    let marked = WIDE.iter().find(|(start, _)| bytes.starts_with(start)).map(|&(_, name)| name);
    // Without a mark: one of two bytes of its first character, which is ASCII, is 0.
    let is_wide = || matches!(bytes, [0, other, ..] | [other, 0, ..] if *other != 0);
    if let Some(name) = marked.or_else(|| is_wide().then_some(UTF_16)) {
        let (what, hint) = (format!("it is {name}"), "save it as UTF-8".to_owned());
        return Err(SceneError::Content { path: path.to_owned(), line: None, what, hint });
    }
    Ok(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes))
}

/// The text of a file: all line ends are `\n` or `\r\n`, and bytes that are not UTF-8 are taken as Latin-1.
///
/// # Errors
/// As [`content`], and files that are not text.
pub(super) fn text_of(path: &Path, mut bytes: Vec<u8>) -> Result<String, SceneError> {
    if bytes.is_empty() {
        return Ok(String::new());
    }
    let start = bytes.len() - content(path, &bytes, &[])?.len();
    // Padding, and the end-of-file character of DOS.
    while bytes.pop_if(|last| matches!(last, 0 | 0x1A)).is_some() {}
    if bytes.iter().take(1024).any(|&byte| byte == 0) {
        let (what, hint) = ("it is not text".to_owned(), "give it the extension of its format".to_owned());
        return Err(SceneError::Content { path: path.to_owned(), line: None, what, hint });
    }
    bytes.drain(..start.min(bytes.len()));
    // Those of old Macs.
    for at in 0..bytes.len() {
        if bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n') {
            bytes[at] = b'\n';
        }
    }
    Ok(String::from_utf8(bytes).unwrap_or_else(|other| latin_1(other.as_bytes())))
}

/// Text whose bytes that are not UTF-8 are taken as Latin-1: different names stay different, and are those of files on the
/// disk.
pub(super) fn latin_1(bytes: &[u8]) -> String {
    let chunks = bytes.utf8_chunks();
    chunks.flat_map(|chunk| chunk.valid().chars().chain(chunk.invalid().iter().map(|&byte| byte.into()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_line_ends_and_encodings_of_text() {
        let text = |bytes: &[u8]| text_of(Path::new("a.obj"), bytes.to_vec());
        for (bytes, lines) in [
            (&b"\xEF\xBB\xBFv 1\nf 2"[..], &["v 1", "f 2"][..]),
            (b"v 1\rf 2\r", &["v 1", "f 2"]),
            (b"v 1\r\nf 2\r\n\x1A", &["v 1", "f 2"]),
            (b"v 1\rf 2\ng 3\r\nh", &["v 1", "f 2", "g 3", "h"]),
            (b"o W\xE4nd\no W\xF6nd \xC3\xA4\0\0", &["o Wänd", "o Wönd ä"]),
            (b"", &[]),
            (b"\xEF\xBB\xBF", &[]),
            (b"\0", &[]),
        ] {
            let found = text(bytes).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(found.lines().collect::<Vec<_>>(), lines, "{bytes:?}");
        }
        for (bytes, words) in [
            (&b"\xFF\xFEv\0 \0"[..], "text in UTF-16; save it as UTF-8"),
            (b"\xFE\xFF\0v", "UTF-16"),
            (b"v\0 \x001\0", "UTF-16"),
            (b"\0v\0 ", "UTF-16"),
            (b"\xFF\xFE\0\0v\0\0\0", "UTF-32"),
            (b"\x1F\x8B\x08\0", "compressed by gzip; unpack it with gunzip"),
            (b"PK\x03\x04", "ZIP"),
            (b"<html>", "an HTML page; download the file itself"),
            (b"v 1\0\0\n", "not text"),
        ] {
            let error = text(bytes).expect_err("no text").to_string();
            assert!(error.starts_with("a.obj: it is ") && error.contains(words), "{error}");
        }
    }
}
