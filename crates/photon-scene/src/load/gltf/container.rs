//! The outer layers of a file: the chunks of a GLB, the JSON, and the version.

use gltf::json::{Root, Value, deserialize, serialize};

use super::fault::{AGAIN, COPY_AGAIN, Fault};

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: &[u8] = b"JSON";
const BIN_CHUNK: &[u8] = b"BIN\0";

/// Takes the layers off: the document, and the binary chunk if there is one.
pub(super) fn open(bytes: &[u8]) -> Result<(Root, Option<&[u8]>), Fault> {
    if bytes.is_empty() {
        return Err(Fault::new("the file", "is empty", COPY_AGAIN));
    }
    let (json, bin) = if bytes.starts_with(MAGIC) { split_glb(bytes)? } else { (bytes, None) };
    let root = parse(json)?;
    check_version(&root)?;
    Ok((root, bin))
}

/// Splits a GLB into its JSON and its binary chunk (glTF 2.0 specification, section 4.4).
///
/// Not the parser's own splitter: that one subtracts before it compares, so that a length below 12
/// overflows, and it refuses the trailing chunks that the specification tells readers to skip.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let header = |why: String, mend| Fault::new("the GLB header", why, mend);
    let (Some(version), Some(length)) = (read_u32(bytes, 4), read_u32(bytes, 8)) else {
        let why = format!("needs 12 bytes, but the file has {}", bytes.len());
        return Err(header(why, COPY_AGAIN));
    };
    if version != 2 {
        return Err(header(format!("says version {version}"), "export the file as glTF 2.0"));
    }
    let Some(body) = bytes.get(..length as usize) else {
        let why = format!("promises {length} bytes, but the file has {}", bytes.len());
        return Err(header(why, COPY_AGAIN));
    };
    let (kind, json, mut rest) = split_chunk(body.get(12..).unwrap_or_default())?;
    if kind != JSON_CHUNK {
        return Err(Fault::new(
            "the first GLB chunk",
            format!("is of type {kind:02x?}, but must be JSON"),
            AGAIN,
        ));
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

/// The type, the contents and what follows of a chunk.
type Chunk<'a> = (&'a [u8], &'a [u8], &'a [u8]);

/// Splits off the chunk at the front of `bytes`.
fn split_chunk(bytes: &[u8]) -> Result<Chunk<'_>, Fault> {
    let broken = |why: String| Fault::new("a GLB chunk", why, COPY_AGAIN);
    let (Some(length), Some(kind), Some(contents)) =
        (read_u32(bytes, 0), bytes.get(4..8), bytes.get(8..))
    else {
        return Err(broken(format!(
            "needs a header of 8 bytes, but {} are left",
            bytes.len()
        )));
    };
    match contents.split_at_checked(length as usize) {
        Some((data, rest)) => Ok((kind, data, rest)),
        None => Err(broken(format!(
            "promises {length} bytes, but {} are left",
            contents.len()
        ))),
    }
}

fn read_u32(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// The document that the JSON text describes.
fn parse(json: &[u8]) -> Result<Root, Fault> {
    let wrong = |error: gltf::json::Error| {
        Fault::new("the JSON", error.to_string(), "the file is damaged, or it is not a glTF file")
            .at_line(error.line())
    };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let mut value: Value = deserialize::from_slice(json).map_err(wrong)?;
    if let Some(place) = find_oversized_index(&value, false) {
        return Err(Fault::new(
            place.trim_start_matches('/'),
            "is above 4294967295, which no index can be",
            AGAIN,
        ));
    }
    Root::from_slice(json).or_else(|error| {
        // The parser asks for some things that the specification leaves out freely. The message
        // stays that of the original text, whose line numbers are the user's.
        fill_in_optional(&mut value);
        let filled = serialize::to_vec(&value).map_err(wrong)?;
        Root::from_slice(&filled).map_err(|_| wrong(error))
    })
}

/// Where an index stands that the parser would cut down to 32 bits, and so turn into another one.
fn find_oversized_index(value: &Value, is_index: bool) -> Option<String> {
    const HOLD_INDICES: &[&str] = &[
        "scene", "nodes", "children", "mesh", "camera", "skin", "skeleton", "joints", "material",
        "indices", "bufferView", "buffer", "source", "sampler", "index", "light", "componentType",
        "mode", "attributes",
    ];
    match value {
        Value::Number(number) => {
            let oversized = number.as_u64().is_some_and(|number| number > u64::from(u32::MAX));
            (is_index && oversized).then(String::new)
        }
        Value::Array(items) => items.iter().enumerate().find_map(|(position, item)| {
            find_oversized_index(item, is_index).map(|rest| format!("/{position}{rest}"))
        }),
        Value::Object(fields) => {
            fields.iter().filter(|(key, _)| *key != "extras").find_map(|(key, field)| {
                // The numbers of `attributes` stand one level below it.
                let holds = HOLD_INDICES.contains(&key.as_str())
                    || (is_index && matches!(field, Value::Number(_)));
                find_oversized_index(field, holds).map(|rest| format!("/{key}{rest}"))
            })
        }
        _ => None,
    }
}

/// Adds what the parser insists on though glTF does not, and takes away what is not read here.
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

/// An animation without channels: it still counts in the report.
fn empty_animation() -> Value {
    let nothing = || Value::Array(Vec::new());
    Value::Object(
        [("channels".to_owned(), nothing()), ("samplers".to_owned(), nothing())]
            .into_iter()
            .collect(),
    )
}

fn check_version(root: &Root) -> Result<(), Fault> {
    let version = root.asset.min_version.as_deref().unwrap_or(&root.asset.version);
    // Later 2.x files are made to be readable by readers of 2.0, unless `minVersion` says otherwise.
    let readable = match root.asset.min_version.as_deref() {
        Some(minimum) => minimum == "2.0",
        None => version.starts_with("2."),
    };
    if readable {
        return Ok(());
    }
    Err(Fault::new("asset", format!("is of version {version}"), "export the file as glTF 2.0"))
}
