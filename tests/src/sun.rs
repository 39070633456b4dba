//! G11: the sun as a disc of constant radiance L and angular radius δ, whose irradiance is `π L sin² δ`.

use std::f64::consts::PI;

use photon_core::{CausticPhotons, Direct, Estimator, Pipeline, Render, Settings, View};
use photon_scene::{CameraDesc, MaterialDesc, Projection, SceneBuilder, Sun, VertexAttributes};

use crate::harness::{TestBackend, direct_settings, film, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

const RADII: [f64; 2] = [1.0, 30.0];

fn sine_squared(degrees: f64) -> f64 {
    degrees.to_radians().sin().powi(2)
}

/// A sun of radiance 1 above, `towards` which its light comes from.
fn sun(towards: [f64; 3], radius_degrees: f64) -> Sun {
    let irradiance = PI * sine_squared(radius_degrees);
    Sun::new(towards.map(|c| -c), [irradiance; 3]).with_radius_degrees(radius_degrees)
}

/// A diffuse square around `center`, facing up or down, and a camera before it.
fn plate(builder: &mut SceneBuilder, center: [f64; 3], half: f64, up: bool) {
    let [x, y, z] = center;
    let material = builder.material(MaterialDesc::lambert("plate", [0.5; 3]));
    let side = if up { half } else { -half };
    let corners = [[-half, side], [half, side], [half, -side], [-half, -side]].map(|[a, b]| [x + a, y, z + b]);
    builder.quad("plate", corners, material);
    let normal = if up { [0.0, 1.0, 0.0] } else { [0.0, -1.0, 0.0] };
    look_at_point(builder, center, normal, 0.3, 0.02 * half);
}

/// The irradiance of a plate is `π L sin² δ cos θ`, by shadow rays and by photons; the radii differ by a factor of 820.8.
pub fn g11_irradiance<T: TestBackend>() {
    assert!((sine_squared(RADII[1]) / sine_squared(RADII[0]) - 820.8).abs() < 0.05);
    for degrees in RADII {
        for towards in [[0.0, 1.0, 0.0], [0.48, 0.6, -0.64]] {
            for direct in [Direct::Nee, Direct::Photons] {
                let mut builder = SceneBuilder::new();
                plate(&mut builder, [0.0; 3], 1.0, true);
                builder.sun(sun(towards, degrees));
                let values = per_pass::<T>(&builder.build().unwrap(), &direct_settings(direct, 0.2), 8, 4);
                let truth = 0.5 * sine_squared(degrees) * towards[1];
                let what = format!("{degrees} degrees, {towards:?}, {direct:?}");
                assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 2e-5 * truth);
            }
        }
    }
}

/// A camera sees the disc: its mean over a picture is that of the disc's share of the image plane. A picture with a
/// transparent background lacks it.
pub fn g11_seen_by_the_camera<T: TestBackend>() {
    for degrees in RADII {
        let mut builder = SceneBuilder::new();
        plate(&mut builder, [0.0, -3.0, 0.0], 1.0, true);
        builder.sun(sun([0.6, 0.8, 0.0], degrees));
        let slope = 1.5 * degrees.to_radians().tan();
        let projection = Projection::Perspective { vertical_fov: 2.0 * slope.atan() };
        builder.camera("up", CameraDesc::new([0.0; 3], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0], projection));
        let scene = builder.build().unwrap();
        let view = View { camera: scene.camera(Some("up"), 16, 16).unwrap(), width: 16, height: 16 };
        let settings = Settings { caustics: false, ..direct_settings(Direct::None, 0.2) };
        let mean = |settings: Settings| {
            let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
            for pass in 0..16 {
                renderer.pass(pass, &mut ()).unwrap();
            }
            let beauty = renderer.film().unwrap().beauty();
            beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64
        };
        let truth = PI / 4.0 / 1.5_f64.powi(2);
        // The rim passes through 60 of the 256 pixels, whose share has a deviation of 0.3 at most for each of 16 samples.
        let bound = 4.5 * 60_f64.sqrt() / 256.0 * 0.3 / 4.0;
        let found = mean(settings.clone());
        assert!((found - truth).abs() < bound, "{degrees}: {found} instead of {truth}");
        assert_eq!(mean(Settings { transparent_background: true, ..settings }), 0.0);
    }
}

/// A paraboloid mirror with focal length 1 up to an angle of 45 degrees at the focus.
fn paraboloid(builder: &mut SceneBuilder, reflectance: f64, [rings, segments]: [u32; 2], smooth: bool) {
    let rim = 2.0 * (PI / 8.0).tan();
    let (mut positions, mut normals) = (vec![[0.0; 3]], vec![[0.0, 1.0, 0.0]]);
    let mut triangles = Vec::new();
    for ring in 1..=rings {
        let r = rim * f64::from(ring) / f64::from(rings);
        let index = |ring: u32, step: u32| if ring == 0 { 0 } else { 1 + (ring - 1) * segments + step % segments };
        for step in 0..segments {
            let (sin, cos) = (2.0 * PI * f64::from(step) / f64::from(segments)).sin_cos();
            positions.push([r * cos, 0.25 * r * r, r * sin]);
            normals.push([-0.5 * r * cos, 1.0, -0.5 * r * sin]);
            triangles.push([index(ring - 1, step), index(ring, step + 1), index(ring, step)]);
            if ring > 1 {
                triangles.push([index(ring - 1, step), index(ring - 1, step + 1), index(ring, step + 1)]);
            }
        }
    }
    let material = builder.material(MaterialDesc::mirror("paraboloid", [reflectance; 3]));
    let attributes =
        if smooth { VertexAttributes::default().with_normals(normals) } else { VertexAttributes::default() };
    builder.mesh_with("paraboloid", positions, triangles, attributes, material);
}

/// From the focus of a paraboloid towards the sun, the sun fills the mirror: radiance ρ L, whatever δ. Without vertex
/// normals, triangles that span 2 degrees would show a sun of radius 1 degree in some directions only.
pub fn g11_seen_in_a_paraboloid<T: TestBackend>() {
    let reflectance = 0.8;
    let seen = |degrees: f64, smooth: bool| {
        let mut builder = SceneBuilder::new();
        let projection = Projection::Perspective { vertical_fov: 60_f64.to_radians() };
        builder.camera("focus", CameraDesc::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], projection));
        paraboloid(&mut builder, reflectance, [12, 40], smooth);
        builder.sun(sun([0.0, 1.0, 0.0], degrees));
        plate(&mut builder, [2.0, 0.0, 0.0], 0.1, true);
        let s = Settings { caustics: false, ..direct_settings(Direct::None, 0.2) };
        film::<T>(&builder.build().unwrap(), &s, 2, 12).beauty()
    };
    let wrong = |pixels: &[[f32; 3]]| {
        pixels.iter().filter(|pixel| (f64::from(pixel[1]) / reflectance - 1.0).abs() > 1e-4).count()
    };
    for degrees in RADII {
        let pixels = seen(degrees, true);
        assert_eq!(wrong(&pixels), 0, "{degrees}: {pixels:?}");
    }
    assert!(wrong(&seen(1.0, false)) > 20);
}

/// At the focus, irradiance is `ρ π L sin² θ` for the angle θ of the rim, whatever δ, less the part that the plate
/// shadows: photons by way of the mirror.
pub fn g11_focus_of_a_paraboloid<T: TestBackend>() {
    let (reflectance, half) = (0.8, 0.08);
    for (degrees, radius) in [(1.0, 0.005), (30.0, 0.035)] {
        let mut builder = SceneBuilder::new();
        plate(&mut builder, [0.0, 1.0, 0.0], half, false);
        paraboloid(&mut builder, reflectance, [48, 128], true);
        builder.sun(sun([0.0, 1.0, 0.0], degrees));
        let estimator = Estimator::Radius { radius: Some(radius) };
        let s = Settings { photons: 50_000, estimator, ..direct_settings(Direct::Nee, 0.2) };
        let values = per_pass::<T>(&builder.build().unwrap(), &s, 12, 2);
        let truth = 0.5 * reflectance * (0.5 - 4.0 * half * half / PI);
        // Half of the shadow of the plate, which has the penumbra of the sun.
        let bound = 0.5 * 0.5 * reflectance * 4.0 * half * half / PI * degrees / 30.0 + 5e-3 * truth;
        assert_agrees(&format!("{degrees} degrees"), moments(&values).0, truth, standard_error(&values), bound);
    }
}

/// A small mirror in the sun throws `E A ρ cos θ` onto a plate, by ordinary photons and by photons that are aimed at it:
/// those that miss it for one point of the disc hit it for another.
pub fn g11_aimed_at_a_mirror<T: TestBackend>() {
    let (degrees, half) = (10.0, 0.05);
    let mut builder = SceneBuilder::new();
    plate(&mut builder, [-0.75, 1.0, 0.0], 0.65, false);
    let mirror = builder.material(MaterialDesc::mirror("mirror", [0.8; 3]));
    let corners = [[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]];
    builder.quad("mirror", corners, mirror);
    builder.sun(sun([0.6, 0.8, 0.0], degrees));
    let projection = Projection::Orthographic { half_height: 0.65 };
    builder.camera("plate", CameraDesc::new([-0.75, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], projection));
    let scene = builder.build().unwrap();
    let flux = PI * sine_squared(degrees) * 0.8 * 4.0 * half * half * 0.8;
    let truth = 0.5 / PI * flux / (4.0 * 0.65 * 0.65);
    for caustic_photons in [CausticPhotons::Shared, CausticPhotons::Aimed(20_000)] {
        let s = Settings { caustic_photons, ..direct_settings(Direct::Nee, 0.03) };
        let view = View { camera: scene.camera(Some("plate"), 16, 16).unwrap(), width: 16, height: 16 };
        let mut values = Vec::new();
        for seed in 0..8 {
            let settings = Settings { seed, ..s.clone() };
            let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
            renderer.pass(0, &mut ()).unwrap();
            let beauty = renderer.film().unwrap().beauty();
            values.push(beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64);
        }
        let what = format!("{caustic_photons:?}");
        assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 5e-3 * truth);
    }
}
