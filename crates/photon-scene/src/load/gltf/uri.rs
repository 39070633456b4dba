//! Resolves URIs in a file: embedded data, or a file beside it.

use std::fs;
use std::path::{Path, PathBuf};

use super::fault::AGAIN;

/// The part after `data:` in a URI that contains its data; schemes have letters of any case.
pub(super) fn data_of(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_at_checked(5)?;
    scheme.eq_ignore_ascii_case("data:").then_some(data)
}

/// The bytes that `uri` refers to; relative paths start at `folder`.
///
/// # Errors
///
/// Why it cannot be read, as the predicate of a sentence about the object that has it, and the hint.
pub(super) fn read(uri: &str, folder: &Path) -> Result<Vec<u8>, (String, &'static str)> {
    if let Some(data) = data_of(uri) {
        return read_data(data);
    }
    let path = path(uri, folder)?;
    fs::read(&path)
        .map_err(|error| (format!("is in the file {uri}, which cannot be read: {error}"), "check that it is readable"))
}

/// Number of the bytes that [`read`] returns, or an upper bound; 0 if the file has no length.
///
/// # Errors
///
/// As [`read`].
pub(super) fn length(uri: &str, folder: &Path) -> Result<u64, (String, &'static str)> {
    if data_of(uri).is_some() {
        return Ok(uri.len() as u64);
    }
    Ok(fs::metadata(path(uri, folder)?).map_or(0, |data| data.len()))
}

/// The file that `uri` refers to, which exists.
///
/// # Errors
///
/// As [`read`].
pub(super) fn path(uri: &str, folder: &Path) -> Result<PathBuf, (String, &'static str)> {
    if let Some((scheme, _)) = uri.split_once("://") {
        let why = format!("is at a {scheme} address, and only files beside the scene are read");
        return Err((why, "download it, and name the file instead"));
    }
    let leaves = |path: &str| {
        let why = format!("is in the file {path}, outside the folder of the scene");
        (why, "put it into the folder of the scene or below it")
    };
    if leaves_folder(uri) {
        return Err(leaves(uri));
    }
    let decoded = decoded(uri);
    if leaves_folder(&decoded) {
        return Err(leaves(&decoded));
    }
    // Exporters that write a name verbatim are as common as those that percent-encode it, so both are tried; those on
    // Windows write backslashes.
    let candidates = [uri.to_owned(), decoded.replace('\\', "/"), decoded].map(|name| folder.join(name));
    let [_, slashes, _] = &candidates;
    let path = candidates.iter().find(|path| path.is_file()).unwrap_or(slashes).clone();
    if path.exists() && !path.is_file() {
        let why = format!("is in {uri}, which is not a file");
        return Err((why, "name the file"));
    }
    if !path.is_file() {
        let why = format!("is in the file {uri}, which does not exist");
        return Err((why, "put it where the scene expects it, or export a .glb"));
    }
    Ok(path)
}

/// A URI without percent escapes, if they are valid.
fn decoded(uri: &str) -> String {
    percent_decode(uri).and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_else(|| uri.to_owned())
}

/// Whether a file is found only with the backslashes of its URI read as slashes.
pub(super) fn has_backslashes(uri: &str, folder: &Path) -> bool {
    let decoded = decoded(uri);
    data_of(uri).is_none()
        && decoded.contains('\\')
        && path(uri, folder).is_ok_and(|path| path != folder.join(&decoded) && path != folder.join(uri))
}

/// Whether a relative path leads out of the folder that it starts in, or is absolute on any system.
pub(in crate::load) fn leaves_folder(path: &str) -> bool {
    if path.starts_with(['/', '\\']) || path.as_bytes().get(1) == Some(&b':') {
        return true;
    }
    let mut depth = 0_i64;
    path.split(['/', '\\']).any(|part| {
        depth += match part {
            ".." => -1,
            "" | "." => 0,
            _ => 1,
        };
        depth < 0
    })
}

/// Decodes what follows `data:` (RFC 2397).
fn read_data(data: &str) -> Result<Vec<u8>, (String, &'static str)> {
    let damaged = || ("has a data URI that is truncated or damaged".to_owned(), AGAIN);
    let (kind, payload) = data.split_once(',').ok_or_else(damaged)?;
    let bytes = match kind.trim_end().to_ascii_lowercase().ends_with(";base64") {
        true if payload.contains('%') => percent_decode(payload).and_then(|text| base64_decode(&text)),
        true => base64_decode(payload.as_bytes()),
        false => percent_decode(payload),
    };
    bytes.ok_or_else(damaged)
}

/// Decodes base64 in its standard or its URL-safe alphabet (RFC 4648, sections 4 and 5), with or without padding and line
/// breaks.
fn base64_decode(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut count) = (0_u32, 0);
    let mut digits = text.iter().filter(|digit| !digit.is_ascii_whitespace());
    for &digit in digits.by_ref().take_while(|digit| **digit != b'=') {
        (bits, count) = (bits << 6 | sextet(digit)?, count + 1);
        if count == 4 {
            bytes.extend_from_slice(&bits.to_be_bytes()[1..]);
            (bits, count) = (0, 0);
        }
    }
    match count {
        0 => {}
        2 => bytes.push((bits >> 4) as u8),
        3 => bytes.extend_from_slice(&(bits >> 2).to_be_bytes()[2..]),
        _ => return None,
    }
    digits.all(|digit| *digit == b'=').then_some(bytes)
}

fn sextet(digit: u8) -> Option<u32> {
    let value = match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

/// Decodes percent escapes such as `%41` (RFC 3986, section 2.1).
fn percent_decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        if first != b'%' {
            bytes.push(first);
            rest = tail;
            continue;
        }
        let (high, low) = (*tail.first()? as char, *tail.get(1)? as char);
        bytes.push((high.to_digit(16)? * 16 + low.to_digit(16)?) as u8);
        rest = &tail[2..];
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_follows_the_examples_of_rfc_4648() {
        let decode = |text: &str| base64_decode(text.as_bytes());
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE", "fooba"),
            ("Zm9v\r\nYm\tE =\n", "fooba"),
        ] {
            assert_eq!(decode(text).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        for text in ["/+8A", "_-8A"] {
            assert_eq!(decode(text), Some(vec![0xff, 0xef, 0]), "{text}");
        }
        for broken in ["Zm9vY", "Zm*9", "Zg==Zg", "Z\u{a0}g="] {
            assert_eq!(decode(broken), None, "{broken}");
        }
        // Escapes and the marker in capitals.
        assert_eq!(read_data("image/png;BASE64,%2F%2b8A%0A").unwrap(), [0xff, 0xef, 0]);
    }

    #[test]
    fn paths_stay_within_their_folder() {
        for inside in ["a.png", "a/b.png", "./a.png", "a/../b.png", "a b.png", "a..b", "..a"] {
            assert!(!leaves_folder(inside), "{inside}");
        }
        for outside in ["../a.png", "a/../../b.png", "/etc/passwd", "\\\\host\\a.png", "C:\\a.png", "a\\..\\..\\b"] {
            assert!(leaves_folder(outside), "{outside}");
        }
        let (why, _) = read(".", Path::new(".")).unwrap_err();
        assert!(why.contains("not a file"), "{why}");
        for (uri, path) in [("../secret.png", "../secret.png"), ("%2e%2e/secret.png", "../secret.png")] {
            let (why, _) = read(uri, Path::new(".")).unwrap_err();
            assert!(why.contains(path) && why.contains("outside"), "{why}");
        }
    }

    #[test]
    fn escapes_are_undone_or_refused() {
        assert_eq!(percent_decode("a%20b%C3%a9").as_deref(), Some("a bé".as_bytes()));
        for broken in ["%", "%4", "%zz"] {
            assert_eq!(percent_decode(broken), None, "{broken}");
        }
    }
}
