//! Surfaces that coincide are set apart in an order that does not depend on that of the meshes.

use glam::{DMat3, DVec3, Vec3};
use photon_core::offset::STEP;
use photon_scene::{MaterialDesc, Scene, SceneBuilder, Surface, shapes};

type Add<'a> = &'a dyn Fn(&mut SceneBuilder, &dyn Fn([f64; 3]) -> [f64; 3]);

fn glass(ior: f64, absorption: f64) -> MaterialDesc {
    MaterialDesc::new("g", Surface::Dielectric { ior, absorption: [absorption; 3], tint: [1.0; 3], roughness: 0.0 })
}

fn block(
    name: &'static str,
    material: MaterialDesc,
    low: [f64; 3],
    high: [f64; 3],
) -> impl Fn(&mut SceneBuilder, &dyn Fn([f64; 3]) -> [f64; 3]) {
    move |scene, place| {
        let id = scene.material(material.clone());
        let (positions, triangles) = shapes::cuboid(low, high);
        scene.mesh(name, positions.into_iter().map(place).collect(), triangles, id);
    }
}

/// A square in the plane y = 0.
fn sheet(name: &'static str, half: f64, is_up: bool) -> impl Fn(&mut SceneBuilder, &dyn Fn([f64; 3]) -> [f64; 3]) {
    move |scene, place| {
        let id = scene.material(MaterialDesc::lambert(name, [0.1 * half; 3]));
        let mut corners = [[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]];
        if !is_up {
            corners.reverse();
        }
        scene.quad(name, corners.map(place), id);
    }
}

fn build(parts: &[Add<'_>], order: &[usize], place: &dyn Fn([f64; 3]) -> [f64; 3]) -> Scene {
    let mut scene = SceneBuilder::new();
    order.iter().for_each(|&part| parts[part](&mut scene, place));
    scene.build().expect("a scene")
}

/// Where a line upwards at the origin of the plane y = 0 meets a mesh there, in steps above that plane.
fn heights(scene: &Scene, mesh: &str, place: &dyn Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    let (view, units) = (scene.view(), scene.units());
    let normalised = |at: [f64; 3]| (DVec3::from(place(at)) - DVec3::from(units.center)) / units.scale;
    let from = normalised([0.013, 0.0, 0.017]);
    let up = (normalised([0.013, 1.0, 0.017]) - from).normalize_or_zero();
    (0..view.triangles.len() as u32)
        .filter(|&triangle| scene.mesh_of_triangle(triangle) == mesh)
        .filter_map(|triangle| {
            let [a, b, c] =
                view.triangles[triangle as usize].map(|vertex| Vec3::from(view.positions[vertex as usize]).as_dvec3());
            let normal = (b - a).cross(c - a);
            let height = normal.dot(a - from) / normal.dot(up);
            let at = from + up * height;
            let is_inside = [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| (q - p).cross(at - p).dot(normal) >= 0.0);
            (is_inside && height.abs() < 1e-3).then_some(height / f64::from(STEP))
        })
        .collect()
}

/// Steps by which the surface of `high` is above that of `low`, in the plane y = 0: the least over all orders of meshes,
/// and over the scene as it is, and turned, moved and scaled.
fn clearance(parts: &[Add<'_>], low: &str, high: &str) -> f64 {
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, -0.7, 0.5).normalize_or_zero(), 0.83);
    let mut least = f64::INFINITY;
    for (scale, is_turned) in [(1.0, false), (1e-3, true), (1e6, true)] {
        let place = |at: [f64; 3]| {
            let at = DVec3::from(at) * scale;
            if is_turned {
                (turn * at + DVec3::splat(0.3 * scale)).as_vec3().as_dvec3().to_array()
            } else {
                at.to_array()
            }
        };
        let forwards: Vec<usize> = (0..parts.len()).collect();
        let backwards: Vec<usize> = forwards.iter().rev().copied().collect();
        for order in [forwards, backwards] {
            let scene = build(parts, &order, &place);
            assert!(scene.warnings().iter().all(|line| !line.contains("could not")), "{:?}", scene.warnings());
            let [low, high] = [low, high].map(|mesh| heights(&scene, mesh, &place));
            assert!(!low.is_empty() && !high.is_empty(), "{low:?} {high:?}");
            least = high.iter().flat_map(|high| low.iter().map(move |low| high - low)).fold(least, f64::min);
        }
    }
    least
}

#[test]
fn order_follows_from_geometry_and_media() {
    let floor = sheet("floor", 4.0, true);
    let turned = sheet("turned", 4.0, false);
    let picture = sheet("picture", 1.0, true);
    let upper = block("upper", glass(1.5, 0.0), [-3.0, 0.0, -3.0], [3.0, 1.0, 3.0]);
    let lower = block("lower", glass(1.33, 1.0), [-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]);
    let box_on_it = block("box", MaterialDesc::lambert("box", [0.3; 3]), [-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
    let cases: [(&str, &[Add<'_>], &str, &str); 8] = [
        ("a film of air on a floor", &[&floor, &upper], "floor", "upper"),
        ("on one that faces down", &[&turned, &upper], "turned", "upper"),
        ("beneath a sheet", &[&floor, &lower], "lower", "floor"),
        ("optical contact: each reaches into the other", &[&lower, &upper], "upper", "lower"),
        ("a picture in front", &[&floor, &picture], "floor", "picture"),
        ("glass on a picture", &[&floor, &picture, &upper], "picture", "upper"),
        ("a picture below glass on a floor", &[&floor, &picture, &upper], "floor", "picture"),
        ("a box on a floor", &[&floor, &box_on_it], "floor", "box"),
    ];
    for (name, parts, low, high) in cases {
        let found = clearance(parts, low, high);
        assert!((3.0..=9.0).contains(&found), "{name}: {found} steps");
        // The comparator tells the other order.
        assert!(clearance(parts, high, low) < -3.0, "{name}");
    }
}

/// A plate that is thinner than what is resolved is shown thicker, on what it lies on; how thin it is, and the remedy, are
/// said.
#[test]
fn thin_solids_are_shown_thicker_and_named() {
    let floor = sheet("floor", 4.0, true);
    let identity = |at: [f64; 3]| at;
    for (thickness, is_thin) in [(0.0, true), (1e-9, true), (1e-7, true), (6e-6, true), (4e-5, false)] {
        let plate = block("plate", glass(1.5, 0.0), [-3.0, 0.0, -3.0], [3.0, thickness, 3.0]);
        for order in [[0, 1], [1, 0]] {
            let scene = build(&[&floor, &plate], &order, &identity);
            let mut faces = heights(&scene, "plate", &identity);
            faces.sort_by(f64::total_cmp);
            let ground = heights(&scene, "floor", &identity)[0];
            let steps = thickness / 8.0 / f64::from(STEP);
            assert!(faces.len() == 2 && faces[0] - ground >= 3.0, "{thickness}: {faces:?} over {ground}");
            let found = faces[1] - faces[0];
            let expected = if is_thin { steps + 4.0 } else { steps };
            assert!((found - expected).abs() < 0.3, "{thickness}: {found} steps for {expected}");
            let warnings = scene.warnings();
            let says = |text: &str| warnings.iter().any(|line| line.contains(text));
            assert_eq!(says("the solid 'plate'") && says("make it kind = thin"), is_thin, "{thickness}: {warnings:?}");
            assert!(says("'plate' and 'floor' touch; a film of air"), "{thickness}: {warnings:?}");
            // Its sides have no area then.
            let flat = usize::from(thickness == 0.0);
            assert!(warnings.len() == 1 + usize::from(is_thin) + flat, "{thickness}: {warnings:?}");
        }
    }
    // Two parts of one solid that touch are none: they are said to.
    let parts = |scene: &mut SceneBuilder, place: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let id = scene.material(glass(1.5, 0.0));
        let (mut positions, mut triangles) = shapes::cuboid([-3.0, 0.0, -3.0], [3.0, 1.0, 3.0]);
        let (others, more) = shapes::cuboid([-2.0, -1.0, -2.0], [2.0, -1e-6, 2.0]);
        triangles.extend(more.iter().map(|corners| corners.map(|corner| corner + positions.len() as u32)));
        positions.extend(others);
        scene.mesh("parts", positions.into_iter().map(place).collect(), triangles, id);
    };
    let scene = build(&[&parts], &[0], &identity);
    assert!(
        scene.warnings().len() == 1 && scene.warnings()[0].starts_with("parts of 'parts' touch; optical"),
        "{:?}",
        scene.warnings()
    );
}

#[test]
fn nothing_moves_where_nothing_coincides() {
    let identity = |at: [f64; 3]| at;
    // A gap of 10⁻⁴ of the scene, and planes that cross.
    let apart = block("apart", glass(1.5, 0.0), [-3.0, 8e-4, -3.0], [3.0, 1.0, 3.0]);
    let scene = build(&[&sheet("floor", 4.0, true), &apart], &[0, 1], &identity);
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let found = heights(&scene, "apart", &identity)[0] * f64::from(STEP);
    assert!((found - 1e-4).abs() < 1e-7, "{found}");
}

#[test]
fn faces_within_one_medium_are_removed() {
    let identity = |at: [f64; 3]| at;
    let upper = block("upper", glass(1.5, 1.0), [-2.0, 0.0, -2.0], [2.0, 1.0, 2.0]);
    let lower = block("lower", glass(1.5, 1.0), [-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]);
    let scene = build(&[&upper, &lower], &[0, 1], &identity);
    assert_eq!((scene.view().triangles.len(), scene.dropped_triangles()), (20, 4), "{:?}", scene.warnings());
    assert_eq!(scene.triangle_sources().count(), 20);
    assert!(scene.warnings().iter().all(|line| !line.contains("closed")), "{:?}", scene.warnings());
    // Of another medium, or smaller, they stay.
    let other = block("lower", glass(1.4, 1.0), [-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]);
    assert_eq!(build(&[&upper, &other], &[0, 1], &identity).view().triangles.len(), 24);
    let small = block("lower", glass(1.5, 1.0), [-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]);
    assert_eq!(build(&[&upper, &small], &[0, 1], &identity).view().triangles.len(), 24);
}
