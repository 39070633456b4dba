//! S28, S29, S32: cameras and lights at their ends.

use photon_core::glam::Vec3;
use photon_core::{Layer, Settings, sampling};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, shapes};

use super::scenes::mean;
use super::sheet::Sheet;
use crate::harness::{TestBackend, film, look_at_point, trace};

/// The group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    fields_of_view::<T>(sheet);
    inside_glass::<T>(sheet);
    frames(sheet);
    cones::<T>(sheet);
    small_area_light::<T>(sheet);
    large_picture::<T>(sheet);
}

/// A closed ball whose inside glows evenly, which every ray must see: 1 W/(m²·sr) in every pixel.
fn glowing(camera: CameraDesc, with: impl FnOnce(&mut SceneBuilder)) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [0.5; 3], [1.0; 3]));
    let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], 1.0));
    builder.mesh("ball", positions, triangles, wall);
    with(&mut builder);
    builder.camera("camera", camera);
    builder
}

/// Largest relative error of the emission over all pixels and channels.
fn worst<T: TestBackend>(builder: SceneBuilder, truth: f64, size: u32) -> f64 {
    let scene = builder.build().unwrap();
    let settings = Settings {
        photons: 1,
        direct: photon_core::Direct::None,
        indirect: photon_core::Indirect::None,
        caustics: false,
        ..Settings::default()
    };
    let film = film::<T>(&scene, &settings, 2, size);
    let all = film.layer(Layer::Emission);
    all.iter()
        .flatten()
        .map(|&c| (f64::from(c) / truth - 1.0).abs())
        .fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
}

fn looking(degrees: f64) -> CameraDesc {
    let projection = Projection::Perspective { vertical_fov: degrees.to_radians() };
    CameraDesc::new([0.1, 0.2, -0.3], [0.3, -0.2, 0.9], [0.0, 1.0, 0.0], projection)
}

fn fields_of_view<T: TestBackend>(sheet: &mut Sheet) {
    let all = vec![1e-3, 1.0, 90.0, 179.9];
    for degrees in sheet.choose(vec![1e-3, 179.9], all.clone(), all) {
        let error = worst::<T>(glowing(looking(degrees), |_| ()), 1.0, 24);
        let what = "uniform radiance all around: largest error of a pixel";
        sheet.holds("camera", what, format!("field of view {degrees}°"), format!("{error:.1e}"), error < 1e-5);
    }
    let half_height = 1e-6;
    let camera = looking(1.0).with_projection(Projection::Orthographic { half_height });
    let error = worst::<T>(glowing(camera, |_| ()), 1.0, 24);
    sheet.holds(
        "camera",
        "the same by parallel rays",
        "half height 1e-6 of the scene",
        format!("{error:.1e}"),
        error < 1e-5,
    );
}

/// A camera in a solid: what it sees through the boundary is dimmed by reflection, but the rest of the same glow is
/// reflected: together they are n² of the glow, without absorption (Veach 1997, section 5.2).
fn inside_glass<T: TestBackend>(sheet: &mut Sheet) {
    let builder = glowing(looking(60.0), |builder| {
        let glass = builder.material(MaterialDesc::glass("glass", 1.5));
        let (positions, triangles) = shapes::cuboid([-0.4; 3], [0.45; 3]);
        builder.mesh("block", positions, triangles, glass);
    });
    let scene = builder.build().unwrap();
    let settings = Settings {
        photons: 1,
        direct: photon_core::Direct::None,
        indirect: photon_core::Indirect::None,
        caustics: false,
        ..Settings::default()
    };
    let seen = mean(&film::<T>(&scene, &settings, sheet.either(8, 64), 24), Some(Layer::Emission));
    // n² of it; paths that total reflection keeps in the block see nothing, which only ever darkens.
    let range = "inside a block of glass, ior 1.5";
    sheet.holds(
        "camera",
        "an even glow seen from inside glass",
        range,
        format!("{seen:.4}"),
        seen > 0.45 && seen <= 2.25 * (1.0 + 1e-5),
    );
}

/// S28: frames about any direction.
fn frames(sheet: &mut Sheet) {
    let tiny = f32::from_bits(1);
    let mut worst = 0.0_f32;
    for z in [1.0_f32, -1.0] {
        for (x, y) in [(0.0, 0.0), (tiny, -tiny), (1e-20, 1e-20), (1e-4, -1e-4), (-0.0, 0.0)] {
            let normal = Vec3::new(x, y, z).normalize();
            let (tangent, bitangent) = sampling::basis(normal);
            for error in [
                tangent.dot(bitangent),
                tangent.dot(normal),
                bitangent.dot(normal),
                tangent.length() - 1.0,
                bitangent.length() - 1.0,
            ] {
                worst = worst.max(error.abs());
            }
        }
    }
    sheet.holds(
        "S28",
        "frames are orthonormal",
        "normals at and about ±z, denormal tilts",
        format!("{worst:.1e}"),
        worst <= 1e-6,
    );
}

/// Spots of any width: the flux through a disc on the floor within the cone, beside `I·2π(1 − cos θ)`.
fn cones<T: TestBackend>(sheet: &mut Sheet) {
    let scene_of = |degrees: f64| {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
        let w = 2.0;
        builder.quad("floor", [[-w, 0.0, w], [w, 0.0, w], [w, 0.0, -w], [-w, 0.0, -w]], grey);
        let angle = degrees.to_radians();
        builder.light(
            "spot",
            LightDesc::Spot {
                position: [0.0, 1.0, 0.0],
                direction: [0.0, -1.0, 0.0],
                intensity: [1.0; 3],
                inner_angle: angle,
                outer_angle: angle,
            },
        );
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.2 * angle.min(0.5).tan());
        builder
    };
    let all = vec![0.001, 0.005, 0.05, 1.0, 30.0, 90.0];
    for degrees in sheet.choose(vec![0.005], all.clone(), all) {
        let scene = scene_of(degrees).build().unwrap();
        let angle = f64::to_radians(degrees);
        let truth = std::f64::consts::TAU * 2.0 * (0.5 * angle).sin().powi(2);
        let power = scene.units().power / truth - 1.0;
        let settings = Settings { photons: 20_000, max_bounces: 1, ..Settings::default() };
        let (photons, _) = trace::<T>(2, &scene, &settings, &[20_000]);
        let out = photons[photon_core::MapKind::Direct].iter().filter(|photon| {
            let [x, _, z] = scene.units().point_to_user(photon.position);
            (x * x + z * z).sqrt() > angle.tan() * 1.001 + 1e-6
        });
        let out = if degrees < 90.0 { out.count() } else { 0 };
        let settings = Settings {
            photons: 1,
            shadow_rays: 1,
            indirect: photon_core::Indirect::None,
            caustics: false,
            ..Settings::default()
        };
        let seen = mean(&film::<T>(&scene, &settings, 1, 8), Some(Layer::Direct)) * std::f64::consts::PI / 0.5;
        let found = format!("power {power:+.1e}; {out} photons outside; E = {seen:.5} W/m² (1)");
        let near = if degrees < 30.0 { 1e-3 } else { 0.02 };
        let good = power.abs() < 1e-5 && out == 0 && (seen - 1.0).abs() < near;
        sheet.holds(
            "spot",
            "power, photons outside of the cone, irradiance on the axis",
            format!("half angle {degrees}°"),
            found,
            good,
        );
    }
    let refused = scene_of(5e-4).build().err().is_some_and(|error| error.to_string().contains("spot"));
    let what = "a cone narrower than 1e-5 radians, which f32 directions would blur";
    sheet.limit("spot", what, "half angle 0.0005°", if refused { "refused by name" } else { "accepted" }, refused);
}

/// An area light of a millionth of the scene, far above a floor: as a point of its power.
fn small_area_light<T: TestBackend>(sheet: &mut Sheet) {
    let side = 2e-6;
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], grey);
    let area_light = builder.material(MaterialDesc::emissive("area light", [0.0; 3], [1.0 / side / side; 3]));
    let h = 0.5 * side;
    builder.quad("area light", [[-h, 1.0, -h], [h, 1.0, -h], [h, 1.0, h], [-h, 1.0, h]], area_light);
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 1e-3);
    let scene = builder.build().unwrap();
    let settings =
        Settings { photons: 1, indirect: photon_core::Indirect::None, caustics: false, ..Settings::default() };
    let seen = mean(&film::<T>(&scene, &settings, 4, 8), Some(Layer::Direct)) * std::f64::consts::PI / 0.5;
    // L·A/h² on the axis, 1 W/m²; over the pixels it falls by 2 r² < 1e-6·4.
    let power = scene.units().power / std::f64::consts::PI - 1.0;
    let (_, tally) = trace::<T>(2, &scene, &Settings::default(), &[20_000]);
    let good = (seen - 1.0).abs() < 1e-4 && power.abs() < 1e-6 && tally.balances() && tally.dropped == 0;
    let found = format!("E = {seen:.6} W/m² (1), power {power:+.1e}");
    sheet.holds("area light", "an area light far smaller than the scene", "1e-6 of the scene across", found, good);
}

/// S32: more pixels than one axis of a dispatch has groups for.
fn large_picture<T: TestBackend>(sheet: &mut Sheet) {
    if !sheet.long() {
        return;
    }
    let size = 2300;
    let error = worst::<T>(glowing(looking(50.0), |_| ()), 1.0, size);
    sheet.holds(
        "S32",
        "uniform radiance in every pixel of a large picture",
        format!("{size} × {size}"),
        format!("{error:.1e}"),
        error < 1e-5,
    );
}
