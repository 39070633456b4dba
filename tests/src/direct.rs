//! B: direct lighting.

use photon_core::{Direct, Film, Indirect, Layer, MapKind, Settings, random, sampling};
use photon_scene::{LightDesc, MaterialDesc, SceneBuilder, shapes};
use std::f64::consts::PI;

use crate::harness::{TestBackend, film, look_at_point, trace, watts};
use crate::stats::assert_agrees;

const ALBEDO: f64 = 0.5;

/// A floor of 8 by 8 at height 0, to which lights are added.
pub(crate) fn floor() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [ALBEDO; 3]));
    let (positions, triangles) = shapes::quad([[-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]]);
    builder.mesh("floor", positions, triangles, grey);
    builder
}

/// Irradiance at a point of the floor by shadow rays, and its standard error: `√Σs²/n` over pixels, which use
/// independent random numbers.
pub(crate) fn irradiance<T: TestBackend>(builder: SceneBuilder, x: f64, shadow_rays: u32) -> (f64, f64) {
    let film = point::<T>(builder, x, shadow_rays, 16, 8);
    let pixels = film.layer(Layer::Direct);
    let n = pixels.len() as f64;
    let factor = PI / ALBEDO;
    let mean = pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / n;
    let error = film.standard_error().iter().map(|&e| f64::from(e).powi(2)).sum::<f64>().sqrt() / n;
    (mean * factor, error * factor)
}

/// A film all of whose pixels see the same point of the floor.
fn point<T: TestBackend>(mut builder: SceneBuilder, x: f64, shadow_rays: u32, passes: u32, size: u32) -> Film {
    look_at_point(&mut builder, [x, 0.0, 0.0], [0.0, 1.0, 0.0], 1e-3, 1e-6);
    let scene = builder.build().unwrap();
    let settings =
        Settings { indirect: Indirect::None, caustics: false, shadow_rays, photons: 1, ..Settings::default() };
    film::<T>(&scene, &settings, passes, size)
}

fn with_area_light(name: &str, (positions, triangles): shapes::Shape, radiance: f64) -> SceneBuilder {
    let mut builder = floor();
    let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [radiance; 3]));
    builder.mesh(name, positions, triangles, area_light);
    builder
}

/// B1: `E = Φ cos θ/(4π d²)`; the only randomness left is the pixel's position, within 1e-6.
pub fn b1_point_light<T: TestBackend>() {
    for (position, truth) in [([0.0, 2.0, 0.0], 1.989_436_8), ([3.0_f64.sqrt(), 1.0, 0.0], 0.994_718_4)] {
        let mut builder = floor();
        builder.light("light", LightDesc::Point { position, intensity: [100.0 / (4.0 * PI); 3] });
        let (found, _) = irradiance::<T>(builder, 0.0, 1);
        assert_agrees("point light", found, truth, 0.0, 2e-5 * truth);
    }
}

/// B2: the number of photons that pass through a disc is binomial: standard error of the fraction `√(p(1−p)/N)`.
pub fn b2_flux_through_a_disc<T: TestBackend>() {
    let mut builder = floor();
    builder.light("light", LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [100.0 / (4.0 * PI); 3] });
    let scene = builder.build().unwrap();
    let n = 400_000;
    let settings = Settings { max_bounces: 1, ..Settings::default() };
    let (photons, tally) = trace::<T>(2, &scene, &settings, &[n]);
    let inside = photons[MapKind::Direct].iter().filter(|photon| {
        let [x, _, z] = scene.units().point_to_user(photon.position);
        x * x + z * z <= 1.0
    });
    let p = 0.146_446_61;
    let found = inside.count() as f64 / f64::from(n);
    assert_agrees("disc", found, p, (p * (1.0 - p) / f64::from(n)).sqrt(), 0.0);
    assert_eq!(tally.emitted, u64::from(n));
    assert!((scene.units().power - 100.0).abs() < 1e-4);
}

/// B3: a Lambertian disc. Its 512 segments lack a fraction `1 − sin(2π/n)/(2π/n)` = 2.5e-5 of the area.
pub fn b3_lambertian_disc<T: TestBackend>() {
    for (x, truth) in [(0.0, std::f64::consts::FRAC_PI_2), (1.0, 0.868_314_9), (2.0, 0.165_833_4)] {
        let area_light = shapes::disc([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 1.0, 512);
        let closed = PI / 2.0 * (1.0 - (x * x + 1.0 - 1.0) / ((x * x + 2.0_f64).powi(2) - 4.0 * x * x).sqrt());
        let (found, error) = irradiance::<T>(with_area_light("disc", area_light, 1.0), x, 64);
        assert_agrees("disc", found, closed, error, 1e-4 * closed);
        if x < 2.0 {
            assert!((closed - truth).abs() < 1e-6, "{closed}");
        }
    }
}

/// B4: a rectangle, `E = π L F`.
pub fn b4_rectangle<T: TestBackend>() {
    for (low, high, factor) in [
        ([0.0, 0.0], [1.0, 1.0], 0.138_531_6),
        ([-1.0, -1.0], [1.0, 1.0], 0.554_126_4),
        ([-0.5, -0.5], [0.5, 0.5], 0.239_456_5),
    ] {
        let at = |x: f64, z: f64| [x, 1.0, z];
        let area_light =
            shapes::quad([at(low[0], low[1]), at(high[0], low[1]), at(high[0], high[1]), at(low[0], high[1])]);
        let (found, error) = irradiance::<T>(with_area_light("light", area_light, 1.0), 0.0, 64);
        assert_agrees("rectangle", found, PI * factor, error, 1e-5);
    }
}

/// B5: form factors, as the fraction of a Lambertian emitter's photons that a black receiver absorbs.
pub fn b5_form_factors<T: TestBackend>() {
    let h = 0.5;
    let square = |y: f64, up: bool| {
        let corners = [[-h, y, h], [h, y, h], [h, y, -h], [-h, y, -h]];
        let shape = shapes::quad(corners);
        if up { shape } else { shapes::flip(shape) }
    };
    let wall = shapes::quad([[-h, 0.0, -h], [h, 0.0, -h], [h, 1.0, -h], [-h, 1.0, -h]]);
    let disc = |y, up: f64| shapes::disc([0.0, y, 0.0], [0.0, up, 0.0], 1.0, 512);
    for (emitter, receiver, factor) in [
        (square(0.0, true), square(1.0, false), 0.199_824_9),
        (square(0.0, true), wall, 0.200_043_8),
        (disc(0.0, 1.0), disc(1.0, -1.0), 0.381_966_0),
    ] {
        let mut builder = SceneBuilder::new();
        let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [1.0; 3]));
        let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
        builder.mesh("emitter", emitter.0, emitter.1, area_light);
        builder.mesh("receiver", receiver.0, receiver.1, black);
        let scene = builder.build().unwrap();
        let n = 400_000;
        let (_, tally) = trace::<T>(2, &scene, &Settings::default(), &[n]);
        let found = tally.absorbed as f64 / f64::from(n);
        assert_agrees("form factor", found, factor, (factor * (1.0 - factor) / f64::from(n)).sqrt(), 5e-5);
    }
}

/// An emissive wall on the floor at x = 0, `2·half` long and `high`, that emits towards larger x, or to both sides.
fn wall_of_light(half: f64, high: f64, both: bool) -> SceneBuilder {
    let mut builder = floor();
    let area_light = MaterialDesc::emissive("light", [0.0; 3], [1.0; 3]);
    let area_light = builder.material(area_light.with_both_sides(both));
    builder.quad("wall", [[0.0, 0.0, half], [0.0, 0.0, -half], [0.0, high, -half], [0.0, high, half]], area_light);
    builder
}

/// B9: nearby area lights. An emissive wall, seen from distance `x` in front of its middle: twice the configuration
/// factor of an element and a rectangle perpendicular to its plane, opposite a corner: `E = atan(b/x) − x/√(a² +
/// x²) atan(b/√(a² + x²))` for height a and half length b. Tolerance 3·10⁻⁵ of π/2, due to the offsets from both
/// surfaces, 8·10⁻⁶ m each where E falls by 2 per metre. An emissive ceiling: four times the value of B4.
pub fn b9_area_lights_near_by<T: TestBackend>() {
    for (x, half, high, both) in [
        (0.5, 1.0, 1.0, false),
        (1e-2, 1.0, 1.0, false),
        (1e-2, 1.0, 1.0, true),
        (-1e-2, 1.0, 1.0, true),
        (1e-4, 1.0, 1.0, false),
        (0.02, 3.0, 0.02, false),
    ] {
        let (away, slant) = (f64::abs(x), f64::hypot(x, high));
        let truth = (half / away).atan() - away / slant * (half / slant).atan();
        let (found, error) = irradiance::<T>(wall_of_light(half, high, both), x, 64);
        assert_agrees("wall of light", found, truth, error, 5e-5);
        // Values between 0 and b have a standard deviation of at most b/2, with b as in B10; there are 65 536 of
        // them.
        assert!(error * 256.0 <= 1.8, "{x}: {error}");
    }
    for high in [0.3, 3e-3] {
        let quad = shapes::quad([[-1.0, high, -1.0], [1.0, high, -1.0], [1.0, high, 1.0], [-1.0, high, 1.0]]);
        let root = 1.0_f64.hypot(high);
        let truth = 4.0 / root * (1.0 / root).atan();
        let (found, error) = irradiance::<T>(with_area_light("ceiling", quad, 1.0), 0.0, 64);
        assert_agrees("ceiling of light", found, truth, error, 5e-5);
    }
}

/// B10: no shadow ray contributes more than radiance times the total solid angle of the emitters, divided by the
/// 0.9 of the selection probability that depends on the lights' contributions. With uniform directions that follows from
/// the sampling; in proportion to the cosine it is observed in this view. Points sampled uniformly in area would exceed it.
pub fn b10_no_shadow_ray_outshines_its_area_light<T: TestBackend>() {
    let x = 1e-2;
    // An emissive wall that meets the floor fills at most half of the hemisphere.
    let most = PI / 0.9 * 1.001;
    let film = point::<T>(wall_of_light(1.0, 1.0, false), x, 1, 1, 64);
    let largest = film.layer(Layer::Direct).iter().map(|p| f64::from(p[0]) * PI / ALBEDO).fold(0.0, f64::max);
    assert!(largest > 0.5 * PI && largest <= most, "{largest}");
    let by_area = (0..4096_u32).map(|i| {
        let [u, v, half, _] = random::philox4x32([i, 0, 0, 0], [9, 0]).map(random::unit_f32);
        // Triangles of the wall: their corners are one on the floor, one above it, and one at the other end.
        let (b, c) = sampling::triangle(u, v);
        let (b, c) = (f64::from(b), f64::from(c));
        let (y, z) = if half < 0.5 { (c, 2.0 * b + 2.0 * c - 1.0) } else { (b + c, 2.0 * b - 1.0) };
        let squared = x * x + y * y + z * z;
        2.0 * y * x / (squared * squared)
    });
    let largest = by_area.fold(0.0, f64::max);
    assert!(largest > 2.0 * most, "{largest}");
}

/// B11: each of as many lights as shadow rays gets one of them, whatever their weights: a point light that is occluded, and
/// would be 10 000 times as bright as the second, hides neither that one, whose estimate has no noise, nor a rectangle (B4),
/// whose standard deviation is that of one ray to it: below a quarter of its irradiance. One ray for all lights rarely finds
/// them. A third light below the floor changes nothing of this.
pub fn b11_each_light_has_a_shadow_ray<T: TestBackend>() {
    let lit = |with_rectangle: bool| {
        let corners = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
        let mut builder =
            if with_rectangle { with_area_light("rectangle", shapes::quad(corners), 1.0) } else { floor() };
        let intensity = [100.0 / (4.0 * PI); 3];
        let position = [3.0_f64.sqrt(), 1.0, 0.0];
        builder.light("second", LightDesc::Point { position, intensity });
        builder
            .light("occluded", LightDesc::Point { position: [0.0, 0.2, 0.0], intensity: intensity.map(|i| 50.0 * i) });
        builder.light("below", LightDesc::Point { position: [0.5, -1.0, 0.0], intensity });
        let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
        // It hides 10⁻⁶ steradians of the rectangle.
        let (high, half) = (0.19, 1e-4);
        builder.quad(
            "plate",
            [[-half, high, half], [half, high, half], [half, high, -half], [-half, high, -half]],
            black,
        );
        builder
    };
    let point = 0.994_718_4;
    let (found, error) = irradiance::<T>(lit(false), 0.0, 2);
    // 16 passes of 8 by 8 pixels. The light below has a thousandth of a third of the probability p, and the relative standard
    // deviation of an estimate is √p.
    let samples = 1024.0_f64;
    let rare = point * (1e-3 / 3.0 / samples).sqrt();
    assert_agrees("second light", found, point, rare, 2e-5 * point);
    assert!(error <= 2.0 * rare, "{error}");
    let rectangle = PI * 0.554_126_4;
    for rays in [3, 4, 7] {
        let (found, error) = irradiance::<T>(lit(true), 0.0, rays);
        assert_agrees("second light and rectangle", found, point + rectangle, error, 1e-5);
        assert!(error * samples.sqrt() < 0.25 * rectangle, "{rays} rays: {error}");
    }
    let (_, error) = irradiance::<T>(lit(true), 0.0, 1);
    assert!(error * samples.sqrt() > point + rectangle, "{error}");
}

/// B8: the power of emissive surfaces.
pub fn b8_power_of_emitters<T: TestBackend>() {
    let area = with_area_light(
        "light",
        shapes::quad([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]),
        1.0,
    );
    let mut spot = floor();
    let angle = 30.0_f64.to_radians();
    spot.light(
        "spot",
        LightDesc::Spot {
            position: [0.0, 1.0, 0.0],
            direction: [0.0, -1.0, 0.0],
            intensity: [1.0; 3],
            inner_angle: angle,
            outer_angle: angle,
        },
    );
    for (builder, power) in [(area, PI), (spot, 0.841_787_2)] {
        let scene = builder.build().unwrap();
        assert!((scene.units().power / power - 1.0).abs() < 1e-6, "{}", scene.units().power);
        let (_, tally) = trace::<T>(2, &scene, &Settings::default(), &[20_000]);
        // Flux is accumulated in units of 2^-40 of the power.
        assert!((watts(&scene, &tally, &tally.flux_emitted) / power - 1.0).abs() < 1e-5);
    }
}

/// Photons and shadow rays estimate the same quantity: their direct layers agree.
pub fn direct_light_by_photons_agrees<T: TestBackend>() {
    let mut builder = with_area_light(
        "light",
        shapes::quad([[-1.0, 2.0, -1.0], [1.0, 2.0, -1.0], [1.0, 2.0, 1.0], [-1.0, 2.0, 1.0]]),
        1.0,
    );
    look_at_point(&mut builder, [0.5, 0.0, 0.2], [0.0, 1.0, 0.0], 0.5, 0.2);
    let scene = builder.build().unwrap();
    let base = Settings { indirect: Indirect::None, caustics: false, photons: 100_000, ..Settings::default() };
    let nee = crate::harness::per_pass::<T>(&scene, &base, 8, 8);
    let photons = crate::harness::per_pass::<T>(
        &scene,
        &Settings { direct: Direct::Photons, seed: 9, alpha: 1.0, ..base },
        24,
        8,
    );
    let error = (crate::stats::standard_error(&nee).powi(2) + crate::stats::standard_error(&photons).powi(2)).sqrt();
    let (a, b) = (crate::stats::moments(&nee).0, crate::stats::moments(&photons).0);
    // Curvature of the field within the derived radius: here below 2 parts per thousand.
    assert_agrees("photons", b, a, error, 2e-3 * a);
}
