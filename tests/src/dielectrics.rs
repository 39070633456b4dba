//! T: dielectrics.

use photon_core::fresnel::fresnel;
use photon_core::{Direct, Estimator, Indirect, MapKind, NEGLIGIBLE_THROUGHPUT, Settings};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Surface, shapes};
use std::f64::consts::PI;

use crate::harness::{TestBackend, film, trace};
use crate::stats::assert_agrees;

fn glass(ior: f64, absorption: f64) -> MaterialDesc {
    MaterialDesc::new("glass", Surface::Dielectric { ior, absorption: [absorption; 3], tint: [1.0; 3], roughness: 0.0 })
}

/// A point light at `light` in a glass ball of radius 1, and nothing else of relevance.
fn lit_ball(desc: MaterialDesc, light: [f64; 3], subdivision: u32) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(desc);
    let (positions, triangles) = shapes::icosphere(subdivision, [0.0; 3], 1.0);
    builder.mesh("ball", positions, triangles, material);
    builder.light("light", LightDesc::Point { position: light, intensity: [1.0 / (4.0 * PI); 3] });
    builder
}

/// T1, T2, T3: Fresnel's equations; the diffuse averages by the midpoint rule.
pub fn t1_t2_t3_fresnel<T: TestBackend>() {
    for (n, r0, outside, inside) in [
        (1.33, 0.020_059_3, 0.065_930_8, 0.471_949_1),
        (1.5, 0.04, 0.091_778_0, 0.596_345_8),
        (2.4, 0.169_550_2, 0.210_181_3, 0.862_878_7),
    ] {
        assert_agrees("normal", f64::from(fresnel(1.0, n).reflectance), r0, 0.0, 1e-6);
        for (eta, truth) in [(n, outside), (1.0 / n, inside)] {
            let steps = 100_000;
            let sum: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
                .map(|c| 2.0 * c * f64::from(fresnel(c as f32, eta).reflectance))
                .sum();
            assert_agrees("diffuse", sum / f64::from(steps), truth, 0.0, 2e-5);
        }
    }
    let at = |degrees: f64| fresnel(degrees.to_radians().cos() as f32, 1.5);
    assert_agrees("45°", f64::from(at(45.0).reflectance), 0.050_239_9, 0.0, 1e-6);
    assert_agrees("refracted", f64::from(at(45.0).cos_transmitted).acos().to_degrees(), 28.125_506, 0.0, 1e-3);
}

/// T4: a slab at normal incidence, all orders of reflection: `R = 2r/(1+r)` without absorption, and with σd = 1.
/// The number of escaping photons is binomial.
pub fn t4_slab<T: TestBackend>() {
    let n = 400_000;
    for (sigma, reflected, through) in [(0.0, 0.076_923_1, 0.923_076_9), (1.0, 0.044_990_1, 0.339_111_1)] {
        let escaped = |with_receiver: bool| {
            let mut builder = SceneBuilder::new();
            let material = builder.material(glass(1.5, sigma));
            let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
            let (positions, triangles) = shapes::cuboid([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
            builder.mesh("slab", positions, triangles, material);
            let y = -0.2;
            if with_receiver {
                builder.quad("receiver", [[-1.0, y, 1.0], [1.0, y, 1.0], [1.0, y, -1.0], [-1.0, y, -1.0]], black);
            } else {
                // Keeps the scene's bounding box unchanged.
                builder.quad(
                    "mark",
                    [[-1.0, y, -1.0], [-0.999_999, y, -1.0], [-0.999_999, y, -0.999_999], [-1.0, y, -0.999_999]],
                    black,
                );
            }
            builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
            let scene = builder.build().unwrap();
            // The power is that of the sun over a disc, of which the slab intercepts its four square units.
            let share = 4.0 / scene.units().power;
            let (_, tally) = trace::<T>(2, &scene, &Settings::default(), &[n]);
            let flux = tally.flux_escaped.value()[0] / f64::from(n);
            (flux, share)
        };
        let (with, share) = escaped(true);
        let (without, _) = escaped(false);
        let error = (0.25 / f64::from(n)).sqrt() / share;
        assert_agrees("R", (with - (1.0 - share)) / share, reflected, error, 0.0);
        assert_agrees("T", (without - with) / share, through, error * 2.0_f64.sqrt(), 0.0);
    }
}

/// A light of radiance L behind a dark slab at normal incidence: `(1 − r)²·e^(−σd)·L`, though camera paths as dark as these end
/// by Russian roulette at its far side: of n paths a part p goes on, with a relative error of √((1 − p)/(pn)).
pub fn camera_paths_through_dark_glass<T: TestBackend>() {
    let (r, passes, size) = (0.04, 16, 64);
    for depth in [13.0_f64, 15.0, 17.0] {
        let mut builder = SceneBuilder::new();
        let (positions, triangles) = shapes::cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]);
        let material = builder.material(glass(1.5, depth));
        builder.mesh("slab", positions, triangles, material);
        let radiance = depth.exp();
        let lit = builder.material(MaterialDesc::emissive("light", [0.0; 3], [radiance; 3]));
        builder.quad("light", [[-1.0, -1.0, -2.0], [1.0, -1.0, -2.0], [1.0, 1.0, -2.0], [-1.0, 1.0, -2.0]], lit);
        let projection = Projection::Orthographic { half_height: 0.3 };
        builder.camera("front", CameraDesc::new([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], projection));
        let settings = Settings {
            photons: 100,
            direct: Direct::None,
            indirect: Indirect::None,
            caustics: false,
            ..Settings::default()
        };
        let film = film::<T>(&builder.build().unwrap(), &settings, passes, size);
        let beauty = film.beauty();
        let seen = beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64;
        let truth = (1.0 - r) * (1.0 - r);
        let part = ((1.0 - r) * (-depth).exp() / f64::from(NEGLIGIBLE_THROUGHPUT)).min(1.0);
        let paths = f64::from(passes * size * size);
        let error = truth * ((1.0 - part) / (part * paths)).sqrt();
        // Rays start beside surfaces, so that they miss some millionths of the slab.
        assert_agrees(&format!("depth {depth}"), seen, truth, error, 3e-6 * depth);
        assert!((part < 1.0) == beauty.iter().any(|pixel| pixel[0] < 0.1), "depth {depth}: paths end at {part}");
    }
}

/// T6: a light at the centre of a ball: all light escapes; with σR = 1, a fraction of `(1−r)e⁻¹/(1−r e⁻²)`. The
/// tessellation lies up to 1e-4 inside the sphere.
pub fn t6_light_at_the_centre<T: TestBackend>() {
    let n = 200_000;
    for (sigma, truth) in [(0.0, 1.0), (1.0, 0.355_086_5)] {
        let scene = lit_ball(glass(1.5, sigma), [0.0; 3], 6).build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 200, ..Settings::default() }, &[n]);
        let found = tally.flux_escaped.value()[0] / f64::from(n);
        let error = (truth * (1.0 - truth) / f64::from(n)).sqrt();
        assert_agrees("out", found, truth, error, 3e-4);
        assert!(tally.balances());
    }
}

/// T7 and S14: with the light off the centre, a fraction of √(1 − (R/(na))²) is trapped in a sphere forever, so
/// until the bounce limit. With a dozen bounces, the tessellation does not yet release that light; its effect is
/// bounded by halving the size of the triangles.
pub fn t7_trapped_light<T: TestBackend>() {
    let n = 200_000;
    let truth = 0.328_209;
    let found = [6, 7].map(|subdivision| {
        let scene = lit_ball(glass(1.5, 0.0), [0.9, 0.0, 0.0], subdivision).build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 12, ..Settings::default() }, &[n]);
        assert_eq!(tally.escaped + tally.truncated, u64::from(n));
        tally.escaped as f64 / f64::from(n)
    });
    let error = (truth * (1.0 - truth) / f64::from(n)).sqrt();
    assert_agrees("out", found[1], truth, error, (found[0] - found[1]).abs() + 2e-3);
}

/// T9: the focus of a ball lens: on the axis, a quarter radius behind the ball, the irradiance is 33.372 times the
/// incident one, with an aperture of R/20 formed by a black ring.
///
/// Measured as flux over the area of the spot, which for a uniform disc is `2π⟨ρ²⟩`: relative error `√(4/(3n))`.
/// The flat triangles scatter by less than a hundredth.
pub fn t9_ball_lens<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let material = builder.material(glass(1.5, 0.0));
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    let (positions, triangles) = shapes::uv_sphere(2048, 1024, [0.0; 3], 1.0);
    builder.mesh("ball", positions, triangles, material);
    let (positions, triangles) = shapes::tube([0.0, 1.1, 0.0], 0.05, 1.05, 0.01, 256);
    builder.mesh("aperture", positions, triangles, black);
    let (w, y) = (0.1, -1.25);
    builder.quad("screen", [[-w, y, w], [w, y, w], [w, y, -w], [-w, y, -w]], grey);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    let scene = builder.build().unwrap();
    let n = 3_000_000;
    let (photons, _) = trace::<T>(2, &scene, &Settings { max_bounces: 3, ..Settings::default() }, &[n]);
    let squares: Vec<f64> = photons[MapKind::Caustic]
        .iter()
        .map(|photon| {
            let [x, _, z] = scene.units().point_to_user(photon.position);
            x * x + z * z
        })
        .collect();
    let count = squares.len() as f64;
    let spot = 2.0 * PI * squares.iter().sum::<f64>() / count;
    let irradiance = count * scene.units().power / f64::from(n) / spot;
    assert!(count > 1000.0, "{count}");
    assert_agrees("focus", irradiance, 33.372, 33.372 * (4.0 / 3.0 / count).sqrt(), 0.33);
}

/// T13: an interface with relative index 1 is invisible: the image is identical to the bit.
pub fn t13_ior_one_is_invisible<T: TestBackend>() {
    let picture = |with_ball: bool| {
        let mut builder = photon_scene::builtin("cornell").unwrap();
        if with_ball {
            let nothing = builder.material(MaterialDesc::glass("nothing", 1.0));
            let (positions, triangles) = shapes::icosphere(3, [0.0, 1.0, 0.0], 0.3);
            builder.mesh("ball", positions, triangles, nothing);
        }
        let settings =
            Settings { photons: 5000, estimator: Estimator::Radius { radius: Some(0.1) }, ..Settings::default() };
        film::<T>(&builder.build().unwrap(), &settings, 2, 24)
    };
    assert_eq!(picture(false).pixels, picture(true).pixels);
}
