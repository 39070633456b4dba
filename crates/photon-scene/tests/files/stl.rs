//! STL.

use crate::support::{Folder, corners, message, names};
use photon_scene::{LoadOptions, SceneError, load, load_builder_with, load_stl};

/// The triangles of a tetrahedron, from the outside.
const TETRAHEDRON: [[[f32; 3]; 3]; 4] = {
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
};

fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let (u, v): ([f32; 3], [f32; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|part| part * part).sum::<f32>().sqrt();
    cross.map(|part| part / length)
}

fn text(name: &str) -> String {
    let row = |[x, y, z]: [f32; 3]| format!("{x} {y} {z:e}");
    let facet = |triangle: &[[f32; 3]; 3]| {
        let [a, b, c] = triangle.map(row);
        let normal = row(normal(*triangle));
        format!(
            "  facet normal {normal}\n    outer loop\n      vertex {a}\n      vertex {b}\n      vertex {c}\n    endloop\n  endfacet\n"
        )
    };
    format!("solid {name}\n{}endsolid {name}\n", TETRAHEDRON.iter().map(facet).collect::<String>())
}

fn binary(header: &str) -> Vec<u8> {
    let mut bytes = format!("{header:80}").into_bytes();
    bytes.extend(4_u32.to_le_bytes());
    for triangle in TETRAHEDRON {
        let numbers = normal(triangle).into_iter().chain(triangle.into_iter().flatten());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Text and binary give the same scene, whatever a binary header begins with.
#[test]
fn both_kinds_of_stl() {
    let folder = Folder::new("stl");
    let padded = |header: &str| [binary(header), vec![0; 7]].concat();
    for (bytes, rest) in [
        (text("tip").into_bytes(), false),
        (text("").replace('\n', "\r\n").to_uppercase().into_bytes(), false),
        (format!("\u{feff}\n{}\0\0", text("tip").replace('\n', "\r")).into_bytes(), false),
        (text("facet wörl").into_bytes(), false),
        (binary("made by a test"), false),
        (binary("solid made by a test"), false),
        (binary("{ \"made\": \"by a test\" }"), false),
        (padded("made by a test"), true),
    ] {
        let path = folder.file("tip.stl", &bytes);
        let (scene, report) = load(&path, None).unwrap_or_else(|error| panic!("{bytes:?}: {error}"));
        let found: Vec<_> = (0..4).map(|triangle| corners(&scene, triangle)).collect();
        assert_eq!(found, TETRAHEDRON.map(|triangle| triangle.map(|corner| corner.map(f64::from))));
        assert_eq!((scene.view().triangles.len(), scene.view().positions.len()), (4, 4), "vertices are shared");
        names(&report.to_string(), &["grey of 0.5"]);
        assert_eq!((report.is_exact(), report.to_string().contains("7 bytes behind")), (!rest, rest), "{report}");
    }
}

/// Solids are meshes of their own; what is not read has a line.
#[test]
fn stl_reports_what_it_leaves_out() {
    let folder = Folder::new("stl-report");
    let two = text("first part") + &text("") + "solid empty\nendsolid empty\n";
    let (scene, report) = load(&folder.file("a.stl", two), None).expect("two solids");
    assert!(report.is_exact(), "{report}");
    assert_eq!(scene.mesh_names().collect::<Vec<_>>(), ["first part", "a"]);

    let turned = text("a").replace("facet normal 0 0 -1e0", "facet normal 0 0 1").replace("normal 0 -1", "normal 0 0");
    let (_, report) = load_stl(&folder.file("a.stl", turned)).expect("turned");
    names(&report.to_string(), &["the normals of 1 of its 4 triangles do not agree"]);
    assert!(report.is_exact(), "{report}");

    let mut colored = binary("COLOR=");
    colored[84 + 48] = 0x1F;
    let (_, report) = load_stl(&folder.file("a.stl", colored)).expect("colours");
    names(&report.to_string(), &["left out: mesh 'a': the attributes, perhaps colours, of 1 triangles"]);

    let (scene, report) = load(&folder.file("a.stl", "solid\nendsolid\n"), None).expect("nothing");
    names(&report.to_string(), &["it has no triangles"]);
    assert!(scene.view().triangles.is_empty());
}

#[test]
fn stl_faults() {
    let folder = Folder::new("stl-faults");
    let fault = |bytes: &[u8]| message(load_stl(&folder.file("a.stl", bytes)));
    let whole = text("a");
    for (from, to, part) in [
        ("vertex 0 2 0e0", "vertex 0 2 two", "line 5: triangle 0: 'two' is no number"),
        ("    endloop\n", "", "line 7: triangle 0: 'endfacet' is in place of 'endloop'"),
        ("outer loop", "inner loop", "line 3: triangle 0: 'inner' is in place of 'outer'"),
        ("endsolid a", "", "ends within a solid, without 'endsolid'"),
        ("solid a\n", "solid a\nsolid b\n", "line 2: 'solid' is in place of 'facet' or 'endsolid'"),
        ("endsolid a\n", "endsolid a\nmore", "line 31: 'more' is in place of 'solid'"),
        ("vertex 0 2 0e0", "vertex 0 nan 0", "triangle 0 has a corner at [0.0, NaN, 0.0]; each coordinate"),
    ] {
        assert!(whole.contains(from), "{from}: {whole}");
        names(&fault(whole.replacen(from, to, 1).as_bytes()), &["a.stl", part]);
    }
    names(&fault(&whole.as_bytes()[..whole.len() / 2]), &["triangle 2: the file ends in place of", "truncated"]);
    let whole = binary("a");
    names(&fault(&whole[..whole.len() - 1]), &["declares 4 triangles, of which the file can hold 3", "truncated"]);
    names(&fault(&whole[..84]), &["declares 4 triangles, of which the file can hold 0"]);
    names(&fault(&whole[..60]), &["a.stl", "neither a text that begins with 'solid' nor a binary file"]);
    let mut huge = whole.clone();
    huge[80..84].fill(0xFF);
    names(&fault(&huge), &["declares 4294967295 triangles, of which the file can hold 4"]);
    let mut infinite = whole.clone();
    infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    names(&fault(&infinite), &["triangle 1 has a corner at [inf,"]);
    let error = load_stl(&folder.file("a.stl", b"version https://git-lfs.github.com/spec/v1\n")).map(drop).unwrap_err();
    assert!(matches!(error, SceneError::OtherKind { .. }), "{error}");
    let options = LoadOptions::default().with_memory(Some(500));
    let path = folder.file("a.stl", &whole);
    names(&message(load_builder_with(&path, None, &options)), &["a.stl: reading its triangles needs"]);
}

/// Bytes that were changed at random give an error or a scene, within little memory.
#[test]
fn damaged_stl_is_harmless() {
    let folder = Folder::new("stl-damage");
    let options = LoadOptions::default().with_memory(Some(1 << 20));
    // A linear congruential generator.
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut sound, mut refused) = (0, 0);
    for round in 0..1000 {
        let mut bytes = if round % 2 == 0 { text("a").into_bytes() } else { binary("solid a") };
        for _ in 0..1 + next(4) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = next(256) as u8,
                1 => bytes.truncate(at.max(1)),
                _ => bytes[at] ^= 1 << next(8),
            }
        }
        match load_builder_with(&folder.file("a.stl", &bytes), None, &options).and_then(|(scene, _)| scene.build()) {
            Ok(scene) => sound += usize::from(scene.view().triangles.len() <= 4),
            Err(error) => {
                refused +=
                    usize::from(error.to_string().contains("a.stl: ") || error.to_string().contains("a.stl, line"))
            }
        }
    }
    assert!(sound + refused == 1000 && sound > 100 && refused > 100, "{sound} {refused}");
}
