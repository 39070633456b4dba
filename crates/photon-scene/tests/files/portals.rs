//! Portals of override files and of builders.

use crate::support::{Folder, MTL, OBJ, message, names};
use photon_core::{Features, Portal};
use photon_scene::{MaterialDesc, Overrides, Scene, SceneBuilder, SceneError, load};

/// The file of tests, which has triangles in the plane z = 0 within 0 ≤ x, y ≤ 2, with these overrides.
fn scene(folder: &Folder, text: &str) -> Result<Scene, SceneError> {
    folder.file("scene materials.mtl", MTL);
    let obj = folder.file("scene.obj", OBJ);
    let overrides = Overrides::read(&folder.file("over.toml", text))?;
    load(&obj, Some(&overrides)).map(|(scene, _)| scene)
}

/// Area of all portals, squared user length.
fn area(scene: &Scene) -> f64 {
    let squared = |portal: &Portal| portal.area.iter().map(|&part| f64::from(part).powi(2)).sum::<f64>();
    let sum: f64 = scene.view().portals.iter().map(|portal| squared(portal).sqrt()).sum();
    sum * scene.units().scale * scene.units().scale
}

#[test]
fn names_and_corners() {
    let folder = Folder::new("portals");
    let with = |text: &str| scene(&folder, &format!("[environment]\nradiance = 1\n{text}")).unwrap();
    let none = with("");
    assert!(none.view().portals.is_empty() && !Features::of(&none.view()).contains(Features::PORTALS));
    for (text, count, expected) in [
        ("portals = [\"pane\"]", 1, 2.0),
        // The quadrilateral of the wall, in two triangles, and a mesh, with six triangles of other materials.
        ("portals = [\"wall\", \"pane\"]", 3, 6.0),
        ("[[environment.portal]]\ncorners = [[0, 0, 1], [3, 0, 1], [0, 0, 3]]", 1, 3.0),
        ("[[environment.portal]]\ncorners = [[0, 0, 1], [1, 0, 1], [1, 2, 1], [0, 2, 1]]", 2, 2.0),
        ("[[environment.portal]]\nrelative = true\ncorners = [[0, 0, 0], [0.5, 0, 0], [0, 0.5, 0]]", 1, 0.5),
    ] {
        let found = with(text);
        assert_eq!(found.view().portals.len(), count, "{text}");
        assert!((area(&found) / expected - 1.0).abs() < 1e-6, "{text}: {}", area(&found));
        assert!(Features::of(&found.view()).contains(Features::PORTALS));
        // Portals are no surfaces, and those that are named remain what they are.
        assert_eq!(found.view().triangles, none.view().triangles);
        assert_ne!(found.digest(), none.digest());
    }
    // A mesh: all of its triangles, whatever their material.
    let things = with("portals = [\"things\"]").view().portals.len();
    assert!(things >= 4, "{things}");
    // Without a light of its own, the section keeps that of the scene or of the command line.
    let bare = scene(&folder, "[environment]\nportals = [\"pane\"]").unwrap();
    assert!(bare.view().environment.is_none() && bare.view().portals.len() == 1);
    assert!(!Features::of(&bare.view()).contains(Features::PORTALS));
    assert!(bare.warnings().iter().any(|text| text.contains("portals have no effect")), "{:?}", bare.warnings());
}

#[test]
fn wrong_portals_are_named() {
    let folder = Folder::new("portals-wrong");
    let fault = |text: &str| message(scene(&folder, &format!("[environment]\nradiance = 1\n{text}\n")));
    let error = fault("portals = [\"Pan\"]");
    names(&error, &["portal 'Pan'", "did you mean 'pane'?"]);
    names(&fault("portals = [\"opening\"]"), &["portal 'opening'", "there are '", "'pane'", "'things'"]);
    let corners = |corners: &str| fault(&format!("[[environment.portal]]\nname = \"gap\"\ncorners = {corners}"));
    names(&corners("[[0, 0, 0], [1, 0, 0]]"), &["over.toml", "'gap' has 2 corners", "three, or four"]);
    names(&corners("[[0, 0, 0], [1, 1, 1], [2, 2, 2]]"), &["portal 'gap'", "no area"]);
    names(&corners("[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"), &["portal 'gap'", "no area"]);
    names(&corners("[[0, 0, 0], [1, nan, 0], [0, 1, 0]]"), &["portal 'gap'", "NaN", "finite"]);
    names(
        &corners("[[0, 0, 0], [1e30, 0, 0], [0, 1, 0]]"),
        &["portal 'gap'", "outside of the scene", "4 of its radii"],
    );
    names(&corners("[[0, 0, 0], [1, 0], [0, 1, 0]]"), &["over.toml, line"]);
    names(&fault("[[environment.portal]]\ncorner = [0, 0, 0]"), &["over.toml, line", "corner"]);
    names(
        &message(scene(&folder, "[environment]\nscale = 2\nportals = [\"pane\"]\n")),
        &["rotate_degrees or scale", "file, radiance or sky"],
    );
}

#[test]
fn at_most_64_triangles() {
    let with = |count: usize| {
        let mut builder = SceneBuilder::new();
        let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
        builder.quad("floor", [[-1., 0., 1.], [1., 0., 1.], [1., 0., -1.], [-1., 0., -1.]], white);
        let portal = [[0.0, 0.5, 0.0], [0.1, 0.5, 0.0], [0.0, 0.5, 0.1]];
        builder.portal("many", vec![portal; count]);
        builder
    };
    assert_eq!(with(64).build().unwrap().view().portals.len(), Portal::MAX);
    names(&message(with(65).build()), &["portal 'many'", "65 triangles, more than 64", "quadrilateral"]);
    names(&message(photon_scene::glb(&with(1))), &["portals cannot be written"]);
    // The same limits hold for tables that are filled by hand.
    let scene = with(64).build().unwrap();
    let portals = [scene.view().portals, &scene.view().portals[..1]].concat();
    let check = |portals| photon_core::SceneView { portals, ..scene.view() }.validate();
    let refused = |portals| check(portals).unwrap_err().to_string();
    names(&refused(&portals), &["the number of portals", "65"]);
    let flat = [Portal::new([[0.0; 3], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0]])];
    names(&refused(&flat), &["portal", "its area 0"]);
    let far = [Portal::new([[9.0, 0.0, 0.0], [9.1, 0.0, 0.0], [9.0, 0.1, 0.0]])];
    names(&refused(&far), &["portal", "its corner"]);
    assert!(check(&portals[..64]).is_ok());
}
