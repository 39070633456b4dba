//! OBJ and MTL.

use crate::support::{Folder, MTL, OBJ, corners, material, message, names};
use photon_core::MaterialKind;
use photon_scene::{ReportKind, load, load_obj};

#[test]
fn obj_and_mtl() {
    let folder = Folder::new("obj");
    folder.file("scene materials.mtl", MTL);
    let path = folder.file("scene.obj", OBJ);
    let (scene, report) = load(&path, None).expect("a scene");
    assert_eq!(scene.view().triangles.len(), 8);
    // By mesh and index within that.
    let sources: Vec<_> = scene.triangle_sources().collect();
    let triangle = |source| sources.iter().position(|&known| known == source).expect("a triangle");
    let place = |source| corners(&scene, triangle(source));
    assert_eq!(place((0, 0)), [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0]]);
    assert_eq!(place((0, 1)), [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    assert_eq!(place((1, 0)), place((0, 0)), "counted from the end, over two lines");
    let mesh = |source| scene.mesh_of_triangle(triangle(source) as u32);
    assert_eq!((mesh((0, 1)), mesh((1, 0)), mesh((2, 0))), ("room", "room", "things"));

    assert_eq!(
        (material(&scene, "wall").kind, material(&scene, "wall").albedo),
        (MaterialKind::Lambert as u32, [0.6, 0.5, 0.4])
    );
    assert_eq!(material(&scene, "shiny metal").kind, MaterialKind::Mirror as u32);
    assert_eq!(material(&scene, "shiny metal").albedo, [0.9, 0.8, 0.7]);
    let gem = material(&scene, "gem");
    assert_eq!((gem.kind, gem.ior, gem.albedo), (MaterialKind::Dielectric as u32, 1.7, [0.9, 1.0, 0.8]));
    let pane = material(&scene, "pane");
    assert!(pane.kind == MaterialKind::Lambert as u32 && pane.has_alpha() && pane.alpha < 1.0);
    let rough = material(&scene, "rough");
    assert_eq!((rough.kind, rough.albedo), (MaterialKind::Glossy as u32, [0.3; 3]));
    assert_eq!((rough.metallic, rough.roughness, rough.specular, rough.ior), (0.0, 0.4, 1.0, 1.5));
    assert_eq!(material(&scene, "nowhere").albedo, [0.5; 3]);
    assert_eq!(scene.view().lights.len(), 1);
    let radiance = material(&scene, "light").emission.map(|part| f64::from(part) * scene.units().radiance_to_user());
    for (found, expected) in radiance.into_iter().zip([5.0, 4.0, 3.0]) {
        assert!((found - expected).abs() < 1e-5, "{radiance:?}");
    }

    let text = report.to_string();
    for line in [
        "approximated: material 'gem'",
        "note: material 'pane': is there for a share of 0.2 of the light (d)",
        "left out: material 'glow': its Ka of [20.0, 20.0, 20.0]",
        "left out: material 'rough': its texture map_Kd wood grain.png: the file does not exist",
        "note: material 'light': emits [5.0, 4.0, 3.0]",
        "material 'nowhere': is not defined",
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
    names(&bare.to_string(), &["the file", "without material", "'default'"]);
    let dart = report("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n");
    assert!(!dart.to_string().contains("polygons cross"), "{dart}");
    let bow = report("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n");
    names(&bow.to_string(), &["approximated: the file: 1 polygons cross themselves, the first in line 5"]);
    let lost = report("mtllib gone.mtl\nusemtl a#b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    names(&lost.to_string(), &["gone.mtl'", "does not exist", "'a#b': is not defined"]);
    // Latin-1 is not UTF-8, and still accepted in a comment.
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
    names(&fault("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"), &["line 4", "face 1 uses vertex 2", "NaN", "finite"]);
    names(&fault("v 0 0\n"), &["line 1", "nothing", "three numbers"]);
    names(&fault("v 0 x 0\n"), &["line 1", "has x in place of a number"]);
    let (scene, _) = load(&folder.file("empty.obj", "# Nothing.\n"), None).expect("nothing");
    assert!(scene.warnings()[0].contains("no triangles"));
}

/// What other programs skip is left out or guessed, with a line that `--strict` refuses.
#[test]
fn faults_of_exporters_have_a_line() {
    const START: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let folder = Folder::new("obj-lines");
    let lines = |text: &str| {
        let (scene, report) = load(&folder.file("a.obj", text), None).unwrap_or_else(|error| panic!("{text}: {error}"));
        let found =
            report.lines.iter().filter(|line| line.kind != ReportKind::Note && !line.text.contains("'default'"));
        (scene, found.map(ToString::to_string).collect::<Vec<_>>())
    };
    for (text, line) in [
        ("vn nan 0 0\nf 1//1 2//1 3//1", "1 normals (vn) are not three finite numbers, the first in line 4"),
        ("vn 0 -1.#IND 0\nf 1//1 2//1 3//1", "1 normals (vn) are not"),
        ("vn 0 0\nf 1//1 2//1 3//1", "1 normals (vn) are not"),
        ("vt -nan(ind) 0\nf 1/1 2/1 3/1", "1 texture coordinates (vt) are not finite"),
        ("f 1//7 2//-1 3", "2 corners of faces refer to normals that do not exist, the first in line 4"),
        ("f 1/7 2/x 3/", "2 corners of faces refer to texture coordinates that do not exist"),
        ("f 1 2\nf 1 2 3", "left out: the file: 1 faces of fewer than three corners, the first in line 4"),
        ("v 0 0 0 0.5\nf 1 2 3", "1 vertices have numbers that are no colour (v x y z r g b), the first in line 4"),
        ("v 0 0 0 1 1 1 0.5\nf 1 2 3", "1 vertices have numbers"),
        ("v 0 0 0 nan 1 1\nf 1 2 3", "1 vertices have numbers"),
        ("v 0 0 0 9 1 0\nf 1 2 3", "taken as sRGB from 0 to 255"),
        ("mtllib\nf 1 2 3", "left out: the file: a statement 'mtllib' without the name of a file"),
        ("v 1 1 0 1 0 0\nf 1 2 4", "approximated: mesh 'a': 2 corners of its triangles have no colour, others do"),
        ("l 1 2\np 1\nl 2 3\nf 1 2 3", "2 statements 'l', which are not geometry that is read; the first in line 4"),
    ] {
        let (scene, found) = lines(&format!("{START}{text}\n"));
        assert_eq!(scene.view().triangles.len(), 1, "{text}");
        names(found.first().unwrap_or_else(|| panic!("{text}: no line")), &[line]);
    }
    for text in [
        "v nan inf 1.#QNAN\nf 1 2 3",
        "v 0 0 0 1.0 # weight\nf 1 2 3",
        "f 1/ 2// 3 # none",
        "\u{FEFF}f 1 2 3#none",
        "# C:\\scenes\\\nf 1 2 3",
        "S off\rf 1 2 3",
    ] {
        let (_, found) = lines(&format!("{START}{text}\n"));
        assert!(found.is_empty() || text.starts_with('S'), "{text}: {found:?}");
    }
    let many: String = (0..100).map(|index| format!("w{index} 0\n")).collect();
    let (_, found) = lines(&format!("{START}f 1 2 3\n{many}"));
    assert!(found.len() == 21 && found[20].contains("80 statements of other kinds"), "{found:?}");
}

/// Vertices, normals and texture coordinates may come after the faces that use them, which changes nothing.
#[test]
fn definitions_may_come_after_faces() {
    let folder = Folder::new("obj-order");
    folder.file("a.png", crate::obj_textures::png(&[[255, 0, 0], [0, 0, 255]]));
    folder.file("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd a.png\n");
    let definitions = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0\nvn 0 1 1\n";
    let face = "mtllib a.mtl\nusemtl a\nf 1/1/1 2/2/1 3/1/1\n";
    let tables = |name: &str, text: String| {
        let (scene, report) = load(&folder.file(name, text), None).expect("a scene");
        assert!(report.is_exact(), "{report}");
        let view = scene.view();
        (view.shading.uvs.to_vec(), view.shading.normals.to_vec(), view.positions.to_vec())
    };
    let before = tables("a.obj", format!("{definitions}{face}"));
    assert!(!before.0.is_empty() && !before.1.is_empty());
    assert_eq!(tables("b.obj", format!("{face}{definitions}")), before);
}

/// The last statement of a material decides; one that is invalid is left out, and so does not.
#[test]
fn faults_of_materials_have_a_line() {
    let folder = Folder::new("mtl-lines");
    for (statements, line) in [
        ("Kd 1 x 0", "left out: material 'a': 'Kd 1 x 0' in line 3 of its file: one finite number, or three, must"),
        ("Kd 1 1", "'Kd 1 1' in line 3 of its file: one finite number, or three"),
        ("Kd nan 0 0", "one finite number, or three"),
        (
            "Kd 0.8 0.2 0.4 1.0",
            "approximated: material 'a': 'Kd 0.8 0.2 0.4 1.0' in line 3 of its file: the first three",
        ),
        (
            "Kd 204 51 102",
            "approximated: material 'a': 'Kd 204 51 102' in line 3 of its file: it is taken as numbers from 0 to",
        ),
        ("Kd 0.1 0.1 0.1\nKd 0.8 0.2 0.4", "'Kd 0.8 0.2 0.4' in line 4 of its file: it replaces an earlier one"),
        ("Ks 1.5 0 0\nillum 1", "'Ks 1.5 0 0' in line 3 of its file: its numbers must lie between 0 and 1"),
        ("Ke -1 0 0", "its numbers must be at least 0, and are clamped"),
        ("Tf 0.5 0.5 0.5", "left out: material 'a': its filter Tf [0.5, 0.5, 0.5]"),
        ("d 1\nTr 0.5", "'Tr 0.5' in line 4 of its file: d and Tr contradict each other; d counts"),
        ("Tr 0.5\nd 1", "'d 1' in line 4 of its file: d and Tr contradict each other; d counts"),
        (
            "newmtl a\nKd 0.8 0.2 0.4",
            "approximated: material 'a': is defined more than once; the last definition counts",
        ),
        ("Ke", "'Ke' in line 3"),
        ("Ks nan", "'Ks nan'"),
        ("Ni", "a finite number must"),
        ("Ni 0", "a refractive index is above 0"),
        ("Ns nan", "a finite number must"),
        ("illum 2.5", "from 0 to 10"),
        ("illum 11", "from 0 to 10"),
        ("d 5", "between 0 and 1, and is clamped"),
        ("d nan", "a finite number"),
        ("d -halo 1", "does not vary with the angle"),
        ("Tr -1", "between 0 and 1, and is clamped"),
        ("map_Kd", "the name of an image must follow"),
        ("map_d -s 1 1", "the name of an image must follow"),
        ("newmtl\nKd 0 0 0", "2 statements without 'newmtl' and a name before them, the first in line 3"),
        ("sharpness 60", "its statements sharpness 60"),
    ] {
        folder.file("a.mtl", format!("newmtl a\nKd 0.8 0.2 0.4\n{statements}\n"));
        let obj = folder.file("a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let (scene, report) = load(&obj, None).unwrap_or_else(|error| panic!("{statements}: {error}"));
        assert_eq!(material(&scene, "a").albedo, [0.8, 0.2, 0.4], "{statements}");
        names(&report.to_string(), &[line]);
        assert!(!report.is_exact(), "{statements}");
    }
    // Not those that say the same twice, or are no fault.
    for statements in ["Kd 0.8 0.2 0.4", "d 1\nTr 0", "Tf 0 0 0", "Kd 0.8 \\\n 0.2 0.4", "newmtl b # unused\nKd 0 0 0"]
    {
        folder.file("a.mtl", format!("newmtl a\nKd 0.8 0.2 0.4\n{statements}\n"));
        let (scene, report) = load(&folder.0.join("a.obj"), None).expect("a scene");
        assert!(report.is_exact() && material(&scene, "a").albedo == [0.8, 0.2, 0.4], "{statements}: {report}");
    }
    for (statement, share) in [("Pr 1.5", 1.0), ("Pm 7\nPr 1", 1.0), ("Pr -1", 0.0)] {
        folder.file("a.mtl", format!("newmtl a\nKd 0.8 0.2 0.4\n{statement}\n"));
        let (scene, report) = load(&folder.0.join("a.obj"), None).expect("a scene");
        assert!(!report.is_exact() && f64::from(material(&scene, "a").roughness) == share, "{statement}: {report}");
    }
    folder.file("a.mtl", "junk\nMaterials: 1\nNEWMTL a\nkd 0.8 0.2 0.4\n");
    let (scene, report) = load(&folder.0.join("a.obj"), None).expect("a scene");
    assert_eq!(material(&scene, "a").albedo, [0.8, 0.2, 0.4]);
    names(&report.to_string(), &["a.mtl': 2 statements without 'newmtl'"]);
    // Names with quotes and comments, and colours out of range.
    for (name, color, expected) in
        [("a # red", "1.5 -1 0", [1.0, 0.0, 0.0]), ("\"a\"", "12 255 0.5", [12.0 / 255.0, 1.0, 0.5 / 255.0])]
    {
        folder.file("a b.mtl", format!("newmtl {name}\nKd {color}\n"));
        let text = "mtllib \"a b.mtl\" # all\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let (scene, report) = load(&folder.file("b.obj", text), None).expect("a scene");
        assert_eq!(material(&scene, name).albedo, expected.map(|part| part as f32), "{report}");
        assert!(!report.is_exact() && !report.to_string().contains("not defined"), "{report}");
    }
}

/// Models 4, 6, 7 and 9 are those of glass, and of opaque materials of many programs.
#[test]
fn illumination_models_are_judged_by_what_else_is_said() {
    use MaterialKind::{Dielectric, Glossy, Lambert};
    for (statements, kind) in [
        ("illum 4\nKd 0.5 0.5 0.5\nTf 1 1 1\nNi 1", Lambert),
        ("illum 4\nKd 0.5 0.5 0.5\nTf 0 0 0\nd 1", Lambert),
        ("illum 9\nKd 0.5 0.5 0.5\nTr 0", Lambert),
        ("illum 6\nKd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nd 1\nNs 10", Glossy),
        ("illum 7\nKd 0.5 0.5 0.5\nNi 1\nd 0.5", Lambert),
        ("illum 7\nKd 0.5 0.5 0.5\nNi 1.5", Dielectric),
        ("illum 4\nKd 0.5 0.5 0.5\nd 0.5", Dielectric),
        ("illum 4\nKd 0.5 0.5 0.5\nTf 0.5 1 1", Dielectric),
        ("illum 7\nKd 0 0 0", Dielectric),
        ("illum 6", Dielectric),
    ] {
        let (scene, report) = crate::obj_textures::square("obj-illum", statements, crate::obj_textures::FACE);
        assert_eq!(material(&scene, "a").kind, kind as u32, "{statements}");
        assert!(!report.is_exact(), "{statements}");
    }
}

/// As images, material files are in the folder of the scene or below; nothing of another file is shown.
#[test]
fn libraries_are_within_the_folder() {
    let folder = Folder::new("obj-outside");
    folder.file("secret.txt", "secret\n");
    std::fs::create_dir_all(folder.0.join("in")).expect("a folder");
    for name in
        ["../secret.txt", "/etc/passwd", "..\\secret.txt", "a/../../secret.txt", "C:\\secret.txt", "//host/s.mtl"]
    {
        let path = folder.file("in/a.obj", format!("mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
        let (_, report) = load(&path, None).expect("a scene");
        names(&report.to_string(), &["left out: material file", "is outside the folder of the scene"]);
        assert!(!report.to_string().contains("root:") && !report.to_string().contains("newmtl"), "{report}");
    }
}

/// A device can be read without end.
#[cfg(unix)]
#[test]
fn a_library_that_is_a_device_is_not_read() {
    let folder = Folder::new("device");
    let path = folder.file("a.obj", "mtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let words = match load(&path, None) {
        Ok((_, report)) => report.lines.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
        Err(error) => {
            format!("{error}: {}", std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default())
        }
    };
    assert!(words.contains("/dev/zero"), "{words}");
}

/// A vertex statement that is joined to the previous line is no vertex: faces may not refer to it. Found by fuzzing.
#[test]
fn obj_lines_that_are_joined_count_once() {
    let folder = Folder::new("obj-joined");
    let text = |face: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0 \\\nv 5 5 5\n# \\\nv 6 6 6\nf 1 \\\n 2 \\\n{face}\n");
    let (scene, _) =
        load(&folder.file("good.obj", text("3")), None).expect("four vertices, since comments end with their line");
    assert_eq!(scene.view().triangles.len(), 1);
    let error = message(load(&folder.file("bad.obj", text("5")), None));
    names(&error, &["line 7", "face 1 refers to vertex '5'", "the file has 4"]);
}
