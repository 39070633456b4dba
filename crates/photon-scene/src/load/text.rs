//! Text of files in formats that do not define an encoding.

use std::path::Path;

use crate::error::SceneError;

/// First bytes of files that are compressed or not in UTF-8, their name, and the remedy.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    (&[0xFF, 0xFE, 0, 0], "text in UTF-32", SAVE),
    (&[0, 0, 0xFE, 0xFF], "text in UTF-32", SAVE),
    (&[0xFF, 0xFE], UTF_16, SAVE),
    (&[0xFE, 0xFF], UTF_16, SAVE),
    (&[0x1F, 0x8B], "compressed by gzip", "unpack it with gunzip"),
    (b"BZh", "compressed by bzip2", "unpack it with bunzip2"),
    (&[0xFD, b'7', b'z', b'X', b'Z', 0], "compressed by xz", "unpack it with unxz"),
    (&[0x28, 0xB5, 0x2F, 0xFD], "compressed by zstd", "unpack it with unzstd"),
    (b"PK\x03\x04", "a ZIP archive", "unpack it"),
    (b"7z\xBC\xAF\x27\x1C", "a 7z archive", "unpack it"),
];
const UTF_16: &str = "text in UTF-16";
const SAVE: &str = "save it as UTF-8";

/// The content of a file of text, or with a header of text, behind its byte order mark.
///
/// # Errors
/// Compressed files and UTF-16, with the remedy.
pub(super) fn content<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a [u8], SceneError> {
    if let Some((name, remedy)) = foreign(bytes) {
        let (what, hint) = (format!("it is {name}"), format!("{remedy}, and load that"));
        return Err(SceneError::Content { path: path.to_owned(), line: None, what, hint });
    }
    Ok(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes))
}

/// The name of the encoding or compression of a file that is not in UTF-8, and the remedy.
pub(super) fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let marked = FOREIGN.iter().find(|(start, ..)| bytes.starts_with(start)).map(|&(_, name, remedy)| (name, remedy));
    // Without a mark: one of two bytes of its first character, which is ASCII, is 0.
    let is_wide = || matches!(bytes, [0, other, ..] | [other, 0, ..] if *other != 0);
    marked.or_else(|| is_wide().then_some((UTF_16, SAVE)))
}

/// The text of a file: all line ends are `\n` or `\r\n`, and bytes that are not UTF-8 are taken as Latin-1.
///
/// # Errors
/// As [`content`], and files that are not text.
pub(super) fn text_of(path: &Path, mut bytes: Vec<u8>) -> Result<String, SceneError> {
    let start = bytes.len() - content(path, &bytes)?.len();
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
            (b"v 1\0\0\n", "not text"),
        ] {
            let error = text(bytes).expect_err("no text").to_string();
            assert!(error.starts_with("a.obj: it is ") && error.contains(words), "{error}");
        }
    }
}
