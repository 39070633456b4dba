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
    for length in [3, 60, whole.len() - 40, whole.len() - 1] {
        names(&fault(&whole[..length]), &["a.ply", "truncated or damaged"]);
    }
    let ascii = String::from_utf8(ply("ascii")).expect("ASCII");
    names(&fault(ascii.replace("3 2 4", "3 2 5").as_bytes()), &["face 1", "vertex 5", "there are 5"]);
    names(&fault(ascii.replace("0.5 4 1", "0.5 four 1").as_bytes()), &["a.ply, line"]);
    names(&fault(ascii.replace("property short z", "property short w").as_bytes()), &["no x, y and z"]);
    names(&fault(ascii.replace("vertex 5", "vertex 99999999999").as_bytes()), &["99999999999 elements 'vertex'"]);
    let hollow = "ply\nformat binary_little_endian 1.0\nelement air 9000000000000\nend_header\n";
    names(&fault(hollow.as_bytes()), &["'air'", "more than the file can hold"]);
    for (from, to, part) in [
        ("property short z", "property half z", "line 7: 'property half z': there is no type half"),
        ("element face 2", "element vertex 2", "it is declared twice"),
        ("format ascii", "format binary", "a format is ascii,"),
        ("format ascii 1.0\n", "", "has no format"),
        ("list uchar int", "list float int", "must have the type of an integer"),
        ("vertex_indices", "corners", "its faces have no list vertex_indices"),
        ("comment made", "made", "'made by a test': no keyword"),
        ("1 3 3 2 4", "1 -3 3 2 4", "a list of -3 numbers"),
        ("1 3 3 2 4", "1 3 3 2.5 4", "vertex 2.5"),
        ("0 0 0 7", "0 0 0 7 1", "more numbers than the header says"),
    ] {
        assert!(ascii.contains(from), "{from}");
        names(&fault(ascii.replace(from, to).as_bytes()), &["a.ply", part]);
    }
    names(&fault(b"\x1F\x8B\x08"), &["compressed by gzip"]);
    let infinite = ascii.replace("0.5 4 1", "0.5 inf 1");
    names(
        &message(load(&folder.file("b.ply", infinite), None)),
        &["b.ply", "face 1 uses vertex 4", "inf", "finite number"],
    );
    // The first vertex's first coordinate, after the header.
    let mut binary = ply("binary_little_endian");
    let start = binary.windows(11).position(|bytes| bytes == b"end_header\n").expect("a header") + 11;
    binary[start..start + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    names(&message(load(&folder.file("b.ply", binary), None)), &["b.ply", "face 0 uses vertex 0", "NaN"]);
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

const TRIANGLE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                        element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                        0 0 0\n1 0 0\n0 1 0\n9 9 9\n3 0 1 2\n";

/// Spellings of one triangle that other programs read.
#[test]
fn ply_spellings() {
    let folder = Folder::new("ply-spellings");
    let short = |kind: &str| TRIANGLE.replace("uchar int vertex_indices", kind);
    let [first, second, third] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let (header, rows) = TRIANGLE.split_at(TRIANGLE.find("0 0 0\n").expect("rows"));
    for (text, line) in [
        (TRIANGLE.replace('\n', "\r"), ""),
        (TRIANGLE.replace('\n', "\r\n"), ""),
        (format!("\u{feff}{TRIANGLE}"), ""),
        (TRIANGLE.replace("0 0 0\n1 0 0\n", "0 0\n 0 1 0\n\n0 "), ""),
        (short("uint64 uint64 vertex_index"), ""),
        (short("int8 int64 vertex_index"), ""),
        (short("uint8 double vertex_index"), ""),
        (TRIANGLE.replace("9 9 9", "nan -nan(ind) inf"), ""),
        (format!("{header}{}", rows.replace("3 0 1 2", "3 0 1 2 \n\n")), ""),
        (format!("{TRIANGLE}1 2\n"), "2 numbers behind the last element"),
        (
            TRIANGLE.replace("face 1", "face 2").replace("3 0", "2 0 1\n3 0"),
            "1 faces of fewer than three corners, the first is face 0",
        ),
        (
            TRIANGLE
                .replace("element face", "element edge 1\nproperty int a\nproperty list int int b\nelement face")
                .replace("3 0", "7 2 8 9\n3 0"),
            "1 elements 'edge'",
        ),
        (
            TRIANGLE
                .replace("element face", "property int flags\nproperty float q\nelement face")
                .replace(" 0\n", " 0 1 2\n")
                .replace("9 9 9", "9 9 9 1 2"),
            "properties of its elements 'vertex': flags, q",
        ),
    ] {
        let (scene, report) =
            load(&folder.file("a.ply", &text), None).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(scene.view().triangles.len(), 1, "{text}");
        assert_eq!(corners(&scene, 0), [first, second, third], "{text}");
        names(&report.to_string(), &[line]);
        assert_eq!(report.is_exact(), line.is_empty(), "{report}");
    }
    let bow = TRIANGLE.replace("9 9 9", "1 1 0").replace("3 0 1 2", "4 0 3 1 2");
    let (_, report) = load(&folder.file("bow.ply", bow), None).expect("a mesh");
    names(&report.to_string(), &["mesh 'bow'", "1 polygons cross themselves, the first is face 0"]);
}

/// Two triangles of a square; the attributes of faces and their corners stay apart, and alpha and wide colours are said.
#[test]
fn ply_attributes_of_faces() {
    let folder = Folder::new("ply-faces");
    folder.file("a.png", crate::obj_textures::png(&[[255, 0, 0], [0, 0, 255]]));
    let file = |comment: &str, vertex: &str, values: [&str; 4], face: &str, rows: [&str; 2]| {
        let at =
            ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].into_iter().zip(values).map(|(at, rest)| format!("{at} {rest}\n"));
        let text = format!(
            "ply\nformat ascii 1.0\n{comment}element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             {vertex}element face 2\nproperty list uchar int vertex_indices\n{face}end_header\n{}3 0 1 2 {}\n3 0 2 3 {}\n",
            at.collect::<String>(),
            rows[0],
            rows[1]
        );
        load(&folder.file("a.ply", &text), None).unwrap_or_else(|error| panic!("{text}: {error}"))
    };
    let none = [""; 4];
    let rgb = |kind: &str| ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
    let colors =
        |scene: &photon_scene::Scene| scene.view().shading.colors.iter().map(|three| three[0]).collect::<Vec<_>>();
    let (red, half) = ([0xFFFF, 0xFFFF_0000], (0.215_860_5_f64 * 65_535.0).round() as u32);

    let (scene, report) = file("", "", none, &rgb("uchar"), ["255 0 0", "0 128 0"]);
    assert_eq!(colors(&scene), [red, [half << 16, 0xFFFF_0000]]);
    assert!(report.is_exact() && scene.view().materials[0].albedo == [1.0; 3], "{report}");
    let (scene, report) = file("", "", none, &rgb("float"), ["255 0 0", "0 128 0"]);
    assert_eq!(colors(&scene), [red, [half << 16, 0xFFFF_0000]]);
    names(
        &report.to_string(),
        &["approximated: mesh 'a': its colours go beyond 1; they are taken as sRGB from 0 to 255"],
    );
    let (scene, report) = file("", &rgb("int"), ["255 0 0"; 4], &rgb("uchar"), ["0 0 0"; 2]);
    assert_eq!(colors(&scene), [red; 2]);
    names(
        &report.to_string(),
        &["wide integers, are taken as numbers from 0 to 255", "left out: mesh 'a': the colours or alpha of its faces"],
    );
    let (scene, _) = file("", &rgb("ushort"), ["65535 0 0"; 4], "", [""; 2]);
    assert_eq!(colors(&scene), [red; 2]);

    let alpha = "property uchar alpha\n";
    let (scene, report) = file("", alpha, ["255", "51", "255", "255"], "", [""; 2]);
    assert!(scene.view().materials[0].has_alpha() && report.is_exact(), "{report}");
    assert_eq!(scene.view().materials[0].albedo, [0.5; 3]);
    let (scene, report) = file("", alpha, ["0"; 4], "", [""; 2]);
    assert!(!scene.view().materials[0].has_alpha());
    names(&report.to_string(), &["approximated: mesh 'a': its alpha is 0 everywhere"]);

    let image = "comment TextureFile a.png\n";
    let corners = "property list uchar float texcoord\n";
    let (scene, report) = file(image, "", none, corners, ["6 0 0 1 0 1 1", "6 0 0.25 1 1 0 1"]);
    assert_eq!(scene.view().shading.textures.len(), 1);
    assert_eq!(
        scene.view().shading.uvs[..],
        [[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], [[0.0, 0.75], [1.0, 0.0], [0.0, 0.0]]]
    );
    assert!(report.is_exact() && scene.view().materials[0].albedo == [1.0; 3], "{report}");
    let (scene, report) =
        file(image, "property float s\nproperty float t\n", ["0 0", "1 0", "1 1", "0 1"], "", [""; 2]);
    assert_eq!(scene.view().shading.uvs[0], [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
    assert!(report.is_exact() && scene.view().shading.textures.len() == 1, "{report}");
    let (_, report) = file(image, "", none, corners, ["6 0 0 1 0 1 1", "4 0 0 1 1"]);
    names(
        &report.to_string(),
        &["the texture coordinates of 1 faces", "1 of its triangles have no texture coordinates"],
    );
    for (name, why) in [("gone.png", "does not exist"), ("../a.png", "outside the folder")] {
        let comment = format!("comment TextureFile {name}\n");
        let (_, report) = file(&comment, "", none, corners, ["6 0 0 1 0 1 1"; 2]);
        names(&report.to_string(), &["left out: mesh 'a': its texture", name, why]);
    }
    let (_, report) = file(image, "", none, "", [""; 2]);
    names(&report.to_string(), &["left out: mesh 'a': its textures a.png, since it has no texture coordinates"]);
    // Two images, by the numbers of the faces.
    let two = format!("{image}comment TextureFile a.png\n");
    let numbered = format!("{corners}property int texnumber\n");
    let (_, report) = file(image, "", none, &numbered, ["6 0 0 1 0 1 1 0", "6 0 0 1 1 0 1 7"]);
    names(&report.to_string(), &["approximated: mesh 'a': 1 of its faces have a number of an image (texnumber)"]);
    let (scene, report) = file(&two, "", none, &numbered, ["6 0 0 1 0 1 1 1", "6 0 0 1 1 0 1 0"]);
    assert!(scene.material_names().eq(["default", "a.png"]) && report.is_exact(), "{report}");
    let of = |primitive: &photon_core::Primitive| primitive.material;
    let mut materials: Vec<_> = scene.triangle_sources().zip(scene.view().primitives.iter().map(of)).collect();
    materials.sort_unstable();
    assert_eq!(materials, [((0, 0), 0), ((1, 0), 1)]);
}

/// A grid of more elements than a thread reads at a time; faces with `flags` are read one after another.
fn grid(is_big: bool, has_flags: bool, last: i32) -> Vec<u8> {
    const SIDE: i32 = 150;
    let (format, flags) =
        (if is_big { "big" } else { "little" }, if has_flags { "property uchar flags\n" } else { "" });
    let faces = 2 * (SIDE - 1) * (SIDE - 1);
    let header = format!(
        "ply\nformat binary_{format}_endian 1.0\nelement vertex {}\nproperty float y\nproperty double x\nproperty short z\n\
         element face {faces}\nproperty list uchar int vertex_indices\n{flags}end_header\n",
        SIDE * SIDE
    );
    let mut bytes = header.into_bytes();
    macro_rules! put {
        ($value:expr) => {
            bytes.extend(if is_big { $value.to_be_bytes() } else { $value.to_le_bytes() })
        };
    }
    for vertex in 0..SIDE * SIDE {
        put!((vertex / SIDE) as f32);
        put!(f64::from(vertex % SIDE) + 0.25);
        put!((vertex % 7) as i16);
    }
    for face in 0..faces {
        let corner = face / 2 / (SIDE - 1) * SIDE + face / 2 % (SIDE - 1);
        let [b, c] = if face % 2 == 0 { [1, SIDE + 1] } else { [SIDE + 1, SIDE] };
        bytes.push(3);
        put!(corner);
        put!(corner + b);
        put!(if face + 1 == faces { last } else { corner + c });
        bytes.extend(has_flags.then_some(9));
    }
    bytes
}

#[test]
fn large_binary_files_are_read_by_several_threads() {
    let folder = Folder::new("ply-large");
    let last = 150 * 150 - 2;
    let whole = |is_big, has_flags| load(&folder.file("a.ply", grid(is_big, has_flags, last)), None).expect("a grid").0;
    let expected = whole(false, true);
    assert_eq!(expected.view().triangles.len(), 2 * 149 * 149);
    assert_eq!(
        corners(&expected, 2 * 149 * 149 - 1),
        [[148.25, 148.0, 4.0], [149.25, 149.0, 1.0], [148.25, 149.0, 0.0]]
    );
    for is_big in [false, true] {
        let scene = whole(is_big, false);
        assert!(scene.view().triangles == expected.view().triangles, "{is_big}");
        assert!(scene.view().positions == expected.view().positions, "{is_big}");
        for wrong in [-1, 150 * 150] {
            let path = folder.file("a.ply", grid(is_big, false, wrong));
            names(&message(load_ply(&path)), &["face 44401", &format!("vertex {wrong}"), "there are 22500"]);
        }
    }
}
