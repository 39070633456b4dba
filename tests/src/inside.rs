//! Radiance, photons and absorption on the far side of a boundary: cameras, lights and surfaces inside solids.

use photon_core::{Direct, Estimator, Indirect, Settings};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Surface, shapes};
use std::f64::consts::PI;

use crate::harness::{TestBackend, film, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

/// Diffuse reflectance from inside of an index of 1.5 and 1.33 (T3).
const INSIDE: [(f64, f64); 2] = [(1.5, 0.596_345_8), (1.33, 0.471_949_1)];

/// Reflectance at normal incidence.
pub(crate) fn normal_reflectance(n: f64) -> f64 {
    ((n - 1.0) / (n + 1.0)).powi(2)
}

/// A shaft with sides of perfect mirrors, hence an endless plane: glass below y = 0, a floor within it at y = -0.5, a
/// ceiling at y = 1. Floor and ceiling face each other and have albedo and radiance as given.
fn shaft(n: f64, floor: (f64, f64), ceiling: (f64, f64)) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
    let glass = builder.material(MaterialDesc::glass("glass", n));
    let [floor, ceiling] = [("floor", floor), ("ceiling", ceiling)]
        .map(|(name, (albedo, radiance))| builder.material(MaterialDesc::emissive(name, [albedo; 3], [radiance; 3])));
    let plane = |y: f64| [[-1.0, y, 1.0], [1.0, y, 1.0], [1.0, y, -1.0], [-1.0, y, -1.0]];
    builder.quad("floor", plane(-0.5), floor);
    let mut above = plane(1.0);
    above.reverse();
    builder.quad("ceiling", above, ceiling);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    for (i, [x0, z0]) in corners.into_iter().enumerate() {
        let [x1, z1] = corners[(i + 1) % 4];
        builder.quad("side", [[x0, -0.5, z0], [x1, -0.5, z1], [x1, 1.0, z1], [x0, 1.0, z0]], mirror);
    }
    // Into the sides and below the floor, so that no film of air is between.
    let (positions, triangles) = shapes::cuboid([-1.1, -0.6, -1.1], [1.1, 0.0, 1.1]);
    builder.mesh("glass", positions, triangles, glass);
    builder
}

/// Looks along y, up or down, at a square of side 0.6 about the axis.
fn camera(builder: &mut SceneBuilder, y: f64, up: bool) {
    let direction = [0.0, if up { 1.0 } else { -1.0 }, 0.0];
    let projection = Projection::Orthographic { half_height: 0.3 };
    builder.camera("axis", CameraDesc::new([0.0, y, 0.0], direction, [0.0, 0.0, 1.0], projection));
}

fn settings() -> Settings {
    Settings {
        photons: 20_000,
        max_bounces: 4096,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(0.25) },
        ..Settings::default()
    }
}

fn check<T: TestBackend>(what: &str, builder: SceneBuilder, settings: &Settings, truth: f64) {
    check_within::<T>(what, builder, settings, truth, 0.0);
}

/// The mean of 10 passes; its standard error is that of independent values. Emission alone has none, but roundings.
fn check_within<T: TestBackend>(what: &str, builder: SceneBuilder, settings: &Settings, truth: f64, bound: f64) {
    let scene = builder.build().unwrap();
    let values = per_pass::<T>(&scene, settings, 10, 6);
    assert_agrees(what, moments(&values).0, truth, standard_error(&values), bound + 2e-6 * truth);
}

/// G1: an even sky over a diffuse floor in glass, seen along the normal from outside:
/// `R + (1−R)ρ(1−Rᵢ)/(1−ρRᵢ)`; from inside, the floor is `ρ(1−Rₑ)/(1−ρRᵢ)` with `1−Rₑ = n²(1−Rᵢ)`, and what is above
/// `n²(1−R) + R·floor`.
pub fn g1_even_sky_over_glass<T: TestBackend>() {
    for (albedo, n, truth) in [(0.5, 1.5, 0.316_070_9), (0.8, 1.33, 0.685_129_6), (1.0, 1.5, 1.0)] {
        let mut builder = shaft(n, (albedo, 0.0), (0.0, 1.0));
        camera(&mut builder, 0.5, false);
        check::<T>(&format!("from outside, {albedo}, {n}"), builder, &settings(), truth);
    }
    for (n, inside) in INSIDE {
        let (albedo, r) = (0.5, normal_reflectance(n));
        let floor = albedo * n * n * (1.0 - inside) / (1.0 - albedo * inside);
        for (up, truth) in [(false, floor), (true, n * n * (1.0 - r) + r * floor)] {
            let mut builder = shaft(n, (albedo, 0.0), (0.0, 1.0));
            camera(&mut builder, -0.25, up);
            check::<T>(&format!("from inside, {n}, upwards {up}"), builder, &settings(), truth);
        }
    }
}

/// The factor of n² makes a difference that the comparison above sees: without it the floor's part is n² as large.
#[must_use]
pub fn without_scale() -> f64 {
    let (n, r) = (1.5, normal_reflectance(1.5));
    r + (0.316_070_9 - r) * n * n
}

/// A light source inside glass: a black floor of radiance 1 is `(1−R)/n²` from outside. What of its light gets out is
/// `π(1−Rᵢ)` per area, which a ceiling of albedo ρ shows as `ρ(1−Rᵢ)`: photons and camera agree on what is sent out.
pub fn light_inside_glass<T: TestBackend>() {
    for (n, inside) in INSIDE {
        let mut builder = shaft(n, (0.0, 1.0), (0.5, 0.0));
        camera(&mut builder, 0.5, false);
        let truth = (1.0 - normal_reflectance(n)) / (n * n);
        check::<T>(&format!("seen, {n}"), builder, &crate::nesting::glow(), truth);
        let mut builder = shaft(n, (0.0, 1.0), (0.6, 0.0));
        camera(&mut builder, 0.5, true);
        // What comes back from the ceiling by reflection of the boundary, of all and of what it reflects.
        let outside = 1.0 - n * n * (1.0 - inside);
        let truth = 0.6 * (1.0 - inside) / (1.0 - 0.6 * outside);
        check::<T>(&format!("sent out, {n}"), builder, &settings(), truth);
    }
}

/// Equilibrium: where walls outside shine with e and those inside with n²e, radiance over n² is `e/(1−ρ)` everywhere, by
/// maps and by gather rays that enter glass and leave it. Balls have no edges, at which estimates lose area; triangles are
/// up to 2e-3 off.
pub fn furnace_with_glass<T: TestBackend>() {
    let (n, albedo, e) = (1.5_f64, 0.5, 1.0);
    let even = e / (1.0 - albedo);
    for (name, indirect) in [("map", Indirect::Map), ("gather", Indirect::Gather)] {
        for (what, x, forward, truth) in [
            ("the wall", -0.8, -1.0, even),
            ("through the glass", -0.8, 1.0, even),
            ("from within the glass", -0.5, 1.0, n * n * even),
            ("out of the glass", -0.5, -1.0, n * n * even),
        ] {
            let mut builder = SceneBuilder::new();
            let outer = builder.material(MaterialDesc::emissive("outer", [albedo; 3], [e; 3]));
            let inner = builder.material(MaterialDesc::emissive("inner", [albedo; 3], [n * n * e; 3]));
            let glass = builder.material(MaterialDesc::glass("glass", n));
            let ball = |radius| shapes::icosphere(5, [0.0; 3], radius);
            let (positions, triangles) = shapes::flip(ball(1.0));
            builder.mesh("outer", positions, triangles, outer);
            let (positions, triangles) = ball(0.6);
            builder.mesh("glass", positions, triangles, glass);
            let (positions, triangles) = ball(0.35);
            builder.mesh("inner", positions, triangles, inner);
            let projection = Projection::Orthographic { half_height: 0.05 };
            let (position, direction) = ([x, 0.0, 0.0], [forward, 0.0, 0.0]);
            builder.camera("axis", CameraDesc::new(position, direction, [0.0, 1.0, 0.0], projection));
            let estimator = Estimator::Radius { radius: Some(0.1) };
            let s = Settings { indirect, gather_rays: 4, photons: 10_000, estimator, ..settings() };
            check_within::<T>(&format!("{name}: {what}"), builder, &s, truth, 2e-3 * truth);
        }
    }
}

/// Glass around the camera, and an even glow around that: n² of it, in every pixel. Only directions that total reflection
/// keeps in a block of flat sides see less, and there are none along its axes.
pub fn glow_from_inside<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let glow = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
    let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], 1.0));
    builder.mesh("shell", positions, triangles, glow);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    let (positions, triangles) = shapes::cuboid([-0.4; 3], [0.45; 3]);
    builder.mesh("block", positions, triangles, glass);
    camera(&mut builder, 0.1, false);
    let film = film::<T>(&builder.build().unwrap(), &crate::nesting::glow(), 4, 8);
    for pixel in film.beauty() {
        let seen = f64::from(pixel[0]);
        assert!((seen / 2.25 - 1.0).abs() < 1e-5, "{seen}");
    }
}

fn absorber(sigma: f64) -> MaterialDesc {
    MaterialDesc::new("ink", Surface::Dielectric { ior: 1.0, absorption: [sigma; 3], tint: [1.0; 3], roughness: 0.0 })
}

/// Light straight down through an absorber of no refraction: a floor at depth d is `ρE·e^(−σd)/π` bright there, and a
/// camera above it sees `e^(−σh)` of that after h of the absorber.
pub fn light_through_an_absorber<T: TestBackend>() {
    let (sigma, depth, albedo) = (1.7_f64, 0.8, 0.6);
    for height in [0.3, 1.5] {
        let mut builder = SceneBuilder::new();
        let floor = builder.material(MaterialDesc::lambert("floor", [albedo; 3]));
        builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], floor);
        let ink = builder.material(absorber(sigma));
        let (positions, triangles) = shapes::cuboid([-2.1, -0.2, -2.1], [2.1, depth, 2.1]);
        builder.mesh("ink", positions, triangles, ink);
        builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
        camera(&mut builder, height, false);
        let truth = albedo / PI * (-sigma * (depth + depth.min(height))).exp();
        check::<T>(&format!("camera at {height}"), builder, &settings(), truth);
    }
}

/// A diffuse sphere full of an absorber, and a light at its centre: irradiance is `E₀ = I·e^(−σ)` straight from the light,
/// and `E₀/(1−ρK)` in all, with `K = 2(1−(1+a)e^(−a))/a²`, a = 2σ, as a chord at angle θ is 2cos θ long. Shadow rays,
/// photons and gather rays all start inside. Triangles are up to 1e-3 off the sphere.
pub fn light_in_an_absorber<T: TestBackend>() {
    let (sigma, albedo) = (0.7_f64, 0.8);
    let a = 2.0 * sigma;
    let again = albedo * 2.0 * (1.0 - (1.0 + a) * (-a).exp()) / (a * a);
    let direct = (-sigma).exp();
    let mut truth_by = Vec::new();
    for (name, s, truth) in [
        ("shadow rays", Settings { indirect: Indirect::None, ..settings() }, direct),
        ("photons", Settings { direct: Direct::Photons, indirect: Indirect::None, ..settings() }, direct),
        ("map", Settings { direct: Direct::None, ..settings() }, direct * again / (1.0 - again)),
        (
            "gather",
            Settings { direct: Direct::None, indirect: Indirect::Gather, gather_rays: 4, ..settings() },
            direct * again / (1.0 - again),
        ),
    ] {
        let mut builder = SceneBuilder::new();
        let wall = builder.material(MaterialDesc::lambert("wall", [albedo; 3]));
        let (positions, triangles) = shapes::flip(shapes::icosphere(5, [0.0; 3], 1.0));
        builder.mesh("wall", positions, triangles, wall);
        let ink = builder.material(absorber(sigma));
        let (positions, triangles) = shapes::icosphere(3, [0.0; 3], 1.3);
        builder.mesh("ink", positions, triangles, ink);
        builder.light("light", LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] });
        let away = 0.3;
        look_at_point(&mut builder, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], away, 0.1);
        let seen = truth * albedo / PI * (-sigma * away).exp();
        // The kernel tilts and the way to the camera is up to 5e-3 shorter off the middle.
        check_within::<T>(name, builder, &s, seen, 6e-3 * seen);
        truth_by.push(seen);
    }
    assert!(truth_by[2] > 0.1 * truth_by[0], "what is gathered is worth looking at");
}

#[cfg(test)]
mod tests {
    /// A radiance without the factor is far outside of what the tests above allow.
    #[test]
    fn the_missing_factor_would_be_seen() {
        assert!((super::without_scale() - 0.661_16).abs() < 1e-4);
    }
}
