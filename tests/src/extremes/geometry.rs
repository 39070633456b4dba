//! S2, S5: degenerate and thin triangles, and rays aimed at shared edges and vertices.

use std::time::Instant;

use photon_core::glam::Vec3;
use photon_core::{PhotonRay, RayCaster, Settings};
use photon_scene::shapes::Shape;
use photon_scene::{Accel, LightDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use super::scenes::{anywhere, black_inside, follow, ray, turned};
use super::sheet::Sheet;
use crate::harness::{TestBackend, Uniform, film, look_at_point, trace};

/// Runs the group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    cracks::<T>(sheet);
    slivers::<T>(sheet);
    along_axes::<T>(sheet);
    no_area::<T>(sheet);
    identical::<T>(sheet);
    thin_walls::<T>(sheet);
    if sheet.long() {
        ten_million::<T>(sheet);
    }
}

/// Number of rays that leave a closed scene.
fn lost<T: TestBackend>(scene: &Scene, rays: &mut [PhotonRay]) -> u64 {
    let (_, tally) = follow::<T>(scene, &Settings { max_bounces: 1, ..Settings::default() }, rays);
    assert_eq!(tally.emitted, rays.len() as u64);
    tally.escaped + tally.dropped
}

/// Rays from positions near the middle towards the vertices and towards points on the edges of triangles.
fn aimed(scene: &Scene, count: usize, seed: u64, from: f32) -> [Vec<PhotonRay>; 2] {
    let view = scene.view();
    let mut uniform = Uniform::new(seed);
    let corner = |triangle: usize, index: usize| Vec3::from(view.positions[view.triangles[triangle][index] as usize]);
    let mut at = |on_edge: bool| {
        let triangle = (uniform.draw() * view.triangles.len() as f64) as usize;
        let (a, b) = (corner(triangle, 0), corner(triangle, 1));
        let target = if on_edge { a.lerp(b, uniform.draw() as f32) } else { a };
        let origin = anywhere(&mut uniform) * (from * uniform.draw() as f32);
        ray(origin, (target - origin).normalize())
    };
    let vertices = (0..count).map(|_| at(false)).collect();
    let edges = (0..count).map(|_| at(true)).collect();
    [vertices, edges]
}

/// S2: rays at edges and vertices of closed meshes, from inside.
fn cracks<T: TestBackend>(sheet: &mut Sheet) {
    let count = sheet.either(20_000, 1_000_000);
    let ball = turned(shapes::icosphere(sheet.either(4, 6), [0.0; 3], 1.0));
    let lens = turned(shapes::uv_sphere(96, 48, [0.0; 3], 1.0));
    for (name, shape) in [("icosphere", ball), ("sphere with poles", lens)] {
        let triangles = shape.1.len();
        let scene = black_inside(shape).build().unwrap();
        for (what, mut rays) in ["vertices", "edges"].into_iter().zip(aimed(&scene, count, 31, 0.2)) {
            let lost = lost::<T>(&scene, &mut rays);
            let range = format!("{name}, {triangles} triangles, {count} rays");
            sheet.holds("S2", format!("rays at {what} from inside: lost"), range, lost.to_string(), lost == 0);
        }
    }
}

/// A closed, rotated prism with walls, and fans of slivers in its caps, 1e6 times as long as wide.
fn sliver_room() -> Shape {
    let plan = [[-1.0, -1.0], [-1.0, 1.0], [-2e-6, 1.0], [0.0, 1.0], [1.0, 1.0], [1.0, 3e-6], [1.0, 0.0], [1.0, -1.0]];
    turned(shapes::prism(&plan, 0, -1.0, 1.0))
}

/// S5: slivers leak no rays, whether rays hit them or pass nearby.
fn slivers<T: TestBackend>(sheet: &mut Sheet) {
    let count = sheet.either(20_000, 1_000_000);
    let scene = black_inside(sliver_room()).build().unwrap();
    let dropped = scene.dropped_triangles();
    let [mut vertices, mut edges] = aimed(&scene, count, 32, 0.2);
    let lost = lost::<T>(&scene, &mut vertices) + lost::<T>(&scene, &mut edges);
    let range = format!("slivers 1:1e6, {count} rays at vertices and at edges, {dropped} triangles dropped");
    sheet.holds("S5", "closed room with slivers: rays lost", range, lost.to_string(), lost == 0);

    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [0.99; 3]));
    let (positions, triangles) = shapes::flip(sliver_room());
    builder.mesh("room", positions, triangles, wall);
    builder.light("light", LightDesc::Point { position: [0.1; 3], intensity: [1.0; 3] });
    let settings = Settings { max_bounces: 2000, ..Settings::default() };
    let (photons, tally) = trace::<T>(2, &builder.build().unwrap(), &settings, &[sheet.either(1000, 10_000)]);
    let sound = photons.values().flatten().all(super::scenes::sound);
    let out = tally.escaped + tally.dropped;
    let range = format!("{} bounces", tally.surfaces);
    let found = format!("{out} out; {}", if sound { "all photons sound" } else { "unsound photons" });
    sheet.holds("S1 S5", "diffuse bounces between slivers", range, found, out == 0 && sound);
}

/// Axis-parallel rays in an axis-aligned box, including within rounding of its walls.
fn along_axes<T: TestBackend>(sheet: &mut Sheet) {
    let scene = black_inside(shapes::cuboid([-1.0; 3], [1.0; 3])).build().unwrap();
    // Starting at the last f32 before the wall; a ray in the wall's plane has no side.
    let insets = [6e-8_f32, 1.2e-7, 2.4e-7, 1e-6, 1e-3, 0.25, 0.5];
    let mut places = Vec::new();
    for inset in insets {
        places.extend([-0.5 + inset, 0.5 - inset]);
    }
    let mut rays = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            for &a in &places {
                for &b in &places {
                    for along in [-0.45_f32, 0.0, 0.3] {
                        let mut origin = [0.0; 3];
                        origin[axis] = along;
                        origin[(axis + 1) % 3] = a;
                        origin[(axis + 2) % 3] = b;
                        let mut direction = [0.0; 3];
                        direction[axis] = sign;
                        rays.push(ray(origin.into(), direction.into()));
                        // A direction that a rounded cosine has moved slightly off the axis, or −0.
                        direction[(axis + 1) % 3] = -0.0;
                        direction[(axis + 2) % 3] = -1e-30;
                        rays.push(ray(origin.into(), direction.into()));
                    }
                }
            }
        }
    }
    let lost = lost::<T>(&scene, &mut rays);
    let range = format!("{} rays, 6e-8 to 1/2 of the box from its walls", rays.len());
    sheet.holds("S2", "axis-parallel rays in an axis-parallel box: lost", range, lost.to_string(), lost == 0);
}

fn floor(builder: &mut SceneBuilder) {
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], grey);
    builder.light("light", LightDesc::Point { position: [0.2, 1.0, 0.1], intensity: [1.0; 3] });
    look_at_point(builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.8);
}

fn picture<T: TestBackend>(builder: SceneBuilder) -> (photon_core::Film, Scene) {
    let scene = builder.build().unwrap();
    let estimator = photon_core::Estimator::Radius { radius: Some(0.2) };
    let settings = Settings { photons: 3000, estimator, direct: photon_core::Direct::Photons, ..Settings::default() };
    (film::<T>(&scene, &settings, 1, 12), scene)
}

/// S5: triangles of zero area are dropped and counted, and change nothing.
fn no_area<T: TestBackend>(sheet: &mut Sheet) {
    let mut plain = SceneBuilder::new();
    floor(&mut plain);
    let mut messy = SceneBuilder::new();
    floor(&mut messy);
    let grey = messy.material(MaterialDesc::lambert("other", [0.5; 3]));
    let on_a_line = vec![[0.0, 0.3, 0.0], [0.1, 0.3, 0.0], [0.3, 0.3, 0.0], [0.1, 0.3, 1e-200]];
    messy.mesh("flat", on_a_line, vec![[0, 1, 2], [0, 0, 1], [2, 2, 2], [0, 1, 3]], grey);
    let ((plain, _), (messy, scene)) = (picture::<T>(plain), picture::<T>(messy));
    let same = plain.pixels == messy.pixels;
    let found =
        format!("{} dropped and counted; {}", scene.dropped_triangles(), if same { "same bits" } else { "differs" });
    sheet.holds("S5", "triangles without area", "4 of 6", found, same && scene.dropped_triangles() == 4);
}

/// Ten thousand identical triangles in place of one.
fn identical<T: TestBackend>(sheet: &mut Sheet) {
    let copies = 10_000;
    let mut plain = SceneBuilder::new();
    floor(&mut plain);
    let mut many = SceneBuilder::new();
    floor(&mut many);
    let grey = many.material(MaterialDesc::lambert("again", [0.5; 3]));
    let (positions, triangles) = shapes::quad([[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]]);
    many.mesh("again", positions, triangles.repeat(copies / 2), grey);
    let ((plain, _), (many, _)) = (picture::<T>(plain), picture::<T>(many));
    let same = plain.pixels == many.pixels;
    let found = if same { "same bits" } else { "differs" };
    sheet.holds("S2", "identical triangles: the picture of one", format!("{copies} in one place"), found, same);
}

/// S26 and S25: light on one side of a sheet, or of a corner, does not reach the other.
fn thin_walls<T: TestBackend>(sheet: &mut Sheet) {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let (y, h) = (0.002, 1.0);
    builder.quad("lower", [[-h, 0.0, -h], [h, 0.0, -h], [h, 0.0, h], [-h, 0.0, h]], grey);
    builder.quad("upper", [[-h, y, h], [h, y, h], [h, y, -h], [-h, y, -h]], grey);
    builder.light("light", LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [1.0; 3] });
    look_at_point(&mut builder, [0.0; 3], [0.0, -1.0, 0.0], 0.5, 0.5);
    let (seen, _) = picture::<T>(builder);
    let most = super::scenes::mean(&seen, None);
    let range = "sheet of a hundredth of the radius, lit from the other side";
    sheet.holds("S25 S26", "light that comes through an opaque sheet", range, format!("{most:e}"), most == 0.0);
}

/// A mesh of ten million triangles: build cost, and whether it leaks.
fn ten_million<T: TestBackend>(sheet: &mut Sheet) {
    let shape = shapes::uv_sphere(3200, 1600, [0.0; 3], 1.0);
    let triangles = shape.1.len();
    let start = Instant::now();
    let scene = black_inside(shape).build().unwrap();
    let (built, view) = (start.elapsed().as_secs_f64(), scene.view());
    let start = Instant::now();
    let tree = Accel::build(view.positions, view.triangles).unwrap();
    let (tree, seconds) = (tree.bytes(), start.elapsed().as_secs_f64());
    let found = format!(
        "scene {built:.1} s, {} bytes a triangle; tree {seconds:.1} s, {} bytes a triangle",
        (12 * view.positions.len() + 28 * triangles) / triangles,
        tree / triangles as u64
    );
    sheet.holds("S2", "a large mesh: building it, on the host", format!("{triangles} triangles"), found, tree > 0);

    let [mut vertices, mut edges] = aimed(&scene, 200_000, 33, 0.2);
    let found = [lost::<T>(&scene, &mut vertices), lost::<T>(&scene, &mut edges)];
    let range = format!("{triangles} triangles, {} rays at vertices, as many at edges", vertices.len());
    let good = found == [0, 0];
    sheet.holds("S2", "a large mesh, closed: rays lost", range, format!("{}, {}", found[0], found[1]), good);
}
