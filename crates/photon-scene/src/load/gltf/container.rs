//! The container of a file: the chunks of a GLB, the JSON, and the version.

use gltf::json::{Root, Value, deserialize, serialize};

use super::fault::{AGAIN, COPY_AGAIN, Fault};
use super::{extensions, morph};
use crate::load::text::latin_1;
use crate::report::LoadReport;

pub(super) const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: &[u8] = b"JSON";
const BIN_CHUNK: &[u8] = b"BIN\0";

/// Returns the document, and the binary chunk if there is one; reports what the parser drops.
pub(super) fn open<'a>(bytes: &'a [u8], report: &mut LoadReport) -> Result<(Root, Option<&'a [u8]>), Fault> {
    let (json, bin) = if bytes.starts_with(MAGIC) { split_glb(bytes)? } else { (bytes, None) };
    let latin = std::str::from_utf8(json).is_err().then(|| latin_1(json));
    if latin.is_some() {
        report.note("the file", "has text that is not UTF-8, and is taken as Latin-1");
    }
    let root = parse(latin.as_ref().map_or(json, String::as_bytes), report)?;
    check_version(&root)?;
    Ok((root, bin))
}

/// The JSON of a file, empty if it cannot be found.
pub(super) fn json_of(bytes: &[u8]) -> &[u8] {
    if bytes.starts_with(MAGIC) { split_glb(bytes).map_or(&[], |(json, _)| json) } else { bytes }
}

/// Splits a GLB into its JSON and its binary chunk (glTF 2.0 specification, section 4.4).
///
/// Not the parser's own splitter: that subtracts before it compares, so that a length below 12
/// overflows, and it rejects the trailing chunks that the specification requires readers to skip.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let header = |why: String, hint| Fault::new("the GLB header", why, hint);
    let (Some(version), Some(length)) = (read_u32(bytes, 4), read_u32(bytes, 8)) else {
        let why = format!("needs 12 bytes, but the file has {}", bytes.len());
        return Err(header(why, COPY_AGAIN));
    };
    if version != 2 {
        return Err(header(format!("says version {version}"), "export the file as glTF 2.0"));
    }
    let Some(body) = bytes.get(..length as usize) else {
        let why = format!("declares {length} bytes, but the file has {}", bytes.len());
        return Err(header(why, COPY_AGAIN));
    };
    let (kind, json, mut rest) = split_chunk(body.get(12..).unwrap_or_default())?;
    if kind != JSON_CHUNK {
        return Err(Fault::new("the first GLB chunk", format!("is of type {kind:02x?}, but must be JSON"), AGAIN));
    }
    while !rest.is_empty() {
        let (kind, data, after) = split_chunk(rest)?;
        if kind == BIN_CHUNK {
            return Ok((json, Some(data)));
        }
        rest = after;
    }
    Ok((json, None))
}

/// The type of a chunk, its contents, and the bytes after it.
type Chunk<'a> = (&'a [u8], &'a [u8], &'a [u8]);

/// Splits off the chunk at the front of `bytes`.
fn split_chunk(bytes: &[u8]) -> Result<Chunk<'_>, Fault> {
    let broken = |why: String| Fault::new("a GLB chunk", why, COPY_AGAIN);
    let (Some(length), Some(kind), Some(contents)) = (read_u32(bytes, 0), bytes.get(4..8), bytes.get(8..)) else {
        return Err(broken(format!("needs a header of 8 bytes, but {} are left", bytes.len())));
    };
    match contents.split_at_checked(length as usize) {
        Some((data, rest)) => Ok((kind, data, rest)),
        None => Err(broken(format!("declares {length} bytes, but {} are left", contents.len()))),
    }
}

fn read_u32(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// Parses the JSON text to a document.
fn parse(json: &[u8], report: &mut LoadReport) -> Result<Root, Fault> {
    const HINT: &str = "the file is damaged, or it is not a glTF file";
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    // Some writers fill up chunks with zeros, not with spaces.
    let end = json.iter().rposition(|&byte| byte != 0 && !byte.is_ascii_whitespace()).map_or(0, |last| last + 1);
    let json = &json[..end];
    let mut value: Value = deserialize::from_slice(json).map_err(|error| match not_a_number(json, &error) {
        Some(found) => Fault::new("the JSON", found, "write a number in its place, or null").at_line(error.line()),
        None => Fault::new("the JSON", error.to_string(), HINT).at_line(error.line()),
    })?;
    extensions::report_undeclared(&value, report);
    if let Some(place) = find_oversized_index(&value, "") {
        return Err(Fault::new(place.trim_start_matches('/'), "is above 4294967295, the largest index", AGAIN));
    }
    morph::report_unread(&value, report);
    Root::from_slice(json).or_else(|error| {
        // The parser requires some things that the specification makes optional.
        fill_in_optional(&mut value);
        let text = serialize::to_vec(&value).unwrap_or_default();
        Root::from_slice(&text).map_err(|remaining| {
            let message =
                |error: &gltf::json::Error| error.to_string().split(" at line ").next().unwrap_or_default().to_owned();
            // Line numbers refer to the user's text only if that text fails for the same reason.
            let is_same = message(&error) == message(&remaining);
            let fault = Fault::new(blame(&value), message(&remaining), HINT);
            if is_same { fault.at_line(error.line()) } else { fault }
        })
    })
}

/// The word for a number without a value where the parser stopped, as some programs write it, and its place.
fn not_a_number(json: &[u8], error: &gltf::json::Error) -> Option<String> {
    let line = json.split(|&byte| byte == b'\n').nth(error.line().checked_sub(1)?)?;
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'-' || *byte == b'+';
    // Columns are counted from 1; the parser stops at one of the first letters.
    let at = error.column().checked_sub(1)?.min(line.len().checked_sub(1)?);
    let start = line[..at].iter().rposition(|byte| !is_word(byte)).map_or(0, |before| before + 1);
    let length = line[start..].iter().take(12).take_while(|byte| is_word(byte)).count();
    let word = std::str::from_utf8(&line[start..start + length]).ok()?;
    let plain = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    let place = format!("line {}, column {}", error.line(), start + 1);
    ["nan", "inf", "infinity"].contains(&plain.as_str()).then(|| format!("has {word}, which is no number, at {place}"))
}

/// Finds the top-level part of a document that cannot be parsed, since the parser only reports a column
/// of a line that is often the only one.
fn blame(document: &Value) -> String {
    let is_readable = |key: &str, part: &Value| {
        let mut alone = serialize::to_value(Root::default()).unwrap_or_default();
        alone[key] = part.clone();
        serialize::to_vec(&alone).is_ok_and(|text| Root::from_slice(&text).is_ok())
    };
    for (key, part) in document.as_object().into_iter().flatten() {
        if is_readable(key, part) {
            continue;
        }
        let items = part.as_array().map_or(&[][..], Vec::as_slice);
        let culprit = items.iter().position(|item| !is_readable(key, &Value::Array(vec![item.clone()])));
        return match culprit {
            Some(number) => format!("number {number} of {key}"),
            None => key.clone(),
        };
    }
    "the JSON".to_owned()
}

/// Finds an index that the parser would truncate to 32 bits, which would change it to another one;
/// `key` is the name of `value`.
fn find_oversized_index(value: &Value, key: &str) -> Option<String> {
    const HOLD_INDICES: &[&str] = &[
        "scene",
        "nodes",
        "children",
        "mesh",
        "camera",
        "skin",
        "joints",
        "inverseBindMatrices",
        "targets",
        "material",
        "attributes",
        "indices",
        "bufferView",
        "buffer",
        "source",
        "index",
        "light",
        "componentType",
        "mode",
    ];
    match value {
        Value::Number(number) => {
            let oversized = number.as_u64().is_some_and(|number| number > u64::from(u32::MAX));
            (oversized && HOLD_INDICES.contains(&key)).then(String::new)
        }
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(position, item)| find_oversized_index(item, key).map(|rest| format!("/{position}{rest}"))),
        Value::Object(fields) => {
            fields.iter().filter(|(name, _)| *name != "extras").find_map(|(name, field)| {
                // The names within `attributes` and `targets` are those of vertex attributes.
                let key = if ["attributes", "targets"].contains(&key) { key } else { name };
                find_oversized_index(field, key).map(|rest| format!("/{name}{rest}"))
            })
        }
        _ => None,
    }
}

/// Adds what the parser requires although glTF does not, and removes what is not read here.
fn fill_in_optional(value: &mut Value) {
    if let Some(animations) = value.get_mut("animations").and_then(Value::as_array_mut) {
        for animation in animations {
            *animation = empty_animation();
        }
    }
    let scenes = value.get_mut("scenes").and_then(Value::as_array_mut);
    for scene in scenes.into_iter().flatten().filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
}

/// An animation without channels, so that it is still counted in the report.
fn empty_animation() -> Value {
    let nothing = || Value::Array(Vec::new());
    Value::Object([("channels".to_owned(), nothing()), ("samplers".to_owned(), nothing())].into_iter().collect())
}

fn check_version(root: &Root) -> Result<(), Fault> {
    let version = root.asset.min_version.as_deref().unwrap_or(&root.asset.version);
    // Later 2.x files are readable by readers of 2.0, unless `minVersion` says otherwise.
    let readable = match root.asset.min_version.as_deref() {
        Some(minimum) => minimum == "2.0",
        None => version.starts_with("2."),
    };
    if readable {
        return Ok(());
    }
    Err(Fault::new("asset", format!("is of version {version}"), "export the file as glTF 2.0"))
}
