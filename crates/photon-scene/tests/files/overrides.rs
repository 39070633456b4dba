//! Override files.

use crate::support::{Folder, MTL, OBJ, corners, material, message, names};
use photon_core::phase::{Mie, Phase};
use photon_core::{Material, MaterialKind, Medium, Wavelength};
use photon_scene::{Overrides, load};
use std::path::Path;

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

[materials.brass]
new = true
kind = "glossy"
albedo = [0.8, 0.6, 0.3]
metallic = 1
roughness = 0.25

[materials.varnish]
new = true
kind = "glossy"
specular = 0.75
ior = 1.25

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
aperture = 0.25
focus = 6

[[cameras]]
name = "third"
relative = true
from = [0, 0, 2]
to = [0, 0, 0]
fov_degrees = 90
aperture = 0.25
focus = 1.5

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
    assert_eq!((wall.kind, wall.ior, wall.albedo), (MaterialKind::Dielectric as u32, 1.33, [1.0; 3]));
    assert!(
        (f64::from(scene.view().media[wall.medium as usize].absorption[0]) - 0.5 * scene.units().scale).abs() < 1e-6
    );
    assert_eq!((material(&scene, "gem").ior, material(&scene, "gem").albedo), (1.7, [0.5; 3]));
    assert_eq!(
        (material(&scene, "rough").kind, material(&scene, "rough").albedo),
        (MaterialKind::Mirror as u32, [0.4; 3])
    );
    assert_eq!(material(&scene, "floor").albedo, [0.1, 0.2, 0.3]);
    let glossy = |name: &str| {
        let Material { kind, albedo, metallic, roughness, specular, ior, .. } = *material(&scene, name);
        assert_eq!(kind, MaterialKind::Glossy as u32);
        (albedo, [metallic, roughness, specular, ior])
    };
    assert_eq!(glossy("brass"), ([0.8, 0.6, 0.3], [1.0, 0.25, 1.0, 1.5]));
    assert_eq!(glossy("varnish"), ([0.5; 3], [0.0, 0.5, 0.75, 1.25]));
    assert_eq!(material(&scene, "glow").flags, Material::EMITS_BOTH_SIDES);

    // The absolute quadrilateral is where it was put, facing up; the relative one, in terms of the bounding box of the
    // file: centre (1, 1, 0), extent 2, facing +z.
    let primitives = scene.view().primitives;
    assert_eq!((scene.mesh_of_triangle(8), primitives[8].normal), ("override quad 0", [0.0, 1.0, 0.0]));
    assert_eq!(corners(&scene, 8)[0], [0.0, 0.0, 5.0]);
    assert_eq!((scene.mesh_of_triangle(10), primitives[10].normal), ("panel", [0.0, 0.0, 1.0]));
    assert_eq!(corners(&scene, 10)[0], [0.0, 2.0, 1.0]);
    let lights = scene.view().lights;
    assert_eq!(lights.len(), 1 + 2 + 3);
    let bulb = scene.units().point_to_user(lights[3].position);
    assert!((bulb[2] - 2.0).abs() < 1e-6 && (bulb[0] - 1.0).abs() < 1e-6, "{bulb:?}");
    assert!((lights[4].versine_outer - 0.5).abs() < 1e-6 && lights[4].versine_inner == 0.0);

    assert_eq!(scene.camera_names().collect::<Vec<_>>(), ["first", "third", "second"]);
    let lens = |name| {
        let camera = scene.camera(Some(name), 10, 10).expect("a camera");
        [camera.lens_radius, camera.focus_distance].map(|length| scene.units().length_to_user(length))
    };
    assert_eq!(lens("second"), [0.0, 0.0]);
    for (name, [radius, focus]) in [("first", [0.125, 6.0]), ("third", [0.25, 3.0])] {
        let found = lens(name);
        assert!((found[0] - radius).abs() < 1e-6 && (found[1] - focus).abs() < 1e-6, "{name}: {found:?}");
    }
    let second = scene.camera(Some("second"), 10, 10).expect("a camera");
    let up = f64::from(glam::Vec3::from(second.up).length()) * scene.units().scale;
    assert!((up - 1.0).abs() < 1e-6, "half of an extent of 2: {up}");

    let text = report.to_string();
    assert!(!text.contains("'rough'") && text.contains("'pane'") && !text.contains("no camera"), "{text}");
}

/// A glossy surface of a file gets the diffuse one back, by its kind or without its coat.
#[test]
fn glossy_surfaces_become_diffuse() {
    let folder = Folder::new("overrides-diffuse");
    folder.file("a.bin", [0.0_f32, 0., 0., 1., 0., 0., 0., 1., 0.].map(f32::to_le_bytes).as_flattened());
    let gltf = folder.file(
        "a.gltf",
        r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "buffers": [{"uri": "a.bin", "byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "materials": [{"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.25, 1, 1]}}]}"#,
    );
    let paint = |text: &str| {
        let overrides = Overrides::parse(text, Path::new("over.toml")).expect("overrides");
        *material(&load(&gltf, Some(&overrides)).expect("a scene").0, "paint")
    };
    let diffuse = Material { kind: MaterialKind::Lambert as u32, albedo: [0.5, 0.25, 1.0], ior: 1.0, ..paint("") };
    let diffuse = Material { specular: 0.0, roughness: 0.0, ..diffuse };
    assert_eq!(paint("").kind, MaterialKind::Glossy as u32);
    assert_eq!(paint("[materials.paint]\nspecular = 0\n"), diffuse);
    assert_eq!(paint("[materials.paint]\nior = 1\n"), diffuse);
    assert_eq!(paint("[materials.paint]\nkind = \"lambert\"\n"), diffuse);
    let other = paint("[materials.paint]\nkind = \"lambert\"\nalbedo = 0.25\n");
    assert_eq!(other.albedo, [0.25; 3]);
    let partly = paint("[materials.paint]\nspecular = 0\nmetallic = 0.5\n");
    assert_eq!((partly.kind, partly.metallic), (MaterialKind::Glossy as u32, 0.5));
    // A smooth metal is a mirror whose reflectance rises; a perfect mirror is another kind, with a colour of its own.
    let smooth = paint("[materials.paint]\nkind = \"glossy\"\nmetallic = 1\nroughness = 0\n");
    let is_mirror = |it: &Material| it.kind == MaterialKind::Mirror as u32;
    assert!(is_mirror(&smooth) && (smooth.metallic, smooth.albedo) == (1.0, [0.5, 0.25, 1.0]), "{smooth:?}");
    let mirror = paint("[materials.paint]\nkind = \"mirror\"\n");
    assert!(is_mirror(&mirror) && (mirror.metallic, mirror.albedo) == (0.0, [1.0; 3]), "{mirror:?}");
    // A grey specular colour is a refractive index, another one has a record.
    let grey = paint("[materials.paint]\nspecular_color = 4\n");
    assert!((grey.ior - 7.0 / 3.0).abs() < 1e-6 && grey.textures == 0, "{grey:?}");
    assert_eq!(paint("[materials.paint]\nspecular_color = [1, 0.5, 0.25]\n").textures, 1);
    // A clearcoat is a reflection over any opaque surface.
    let clear = paint("[materials.paint]\nkind = \"lambert\"\nclearcoat = 1\nclearcoat_roughness = 0.25\n");
    assert_eq!((clear.kind, clear.specular, clear.textures), (MaterialKind::Glossy as u32, 0.0, 1));
    assert_eq!(paint("[materials.paint]\nkind = \"lambert\"\nclearcoat = 0\n"), diffuse);
    assert_eq!(paint("[materials.paint]\nanisotropy = 0.5\nanisotropy_degrees = 30\n").textures, 1);
    assert_eq!(paint("[materials.paint]\nanisotropy_degrees = 30\n").textures, 0);
    let paper = paint(
        "[materials.paint]\nkind = \"lambert\"\ndiffuse_transmission = 0.5\ndiffuse_transmission_color = [1, 0, 0]\n",
    );
    assert_eq!((paper.kind, paper.specular, paper.textures), (MaterialKind::Glossy as u32, 0.0, 1));
    assert!(paper.flags & photon_core::Material::DIFFUSE_TRANSMISSION != 0);
    assert_eq!(paint("[materials.paint]\nkind = \"lambert\"\ndiffuse_transmission = 0\n"), diffuse);
    let mixed = paint("[materials.paint]\ntransmission = 0.5\n");
    assert!(mixed.has_partial_transmission() && mixed.textures == 1, "{mixed:?}");
    assert_eq!(paint("[materials.paint]\ntransmission = 1\n").kind, MaterialKind::Thin as u32);
    let solid = paint("[materials.paint]\ntransmission = 1\nabsorption = 0.5\npriority = 2\n");
    assert_eq!((solid.kind, solid.medium), (MaterialKind::Dielectric as u32, 1));
    assert_eq!(paint("[materials.paint]\ntransmission = 0\n"), paint(""));
    let cloth = paint("[materials.paint]\nkind = \"lambert\"\nsheen = [1, 0.5, 0]\nsheen_roughness = 0.3\n");
    assert_eq!((cloth.kind, cloth.specular, cloth.textures), (MaterialKind::Glossy as u32, 0.0, 1));
    assert_eq!(paint("[materials.paint]\nkind = \"lambert\"\nsheen = 0\n"), diffuse);
    let mirror = paint("[materials.paint]\nmetallic = 1\nroughness = 0\n");
    assert_eq!((mirror.kind, mirror.albedo), (MaterialKind::Mirror as u32, [0.5, 0.25, 1.0]));
}

/// `alpha` makes a surface see-through or opaque; another kind, and glass, are opaque.
#[test]
fn alpha_is_overridden() {
    let folder = Folder::new("override-alpha");
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let alpha_of = |text: &str, name: &str| {
        let overrides = Overrides::parse(text, Path::new("over.toml")).expect("a sound file");
        let (scene, _) = load(&obj, Some(&overrides)).expect("a scene");
        let found = *material(&scene, name);
        found.has_alpha().then_some(found.alpha)
    };
    assert_eq!(alpha_of("", "pane"), Some(0.2));
    assert_eq!(alpha_of("[materials.pane]\nalpha = 0.5\n", "pane"), Some(0.5));
    assert_eq!(alpha_of("[materials.pane]\nalpha = 1\n", "pane"), None);
    assert_eq!(alpha_of("[materials.wall]\nalpha = 0.25\n", "wall"), Some(0.25));
    assert_eq!(alpha_of("[materials.pane]\nkind = \"thin\"\n", "pane"), None);
    assert_eq!(alpha_of("[materials.pane]\nkind = \"lambert\"\n", "pane"), Some(0.2));
    let over = Overrides::parse("[materials.gem]\nalpha = 0.5\n", Path::new("over.toml"));
    names(&message(over.and_then(|over| load(&obj, Some(&over)))), &["'gem'", "alpha mode", "closed"]);
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
        &["over.toml, line 3", "albedoo", "'albedo'", "docs/scene-files.md"],
    );
    names(&fault("[[light]]\n"), &["line 1", "light"]);
    names(&fault("[materials.wal]\n"), &["'wal'", "did you mean 'wall'?", "new = true"]);
    names(&fault("[materials.wall]\nnew = true\n"), &["'wall'", "is new"]);
    names(&fault("[materials.wall]\nior = 1.5\n"), &["'wall'", "lambert", "no ior"]);
    names(&fault("[materials.pane]\nkind = \"thin\"\nabsorption = 1\n"), &["'pane'", "thin", "no absorption"]);
    let many = "glass, thin and glossy have it";
    for (key, kinds) in [("metallic", "glossy has it"), ("roughness", many), ("specular", "glossy has it")] {
        names(&fault(&format!("[materials.wall]\n{key} = 0.5\n")), &["'wall'", "lambert", key, kinds]);
        for value in ["-0.1", "1.1", "nan"] {
            let text = format!("[materials.wall]\nkind = \"glossy\"\n{key} = {value}\n");
            let shown = if value == "nan" { "NaN" } else { value };
            names(&fault(&text), &["'wall'", key, shown, "between 0 and 1"]);
        }
    }
    for ior in ["-0.5", "nan", "inf", "1e300"] {
        names(&fault(&format!("[materials.wall]\nkind = \"glossy\"\nior = {ior}\n")), &["'wall'", "ior", "finite"]);
    }
    names(&fault("[materials.wall]\nspecular_color = 1\n"), &["'wall'", "lambert", "no specular_color"]);
    for color in ["-0.5", "nan", "1e300"] {
        let text = format!("[materials.wall]\nkind = \"glossy\"\nspecular_color = {color}\n");
        names(&fault(&text), &["'wall'", "specular_color", "finite"]);
    }
    names(&fault("[materials.pane]\nkind = \"thin\"\nclearcoat = 1\n"), &["'pane'", "thin", "no clearcoat"]);
    names(&fault("[materials.pane]\nkind = \"thin\"\nanisotropy = 1\n"), &["'pane'", "thin", "no anisotropy"]);
    names(&fault("[materials.wall]\nkind = \"glossy\"\nanisotropy = 2\n"), &["'wall'", "between 0 and 1"]);
    names(&fault("[materials.wall]\nkind = \"glossy\"\nanisotropy_degrees = inf\n"), &["'wall'", "finite"]);
    names(&fault("[materials.wall]\ntransmission = 0.5\n"), &["'wall'", "lambert", "no transmission"]);
    names(&fault("[materials.wall]\nkind = \"glossy\"\nabsorption = 1\n"), &["'wall'", "no absorption"]);
    let share = "[materials.wall]\nkind = \"glossy\"\ntransmission = 1.5\n";
    names(&fault(share), &["'wall'", "transmission", "between 0 and 1"]);
    for (key, value) in [("abbe", "60"), ("cauchy", "[1.5, 0.01]"), ("sellmeier", "[1, 0, 0, 0.01, 0, 0]")] {
        names(
            &fault(&format!("[materials.pane]\nkind = \"thin\"\n{key} = {value}\n")),
            &["'pane'", "thin", "no ", key],
        );
        names(&fault(&format!("[materials.wall]\n{key} = {value}\n")), &["'wall'", "lambert", "no ", key]);
    }
    let glass = |keys: &str| fault(&format!("[materials.wall]\nkind = \"glass\"\n{keys}\n"));
    for abbe in ["0", "-0.0", "-60", "nan", "inf", "-inf", "1e-320"] {
        names(&glass(&format!("abbe = {abbe}")), &["'wall'", "abbe", "finite"]);
    }
    for terms in ["[nan, 0]", "[1.5, inf]", "[1e300, 0.01]"] {
        names(&glass(&format!("cauchy = {terms}")), &["'wall'", "cauchy", "finite", "micrometres"]);
    }
    // A resonance of visible light; coefficients in square nanometres.
    for terms in ["[1, 0, 0, 0.25, 0, nan]", "[inf, 0, 0, 0.01, 0, 0]"] {
        names(&glass(&format!("sellmeier = {terms}")), &["'wall'", "sellmeier", "finite"]);
    }
    names(&glass("abbe = 60\ncauchy = [1.5, 0.01]"), &["'wall'", "both abbe and cauchy", "one of"]);
    names(&glass("cauchy = [1.5]"), &["line 3", "1 values are given in place of 2"]);
    names(&fault("[materials.pane]\nkind = \"thin\"\nsheen = 1\n"), &["'pane'", "thin", "no sheen"]);
    names(&fault("[materials.wall]\nsheen = 1.5\n"), &["'wall'", "sheen_color", "between 0 and 1"]);
    let mirror = "[materials.wall]\nkind = \"mirror\"\ndiffuse_transmission = 1\n";
    names(&fault(mirror), &["'wall'", "mirror", "no diffuse_transmission"]);
    for key in
        ["clearcoat", "clearcoat_roughness", "diffuse_transmission", "diffuse_transmission_color", "sheen_roughness"]
    {
        names(&fault(&format!("[materials.wall]\n{key} = 1.5\n")), &["'wall'", key, "between 0 and 1"]);
    }
    names(&fault("[materials.wall]\nkind = \"glossy\"\ntint = 1\n"), &["'wall'", "glossy", "no tint"]);
    let text = "[materials.wall]\nkind = \"glossy\"\nmetallic = \"x\"\n";
    names(&fault(text), &["line 3", "x is given in place of a number"]);
    names(&fault("[materials.wall]\nkind = \"glas\"\n"), &["line 2", "glas", "'glass'"]);
    names(&fault("[materials.wall]\nalbedo = [1, 2]\n"), &["line 2", "three numbers"]);
    names(&fault("[materials.wall]\nalbedo = 2\n"), &["'wall'", "albedo", "2.0"]);
    names(&fault("[[lights]]\ntype = \"laser\"\n"), &["line 2", "laser", "'point'"]);
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
    names(&fault(&format!("{camera}fov_degrees = 40\naperture = 1\n")), &["'eye'", "aperture, but not focus"]);
    names(&fault(&format!("{camera}fov_degrees = 40\nfocus = 1\n")), &["'eye'", "focus, but not aperture"]);
    names(&fault(&format!("{camera}fov_degrees = 40\naperture = -1\nfocus = 1\n")), &["'eye'", "diameter"]);
    names(&fault("not toml"), &["over.toml, line 1"]);
    assert!(parse("").and_then(|overrides| load(&obj, Some(&overrides))).is_ok());
}

/// Formulas of the refractive index in the table of media, and warnings of those below 1.
#[test]
fn dispersion_is_overridden() {
    let folder = Folder::new("override-dispersion");
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let medium = |keys: &str| {
        let text = format!("[materials.wall]\nkind = \"glass\"\n{keys}\n");
        let overrides = Overrides::parse(&text, Path::new("over.toml")).expect("a sound file");
        let (scene, _) = load(&obj, Some(&overrides)).expect("a scene");
        let found = *material(&scene, "wall");
        assert_eq!(scene.view().media[found.medium as usize].ior, found.ior);
        let has_warning = scene.warnings().iter().any(|text| text.contains("'wall'") && text.contains("below 1"));
        (scene.view().media[found.medium as usize], has_warning)
    };
    let (plain, _) = medium("ior = 1.6");
    assert_eq!(medium("ior = 1.4\ncauchy = [1.6, 0]"), (plain, false), "without a slope there is no dispersion");
    let (cauchy, has_warning) = medium("cauchy = [1.6, 0.02]");
    assert_eq!((cauchy.dispersion, &cauchy.terms[..2], has_warning), (Medium::CAUCHY, &[1.6, 0.02][..], false));
    assert!((cauchy.ior - 1.657_93).abs() < 1e-5, "{}", cauchy.ior);
    let (sellmeier, _) =
        medium("sellmeier = [1.03961212, 0.231792344, 1.01046945, 0.00600069867, 0.0200179144, 103.560653]");
    assert_eq!(sellmeier.dispersion, Medium::SELLMEIER);
    assert!((sellmeier.ior - 1.516_80).abs() < 1e-5, "{}", sellmeier.ior);
    let (abbe, _) = medium("ior = 1.5168\nabbe = 64.17");
    for wavelength in (40..200).step_by(40).map(Wavelength::of_cell) {
        let [a, b] = [abbe, sellmeier].map(|medium| medium.index(wavelength));
        assert!((a - b).abs() < 1e-3, "BK7 by both formulas: {a} {b}");
    }
    assert!(medium("cauchy = [0.95, 0.01]").1 && !medium("cauchy = [1.0, 0.01]").1);
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

/// The ambient medium is entry 0 of the table of media, those of solids follow; coefficients are per normalised length.
#[test]
fn media_are_overridden() {
    let folder = Folder::new("override-media");
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let parse = |text: &str| Overrides::parse(text, Path::new("over.toml"));
    let scene = |text: &str| load(&obj, Some(&parse(text).expect("a sound file"))).expect("a scene").0;
    let near = |found: [f32; 3], user: [f64; 3], scale: f64| {
        found.iter().zip(user).all(|(found, user)| (f64::from(*found) - user * scale).abs() <= 1e-6 * user * scale)
    };
    let fog = scene("[medium]\nscattering = [0.5, 0.25, 1]\nabsorption = 0.125\nanisotropy = 0.5\nphase = \"hg\"\n");
    let (around, scale) = (fog.view().media[0], fog.units().scale);
    assert!(near(around.scattering, [0.5, 0.25, 1.0], scale) && near(around.absorption, [0.125; 3], scale));
    assert_eq!((around.anisotropy, around.ior, around.priority), (0.5, 1.0, 0));
    for nothing in ["", "[medium]\nscattering = 0\nanisotropy = 0.5\n"] {
        assert_eq!(scene(nothing).view().media[0], Medium::VACUUM, "{nothing}");
    }
    let milk = "scattering = 2\nanisotropy = -0.25\npriority = 3\n";
    for kind in ["glass", "boundary"] {
        let scene = scene(&format!("[materials.wall]\nkind = \"{kind}\"\nabsorption = 1\n{milk}"));
        let view = scene.view();
        let index = if kind == "glass" {
            let wall = *material(&scene, "wall");
            assert_eq!((wall.kind, wall.ior, wall.albedo), (MaterialKind::Dielectric as u32, 1.5, [1.0; 3]));
            wall.medium
        } else {
            view.boundaries.media[0]
        };
        let inside = view.media[index as usize];
        assert!(near(inside.scattering, [2.0; 3], scale) && near(inside.absorption, [1.0; 3], scale), "{kind}");
        assert_eq!((inside.anisotropy, inside.priority, inside.is_matched()), (-0.25, 3, kind == "boundary"), "{kind}");
    }
    // Without coefficients a boundary bounds a vacuum, whatever its phase function.
    let empty = scene("[materials.wall]\nkind = \"boundary\"\nanisotropy = 0.5\n");
    let is_matched = empty.view().media.iter().any(Medium::is_matched);
    assert_eq!((empty.view().media[0], is_matched, empty.view().boundaries.is_empty()), (Medium::VACUUM, false, true));
    let in_box = scene("[medium]\nscattering = [0.5, 0.25, 1]\nbox = [[-100, 0, 0], [100, 2, 3]]\n");
    let (view, boundaries) = (in_box.view(), in_box.view().boundaries);
    assert_eq!((view.media[0], boundaries.triangles.len(), in_box.units().scale), (Medium::VACUUM, 12, scale));
    // Boundaries come after solids.
    let last = view.media.len() - 1;
    assert!(near(view.media[last].scattering, [0.5, 0.25, 1.0], scale) && boundaries.media == [last as u32; 12]);
    let corner = boundaries.positions[0].map(|c| c * boundaries.scale);
    assert!((in_box.units().point_to_user(corner)[0].abs() - 100.0).abs() < 1e-4, "{corner:?}");
    let clamped = scene("[medium]\nscattering = 1\nanisotropy = 0.9999\n");
    assert_eq!(clamped.view().media[0].anisotropy, 0.999);
    assert!(clamped.warnings().iter().any(|text| text.contains("ambient") && text.contains("0.9999")));

    let mie = Phase::Mie(Mie::droplets(20.0));
    for (keys, phase) in [("\"rayleigh\"", Phase::Rayleigh), ("\"mie\"\ndroplet_micrometres = 20", mie)] {
        let around = scene(&format!("[medium]\nscattering = 1\nphase = {keys}\n"));
        assert_eq!(Phase::of(&around.view().media[0]), phase);
        let within = scene(&format!("[materials.wall]\nkind = \"glass\"\nscattering = 1\nphase = {keys}\n"));
        assert_eq!(Phase::of(&within.view().media[material(&within, "wall").medium as usize]), phase);
    }

    let fault = |text: &str| message(parse(text).and_then(|overrides| load(&obj, Some(&overrides))));
    let glass = |keys: &str| fault(&format!("[materials.wall]\nkind = \"glass\"\n{keys}\n"));
    for value in ["-0.5", "nan", "inf", "[0, 0, -1]"] {
        for key in ["scattering", "absorption"] {
            names(&fault(&format!("[medium]\n{key} = {value}\n")), &["ambient medium", key, "at least 0"]);
            names(&glass(&format!("{key} = {value}")), &["'wall'", key, "at least 0"]);
        }
    }
    for g in ["1", "-1", "1.5", "nan", "inf"] {
        names(&fault(&format!("[medium]\nanisotropy = {g}\n")), &["ambient medium", "anisotropy", "-1 and 1"]);
        names(&glass(&format!("anisotropy = {g}")), &["'wall'", "anisotropy", "-1 and 1"]);
    }
    for kind in ["lambert", "mirror", "thin", "glossy"] {
        let text = format!("[materials.wall]\nkind = \"{kind}\"\nscattering = 1\n");
        names(&fault(&text), &["'wall'", kind, "no scattering", "glass and boundary have it"]);
    }
    names(
        &fault("[materials.wall]\nkind = \"glossy\"\ntransmission = 0.5\nscattering = 1\n"),
        &["'wall'", "glossy", "no scattering"],
    );
    for (key, value) in [("ior", "1.5"), ("tint", "0.5"), ("roughness", "0"), ("abbe", "60"), ("emission", "1")] {
        let text = format!("[materials.wall]\nkind = \"boundary\"\n{key} = {value}\n");
        names(&fault(&text), &["'wall'", "boundary", "no ", key]);
    }
    for (keys, expected) in [
        ("phase = \"isotropic\"", ["unknown phase", "isotropic", "\"hg\", \"rayleigh\" or \"mie\""]),
        ("droplet_micrometres = 10", ["\"hg\" with droplet_micrometres", "leave", "phase = \"mie\""]),
        (
            "phase = \"rayleigh\"\ndroplet_micrometres = 10",
            ["\"rayleigh\" with droplet_micrometres", "leave", "\"mie\""],
        ),
        ("phase = \"rayleigh\"\nanisotropy = 0", ["\"rayleigh\" with anisotropy", "leave", "phase = \"hg\""]),
        ("phase = \"mie\"\ndroplet_micrometres = 9\nanisotropy = 0", ["\"mie\" with anisotropy", "leave", "\"hg\""]),
        ("phase = \"mie\"", ["without droplet_micrometres", "give", "5 to 50"]),
        ("phase = \"mie\"\ndroplet_micrometres = 4", ["droplet_micrometres is 4", "between", "5 and 50"]),
        ("phase = \"mie\"\ndroplet_micrometres = 60", ["droplet_micrometres is 60", "between", "5 and 50"]),
        ("phase = \"mie\"\ndroplet_micrometres = nan", ["droplet_micrometres is NaN", "between", "5 and 50"]),
    ] {
        let around = fault(&format!("[medium]\nscattering = 1\n{keys}\n"));
        names(&around, &expected);
        names(&around, &["medium"]);
        let within = glass(&format!("scattering = 1\n{keys}"));
        names(&within, &expected);
        names(&within, &["'wall'"]);
    }
    for kind in ["lambert", "mirror", "thin", "glossy"] {
        let text = format!("[materials.wall]\nkind = \"{kind}\"\nphase = \"rayleigh\"\n");
        names(&fault(&text), &["'wall'", kind, "no phase", "glass and boundary have it"]);
    }
    for corners in ["[0, 0, 0], [1, 0, 1]", "[0, 0, 2], [1, 1, 1]", "[0, 0, nan], [1, 1, 1]", "[0, 0, 0], [1, inf, 1]"]
    {
        names(&fault(&format!("[medium]\nbox = [{corners}]\n")), &["ambient medium", "box", "first below the second"]);
    }
    names(&glass("density_scale = 1"), &["'wall'", "density_scale", "no grid", ".vol"]);
    names(&glass("grid = \"../a.vol\""), &["'wall'", "../a.vol", "outside the folder"]);
    names(&glass("grid = \"a.vdb\""), &["a.vdb", "unknown format", ".nvdb"]);
    names(&glass("grid = \"absent.vol\""), &["absent.vol", "cannot read"]);
    names(&fault("[materials.wall]\ngrid = \"a.vol\"\n"), &["'wall'", "lambert", "no grid"]);
    names(&fault("[medium]\nscatering = 1\n"), &["line 2", "scatering", "'scattering'"]);
    // Too dense to trace: the albedo of an equivalent surface is in the message.
    names(&glass("scattering = 1e7\nabsorption = 1e5"), &["'wall'", "scattering", "lambert", "[0.79"]);
    names(&fault("[medium]\nscattering = 1e300\n"), &["ambient medium", "scattering", "thinner"]);
}
