//! OBJ and MTL.

use crate::support::{Folder, MTL, OBJ, corners, material, message, names};
use photon_core::MaterialKind;
use photon_scene::{load, load_obj};

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
    let dart = report("v 0 0 0\nv 1 1 0\nv 0 3 0\nv -1 1 0\nv 0 2 0\nf 5 4 1 2 3\nf 1 2 3 4\n");
    assert!(!dart.to_string().contains("not convex"), "{dart}");
    let dart = report("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n");
    names(&dart.to_string(), &["1 polygons are not convex, the first in line 5"]);
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
    names(&fault(&format!("{start}f 1 2\n")), &["line 4", "face 1 has 2 corners"]);
    names(&fault("v 0 0 0\nv 1 nan 0\n"), &["line 2", "nan", "finite"]);
    names(&fault("v 0 0\n"), &["line 1", "nothing", "three finite numbers"]);
    // Invalid references to unused data do no harm.
    assert!(load_obj(&folder.file("b.obj", format!("vt 0 0\n{start}f 1/-9/-9 2/7/7 3//0\n"))).is_ok());
    for (statement, hint) in [
        ("Kd 1 x 0", "one number, or three"),
        ("Kd 1 1", "one number, or three"),
        ("Ke", "one number, or three"),
        ("Ni", "a number"),
        ("Pr x", "a number"),
        ("Pm", "a number"),
        ("map_Pr", "name of an image"),
        ("illum 2.5", "0 to 10"),
        ("d 5", "from 0 to 1"),
        ("Tr -1", "from 0 to 1"),
        ("d nan", "from 0 to 1"),
        ("newmtl", "a name"),
    ] {
        folder.file("bad.mtl", format!("newmtl a\n{statement}\n"));
        names(&fault("mtllib bad.mtl\n"), &["bad.mtl, line 2", &format!("'{statement}'"), hint]);
    }
    folder.file("bad.mtl", "Kd 1 1 1\n");
    names(&fault("mtllib bad.mtl\n"), &["bad.mtl, line 1", "newmtl"]);
    folder.file("bright.mtl", "newmtl bright\nKd 1.5 0 0\n");
    let bright = folder.file("bright.obj", format!("mtllib bright.mtl\nusemtl bright\n{start}f 1 2 3\n"));
    names(&message(load(&bright, None)), &["material 'bright'", "albedo", "1.5"]);
    for (statement, parts) in [
        ("Pr 1.5", ["roughness", "1.5"]),
        ("Pm nan", ["metallic", "NaN"]),
        ("Ks nan", ["specular", "NaN"]),
        ("Kd 0 0 0\nKs nan", ["base_color", "NaN"]),
    ] {
        folder.file("bad.mtl", format!("newmtl bad\nKd 1 1 1\n{statement}\n"));
        let path = folder.file("bad.obj", format!("mtllib bad.mtl\nusemtl bad\n{start}f 1 2 3\n"));
        let text = message(load(&path, None));
        names(&text, &["material 'bad'"]);
        names(&text, &parts);
    }
    let (scene, _) = load(&folder.file("empty.obj", ""), None).expect("nothing");
    assert!(scene.warnings()[0].contains("no triangles"));
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
    let (scene, _) = load(&folder.file("good.obj", text("3")), None).expect("three vertices");
    assert_eq!(scene.view().triangles.len(), 1);
    let error = message(load(&folder.file("bad.obj", text("4")), None));
    names(&error, &["line 7", "face 1 refers to vertex '4'", "the file has 3"]);
}
