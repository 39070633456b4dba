//! Files of the formats that are read, written by the tests themselves.

use photon_core::Material;
use photon_scene::{LoadReport, Overrides, ReportKind, Scene, SceneError, load, load_obj, load_ply};
use std::path::{Path, PathBuf};

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("photon-scene-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, content).expect("a temporary file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Left behind at worst.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn message<T>(result: Result<T, SceneError>) -> String {
    result.map(drop).expect_err("a fault").to_string()
}

fn names(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{message}' does not say '{part}'");
    }
}

fn material<'a>(scene: &'a Scene, name: &str) -> &'a Material {
    let index = scene.material_names().position(|known| known == name).expect("a material of that name");
    &scene.view().materials[index]
}

/// Corners of a triangle in user space.
fn corners(scene: &Scene, triangle: usize) -> [[f64; 3]; 3] {
    let view = scene.view();
    view.triangles[triangle].map(|vertex| {
        let at = scene.units().point_to_user(view.positions[vertex as usize]);
        at.map(|part| (part * 1e4).round() / 1e4)
    })
}

const MTL: &str = "
newmtl wall
Kd 0.6 0.5 0.4
newmtl lamp
Kd 0 0 0
Ke 5 4 3
newmtl shiny metal
illum 3
Ks 0.9 0.8 0.7
newmtl gem
illum 7
Ni 1.7
Tf 0.9 1 0.8
newmtl pane
d 0.2
Ni 1.4
newmtl glow
Ka 20 20 20
Kd 1 1 1
newmtl rough
Kd 0.3 0.3 0.3
Ks 0.2 0.2 0.2
Ns 30
map_Kd wood grain.png
Pr 0.4
";

const OBJ: &str = "
# a comment
mtllib scene materials.mtl
o room
v 0 0 0
v 2 0 0 1.0
v 2 2 0
v 0 2 0
vt 0 0
vn 0 0 1
usemtl wall
f 1/1/1 2/1/1 3/1/1 4/1/1
usemtl lamp
f -4 -3 \\
  -2
o things
usemtl shiny metal
f 1//1 2//1 3//1
usemtl gem
f 1 2 3
usemtl pane
f 1 2 3
usemtl rough
f 1 2 3
usemtl nowhere
f 2 3 4
l 1 2
";

#[test]
fn obj_and_mtl() {
    let folder = Folder::new("obj");
    folder.file("scene materials.mtl", MTL);
    let path = folder.file("scene.obj", OBJ);
    let (scene, report) = load(&path, None).expect("a scene");
    assert_eq!(scene.view().triangles.len(), 8);
    assert_eq!(corners(&scene, 0), [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0]]);
    assert_eq!(corners(&scene, 1), [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    assert_eq!(corners(&scene, 2), corners(&scene, 0), "counted from the end, over two lines");
    assert_eq!((scene.mesh_of_triangle(1), scene.mesh_of_triangle(3)), ("room", "things"));

    assert_eq!((material(&scene, "wall").kind, material(&scene, "wall").albedo), (Material::LAMBERT, [0.6, 0.5, 0.4]));
    assert_eq!(material(&scene, "shiny metal").kind, Material::MIRROR);
    assert_eq!(material(&scene, "shiny metal").albedo, [0.9, 0.8, 0.7]);
    let gem = material(&scene, "gem");
    assert_eq!((gem.kind, gem.ior, gem.albedo), (Material::DIELECTRIC, 1.7, [0.9, 1.0, 0.8]));
    assert_eq!((material(&scene, "pane").kind, material(&scene, "pane").ior), (Material::THIN, 1.4));
    assert_eq!(material(&scene, "default").albedo, [0.5; 3]);
    assert_eq!(scene.view().lights.len(), 1);
    let radiance = material(&scene, "lamp").emission.map(|part| f64::from(part) * scene.units().radiance_to_user());
    for (found, expected) in radiance.into_iter().zip([5.0, 4.0, 3.0]) {
        assert!((found - expected).abs() < 1e-5, "{radiance:?}");
    }

    let text = report.to_string();
    for line in [
        "approximated: material 'gem'",
        "approximated: material 'pane'",
        "left out: material 'glow': its Ka of [20.0, 20.0, 20.0]",
        "approximated: material 'rough': its glossy highlight",
        "left out: material 'rough': its textures (wood grain.png)",
        "left out: material 'rough': its statements Pr 0.4",
        "note: material 'lamp': emits [5.0, 4.0, 3.0]",
        "its material 'nowhere' is nowhere defined",
        "1 statements 'l'",
        "has no camera",
    ] {
        names(&text, &[line]);
    }
    assert!(!text.contains("'wall'") && !text.contains("smoothed"), "{text}");
    assert_eq!(scene.camera_names().collect::<Vec<_>>(), ["automatic"]);
}

#[test]
fn obj_says_what_it_approximates() {
    let folder = Folder::new("obj-notes");
    let report = |text: &str| load_obj(&folder.file("a.obj", text)).expect("a scene").1;
    let bare = report("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    names(&bare.to_string(), &["mesh 'a'", "no material"]);
    let dart = report("v 0 0 0\nv 1 1 0\nv 0 3 0\nv -1 1 0\nv 0 2 0\nf 5 4 1 2 3\nf 1 2 3 4\n");
    assert!(!dart.to_string().contains("not convex"), "{dart}");
    let dart = report("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n");
    names(&dart.to_string(), &["1 polygons are not convex, the first in line 5"]);
    let smooth = report("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 1\nf 1//1 2//1 3//1\n");
    names(&smooth.to_string(), &["1 polygons are smoothed"]);
    let colored = report("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 # all\n");
    names(&colored.to_string(), &["the colours of 1 vertices"]);
    let lost = report("mtllib gone.mtl\nusemtl a#b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    names(&lost.to_string(), &["gone.mtl'", "is not there", "'a#b' is nowhere defined"]);
    // Latin-1 is not UTF-8, and still a comment.
    let path = folder.file("latin.obj", b"# \xfc\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(load_obj(&path).is_ok());
}

#[test]
fn obj_faults_name_their_line() {
    let folder = Folder::new("obj-faults");
    let fault = |text: &str| message(load_obj(&folder.file("a.obj", text)));
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (face, word) in [
        ("1 2 4", "'4'"),
        ("0 1 2", "'0'"),
        ("-4 1 2", "'-4'"),
        ("1 2 x/1", "'x'"),
        ("1 2 99999999999999999999", "9999"),
    ] {
        names(&fault(&format!("{start}f 1 2 3\nf {face}\n")), &["a.obj, line 5", "face 2", word, "count from 1"]);
    }
    names(&fault(&format!("{start}f 1 2\n")), &["line 4", "face 1 has 2 corners"]);
    names(&fault("v 0 0 0\nv 1 nan 0\n"), &["line 2", "nan", "finite"]);
    names(&fault("v 0 0\n"), &["line 1", "nothing", "three finite numbers"]);
    // Wild references to what is not used do no harm.
    assert!(load_obj(&folder.file("b.obj", format!("vt 0 0\n{start}f 1/-9/-9 2/7/7 3//0\n"))).is_ok());
    for (statement, mend) in [
        ("Kd 1 x 0", "one number, or three"),
        ("Kd 1 1", "one number, or three"),
        ("Ke", "one number, or three"),
        ("Ni", "a number"),
        ("illum 2.5", "0 to 10"),
        ("newmtl", "a name"),
    ] {
        folder.file("bad.mtl", format!("newmtl a\n{statement}\n"));
        names(&fault("mtllib bad.mtl\n"), &["bad.mtl, line 2", &format!("'{statement}'"), mend]);
    }
    folder.file("bad.mtl", "Kd 1 1 1\n");
    names(&fault("mtllib bad.mtl\n"), &["bad.mtl, line 1", "newmtl"]);
    folder.file("bright.mtl", "newmtl bright\nKd 1.5 0 0\n");
    let bright = folder.file("bright.obj", format!("mtllib bright.mtl\nusemtl bright\n{start}f 1 2 3\n"));
    names(&message(load(&bright, None)), &["material 'bright'", "albedo", "1.5"]);
    let (scene, _) = load(&folder.file("empty.obj", ""), None).expect("nothing");
    assert!(scene.warnings()[0].contains("no triangles"));
}

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
        names(&report.to_string(), &["mesh 'bunny'", "grey of 0.5", "vertex colours"]);
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
    assert!(scene.view().facets.iter().all(|facet| facet.normal == [0.0, 0.0, 1.0]), "all face one way");
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
    names(&fault(hollow.as_bytes()), &["'air'", "cannot be there"]);
    let infinite = ascii.replace("0.5 4 1", "0.5 inf 1");
    names(&message(load(&folder.file("b.ply", infinite), None)), &["b.ply, line 17", "0.5 inf 1"]);
    // The first vertex's first coordinate, after the header.
    let mut binary = ply("binary_little_endian");
    let start = binary.windows(11).position(|bytes| bytes == b"end_header\n").expect("a header") + 11;
    binary[start..start + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    names(&message(load(&folder.file("b.ply", binary), None)), &["mesh 'b'", "vertex 0", "NaN"]);
}

#[test]
fn files_that_are_not_there_or_not_known() {
    let folder = Folder::new("none");
    for name in ["gone.obj", "gone.ply", "gone.gltf", "gone.glb"] {
        names(&message(load(&folder.0.join(name), None)), &[name, "cannot read", "exists"]);
    }
    for name in ["scene.fbx", "scene", "scene."] {
        names(&message(load(Path::new(name), None)), &[name, ".gltf, .glb, .obj and .ply"]);
    }
    names(&message(Overrides::read(&folder.0.join("gone.toml"))), &["gone.toml", "cannot read"]);
    let upper = folder.file("LOUD.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(load(&upper, None).is_ok());
}

const OVERRIDES: &str = r#"
[materials.glow]
emission = [20, 10, 5]
emits_both_sides = true

[materials.wall]
kind = "glass"
ior = 1.33
absorption = 0.5

[materials.gem]
tint = 0.5

[materials."rough"]
kind = "mirror"
albedo = 0.4

[materials.floor]
new = true
albedo = [0.1, 0.2, 0.3]

[[quads]]
material = "floor"
corner = [0, 0, 5]
edges = [[1, 0, 0], [0, 0, -1]]

[[lights]]
type = "quad"
name = "panel"
relative = true
corner = [-0.5, 0.5, 0.5]
edges = [[1, 0, 0], [0, 1, 0]]
radiance = 2

[[lights]]
type = "point"
relative = true
position = [0, 0, 1]
intensity = 1

[[lights]]
type = "spot"
position = [1, 1, 1]
direction = [0, 0, -1]
intensity = [1, 0, 0]
outer_degrees = 60

[[lights]]
type = "directional"
direction = [0, -1, 0]
irradiance = 3

[[cameras]]
name = "first"
from = [1, 1, 8]
to = [1, 1, 0]
fov_degrees = 90

[[cameras]]
name = "second"
relative = true
from = [0, 0, 2]
to = [0, 0, 0]
up = [1, 0, 0]
half_height = 0.5
"#;

#[test]
fn overrides_are_laid_over() {
    let folder = Folder::new("overrides");
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let overrides = Overrides::read(&folder.file("over.toml", OVERRIDES)).expect("overrides");
    let (scene, report) = load(&obj, Some(&overrides)).expect("a scene");

    let wall = material(&scene, "wall");
    assert_eq!((wall.kind, wall.ior, wall.albedo), (Material::DIELECTRIC, 1.33, [1.0; 3]));
    assert!((f64::from(wall.absorption[0]) - 0.5 * scene.units().scale).abs() < 1e-6);
    assert_eq!((material(&scene, "gem").ior, material(&scene, "gem").albedo), (1.7, [0.5; 3]));
    assert_eq!((material(&scene, "rough").kind, material(&scene, "rough").albedo), (Material::MIRROR, [0.4; 3]));
    assert_eq!(material(&scene, "floor").albedo, [0.1, 0.2, 0.3]);
    assert_eq!(material(&scene, "glow").flags, Material::EMITS_BOTH_SIDES);

    // The quadrilateral stands where it was put, facing up; the relative one, on the box of the
    // file: centre (1, 1, 0), extent 2, facing +z.
    let facets = scene.view().facets;
    assert_eq!((scene.mesh_of_triangle(8), facets[8].normal), ("override quad 0", [0.0, 1.0, 0.0]));
    assert_eq!(corners(&scene, 8)[0], [0.0, 0.0, 5.0]);
    assert_eq!((scene.mesh_of_triangle(10), facets[10].normal), ("panel", [0.0, 0.0, 1.0]));
    assert_eq!(corners(&scene, 10)[0], [0.0, 2.0, 1.0]);
    let lights = scene.view().lights;
    assert_eq!(lights.len(), 1 + 2 + 3);
    let bulb = scene.units().point_to_user(lights[3].position);
    assert!((bulb[2] - 2.0).abs() < 1e-6 && (bulb[0] - 1.0).abs() < 1e-6, "{bulb:?}");
    assert!((lights[4].cos_outer - 0.5).abs() < 1e-6 && lights[4].cos_inner == 1.0);

    assert_eq!(scene.camera_names().collect::<Vec<_>>(), ["first", "second"]);
    let second = scene.camera(Some("second"), 10, 10).expect("a camera");
    let up = f64::from(glam::Vec3::from(second.up).length()) * scene.units().scale;
    assert!((up - 1.0).abs() < 1e-6, "half of an extent of 2: {up}");

    let text = report.to_string();
    assert!(!text.contains("'rough'") && text.contains("'pane'") && !text.contains("no camera"), "{text}");
}

#[test]
fn override_faults() {
    let folder = Folder::new("override-faults");
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let parse = |text: &str| Overrides::parse(text, Path::new("over.toml"));
    let fault = |text: &str| message(parse(text).and_then(|overrides| load(&obj, Some(&overrides))));
    names(
        &fault("\n[materials.wall]\nalbedoo = 1\n"),
        &["over.toml, line 3", "albedoo", "`albedo`", "docs/overrides.md"],
    );
    names(&fault("[[light]]\n"), &["line 1", "light"]);
    names(&fault("[materials.wal]\n"), &["'wal'", "'wall'", "'lamp'", "new = true"]);
    names(&fault("[materials.wall]\nnew = true\n"), &["'wall'", "is new"]);
    names(&fault("[materials.wall]\nior = 1.5\n"), &["'wall'", "lambert", "no ior"]);
    names(&fault("[materials.pane]\nabsorption = 1\n"), &["'pane'", "thin", "no absorption"]);
    names(&fault("[materials.wall]\nkind = \"glas\"\n"), &["line 2", "glas", "`glass`"]);
    names(&fault("[materials.wall]\nalbedo = [1, 2]\n"), &["line 2", "three numbers"]);
    names(&fault("[materials.wall]\nalbedo = 2\n"), &["'wall'", "albedo", "2.0"]);
    names(&fault("[[lights]]\ntype = \"lamp\"\n"), &["line 2", "lamp", "`point`"]);
    names(&fault("[[lights]]\ntype = \"point\"\nposition = [0, 0, 0]\n"), &["line 1", "intensity"]);
    names(&fault("[[lights]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = 1\nradius = 2\n"), &["radius"]);
    names(
        &fault("[[quads]]\nmaterial = \"x\"\ncorner = [0, 0, 0]\nedges = [[1, 0, 0], [0, 1, 0]]\n"),
        &["'x'", "'wall'"],
    );
    let camera = "[[cameras]]\nname = \"eye\"\nfrom = [0, 0, 1]\nto = [0, 0, 0]\n";
    names(&fault(camera), &["'eye'", "neither"]);
    names(&fault(&format!("{camera}fov_degrees = 40\nhalf_height = 1\n")), &["'eye'", "both"]);
    names(&fault(&format!("{camera}fov_degrees = 180\n")), &["'eye'", "field of view"]);
    names(&fault("not toml"), &["over.toml, line 1"]);
    assert!(parse("").and_then(|overrides| load(&obj, Some(&overrides))).is_ok());
}

#[test]
fn the_example_files_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/overrides");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the examples") {
        let path = entry.expect("an entry").path();
        Overrides::read(&path).expect("a sound file");
        count += 1;
    }
    assert!(count >= 2);
}

#[test]
fn only_notes_are_exact() {
    let mut report = LoadReport::default();
    report.note("a", "b");
    assert!(report.is_exact() && report.lines[0].kind == ReportKind::Note);
    report.approximated("a", "b");
    assert!(!report.is_exact());
}
