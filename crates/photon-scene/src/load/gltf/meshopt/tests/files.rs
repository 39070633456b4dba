//! Files with compressed buffer views.

use super::super::super::tests::file::{File, data_uri, says};
use super::bytes;
use super::streams::{ATTRIBUTES, INDICES};

/// Positions of the records as three halves of 16 bits, and triangles, both only as compressed streams; `extension` and
/// `stream` can be damaged.
fn file(name: &str, change: impl Fn(String) -> String) -> File {
    let (count, records) = ATTRIBUTES[5];
    let (records, triangles) = (bytes(records), bytes(INDICES[2].0[0]));
    let all = [&records[..], &triangles[..]].concat();
    let views = format!(
        r#"[{{"buffer": 1, "byteLength": {}, "byteStride": 12, "extensions": {{"{name}": {{"buffer": 0, "byteLength": {}, "byteStride": 12, "count": {count}, "mode": "ATTRIBUTES"}}}}}},
            {{"buffer": 1, "byteOffset": 480, "byteLength": 60, "extensions": {{"{name}": {{"buffer": 0, "byteOffset": {}, "byteLength": {}, "byteStride": 4, "count": 15, "mode": "TRIANGLES", "filter": "NONE"}}}}}}]"#,
        12 * count,
        records.len(),
        records.len(),
        triangles.len()
    );
    File::new()
        .with("extensionsUsed", format!(r#"["{name}", "KHR_mesh_quantization"]"#))
        .with("extensionsRequired", format!(r#"["{name}", "KHR_mesh_quantization"]"#))
        .with(
            "buffers",
            format!(
                r#"[{{"byteLength": {}, "uri": "{}"}}, {{"byteLength": 540, "extensions": {{"{name}": {{"fallback": true}}}}}}]"#,
                all.len(),
                data_uri("application/octet-stream", &all)
            ),
        )
        .with("bufferViews", change(views))
        .with(
            "accessors",
            r#"[{"bufferView": 0, "componentType": 5123, "count": 40, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5125, "count": 15, "type": "SCALAR"}]"#,
        )
        .material(r#""pbrMetallicRoughness": {"metallicFactor": 0}"#)
}

#[test]
fn meshes_are_read_from_compressed_views_under_both_names() {
    for name in super::super::NAMES {
        let (builder, report) = file(name, |views| views).load();
        assert!(report.is_exact(), "{report}");
        let mesh = &builder.meshes[0];
        // The third integer is the lower half of the float 0.25 i − 3.
        let corners = mesh.triangles.as_flattened().iter().map(|&corner| mesh.positions[corner as usize]);
        let expected = INDICES[2].1[0].iter().map(|&i| [f64::from(3 * i + 5), f64::from(i * i), 0.0]);
        assert!(corners.eq(expected), "{:?}", mesh.positions);
    }
}

#[test]
fn wrong_parameters_and_streams_are_refused_by_name() {
    let name = "EXT_meshopt_compression";
    for (from, to, words) in [
        (r#""mode": "ATTRIBUTES""#, r#""mode": "STRIPS""#, ["buffer view 0", "STRIPS"]),
        (r#""mode": "ATTRIBUTES""#, r#""mode": "INDICES""#, ["buffer view 0", "stride of 12"]),
        (r#""filter": "NONE""#, r#""filter": "QUATERNION""#, ["buffer view 1", "Quaternion"]),
        (r#""count": 15"#, r#""count": 12"#, ["buffer view 1", "do not fill"]),
        (r#""count": 15, "#, "", ["buffer view 1", "count"]),
        (r#""byteStride": 4"#, r#""byteStride": -4"#, ["buffer view 1", "-4"]),
        (r#"{"buffer": 0, "byteOffset""#, r#"{"buffer": 5, "byteOffset""#, ["buffer view 1", "buffer 5"]),
        (r#"{"buffer": 0, "byteOffset""#, r#"{"buffer": 1, "byteOffset""#, ["buffer 1", "no URI"]),
        (r#""byteLength": 195"#, r#""byteLength": 194"#, ["buffer view 0", "is no valid stream"]),
        (r#""byteLength": 195"#, r#""byteLength": 1950"#, ["buffer view 0", "1950 bytes"]),
        (r#""byteOffset": 195"#, r#""byteOffset": 0"#, ["buffer view 1", "not that of triangles"]),
    ] {
        let damaged = file(name, |views| {
            assert!(views.contains(from), "{from} in {views}");
            views.replacen(from, to, 1)
        });
        let error = damaged.error();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?} not all in: {error}");
    }
    // Many views of the same bytes.
    let zeros = File::new()
        .with(
            "bufferViews",
            r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteLength": 60, "byteOffset": 99999}]"#,
        )
        .with("extensionsUsed", r#"["EXT_meshopt_compression"]"#);
    assert!(zeros.error().contains("buffer view 1"));
    assert!(!says(&file(name, |views| views).load().1, "file", "meshopt"));
}
