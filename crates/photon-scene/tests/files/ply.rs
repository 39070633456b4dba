//! PLY.

use crate::support::{Folder, corners, message, names};
use photon_core::octahedral;
use photon_scene::{load, load_ply};

/// A PLY file of a quadrilateral and a triangle in any of the three encodings.
fn ply(format: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nelement vertex 5\nproperty float x\nproperty double y\n\
         property short z\nproperty uchar red\nelement face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    let vertices: [(f32, f64, i16); 5] = [(0.0, 0.0, 0), (1.0, 0.0, 0), (1.0, 2.5, 0), (0.0, 2.5, 0), (0.5, 4.0, 1)];
    let faces: [&[i32]; 2] = [&[0, 1, 2, 3], &[3, 2, 4]];
    let big = format == "binary_big_endian";
    macro_rules! put {
        ($value:expr) => {
            bytes.extend(if big { $value.to_be_bytes().to_vec() } else { $value.to_le_bytes().to_vec() })
        };
    }
    for (x, y, z) in vertices {
        if format == "ascii" {
            bytes.extend(format!("{x} {y} {z} 7\n").into_bytes());
        } else {
            put!(x);
            put!(y);
            put!(z);
            bytes.push(7);
        }
    }
    for face in faces {
        if format == "ascii" {
            let list: Vec<String> = face.iter().map(i32::to_string).collect();
            bytes.extend(format!("1 {} {}\n", face.len(), list.join(" ")).into_bytes());
        } else {
            bytes.extend([1, face.len() as u8]);
            for index in face {
                put!(index);
            }
        }
    }
    bytes
}

#[test]
fn ply_in_three_encodings() {
    let folder = Folder::new("ply");
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let path = folder.file("bunny.ply", ply(format));
        let (scene, report) = load(&path, None).expect(format);
        let triangles: Vec<_> = (0..scene.view().triangles.len()).map(|index| corners(&scene, index)).collect();
        let (a, b, c, d) = ([0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.5, 0.0], [0.0, 2.5, 0.0]);
        assert_eq!(triangles, [[a, b, c], [a, c, d], [d, c, [0.5, 4.0, 1.0]]], "{format}");
        names(&report.to_string(), &["mesh 'bunny'", "grey of 0.5"]);
    }
}

#[test]
fn ply_strips_alternate() {
    let folder = Folder::new("strips");
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 1 4 3\n";
    let (scene, _) = load(&folder.file("strip.ply", text), None).expect("strips");
    assert_eq!(scene.view().triangles.len(), 3);
    assert!(scene.view().primitives.iter().all(|primitive| primitive.normal == [0.0, 0.0, 1.0]), "all face one way");
}

#[test]
fn ply_faults() {
    let folder = Folder::new("ply-faults");
    let fault = |content: &[u8]| message(load_ply(&folder.file("a.ply", content)));
    let whole = ply("binary_little_endian");
    for length in [0, 3, 60, whole.len() - 40, whole.len() - 1] {
        names(&fault(&whole[..length]), &["a.ply", "truncated or damaged"]);
    }
    let ascii = String::from_utf8(ply("ascii")).expect("ASCII");
    names(&fault(ascii.replace("3 2 4", "3 2 5").as_bytes()), &["face 1", "vertex 5", "there are 5"]);
    names(&fault(ascii.replace("3 3 2 4", "2 3 2").as_bytes()), &["face 1 has 2 corners"]);
    names(&fault(ascii.replace("0.5 4 1", "0.5 four 1").as_bytes()), &["a.ply, line"]);
    names(&fault(ascii.replace("property short z", "property short w").as_bytes()), &["vertex 0", "x, y and z"]);
    names(&fault(ascii.replace("vertex 5", "vertex 99999999999").as_bytes()), &["99999999999 elements 'vertex'"]);
    let hollow = "ply\nformat binary_little_endian 1.0\nelement air 9000000000000\nend_header\n";
    names(&fault(hollow.as_bytes()), &["'air'", "more than the file can hold"]);
    let infinite = ascii.replace("0.5 4 1", "0.5 inf 1");
    names(&message(load(&folder.file("b.ply", infinite), None)), &["b.ply, line 17", "0.5 inf 1"]);
    // The first vertex's first coordinate, after the header.
    let mut binary = ply("binary_little_endian");
    let start = binary.windows(11).position(|bytes| bytes == b"end_header\n").expect("a header") + 11;
    binary[start..start + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    names(&message(load(&folder.file("b.ply", binary), None)), &["mesh 'b'", "vertex 0", "NaN"]);
}

/// Integers are sRGB, floats linear; texture coordinates are turned over; all of it only where it is complete.
#[test]
fn ply_attributes() {
    let folder = Folder::new("ply-attributes");
    let file = |properties: &str, rows: [&str; 3]| {
        let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
        let rows = ["0 0 0", "1 0 0", "0 1 0"].into_iter().zip(rows).map(|(at, rest)| format!("{at} {rest}\n"));
        let rows: String = rows.collect();
        let faces = "element face 1\nproperty list int int vertex_indices\nend_header\n";
        let path = folder.file("a.ply", format!("{header}{properties}{faces}{rows}3 0 1 2\n"));
        load(&path, None).unwrap_or_else(|error| panic!("{error}"))
    };
    let normals = "property float nx\nproperty float ny\nproperty float nz\n";
    let (scene, report) = file(normals, ["0 0 1", "0 1 1", "0 0 1"]);
    let tilted = octahedral::unpack(scene.view().shading.normals[0][1]);
    assert!((tilted.y - 0.5_f32.sqrt()).abs() < 1e-4 && !report.to_string().contains("normals"), "{report}");
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    let (scene, report) = file(colors, ["255 128 0 9", "255 255 255 0", "0 0 0 0"]);
    let half = (0.215_860_5_f64 * 65_535.0).round() as u32;
    assert_eq!(scene.view().shading.colors[0][0][0], half << 16 | 0xFFFF);
    assert_eq!(scene.view().materials[0].albedo, [1.0; 3]);
    assert!(report.is_exact(), "{report}");
    let linear = colors.replace("uchar", "float");
    let (scene, _) = file(&linear, ["1 0.5 0 0", "1 1 1 0", "2 1e-9 -1 0"]);
    assert_eq!(scene.view().shading.colors[0].map(|color| color[0]), [0x8000_FFFF, u32::MAX, 0x0000_FFFF]);
    // Two channels of three are no colour.
    let (scene, report) = file("property uchar red\nproperty uchar blue\n", ["1 2", "3 4", "5 6"]);
    assert!(scene.view().shading.colors.is_empty() && report.to_string().contains("grey of 0.5"), "{report}");
    let builder = |text: &str| photon_scene::load_ply(&folder.file("b.ply", text)).map(drop);
    assert!(builder("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty list int int s\nend_header\n0 0 0 1 5\n").is_ok());
}
