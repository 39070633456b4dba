//! The sky against the formula of its authors' coefficients, measured illuminances, and geometry.

use std::f64::consts::{FRAC_PI_2, PI};

use hw_skymodel::rgb::{Channel, SkyParams, SkyState};
use photon_core::EnvironmentMap;
use photon_core::glam::{DQuat, DVec3};

use super::*;

fn baked(elevation: f64, turbidity: f64, rotate_degrees: f64) -> (EnvironmentMap, DVec3, [f64; 3]) {
    let Environment { map, sun } =
        EnvironmentDesc::sky(elevation, turbidity).rotated(rotate_degrees).bake().expect("a sky");
    let Sun { direction, irradiance, .. } = sun.expect("a sun");
    (map, -DVec3::from(direction), irradiance)
}

/// Integral of `radiance` times cosine over the directions within 90° of ±y, by the midpoint rule in θ and φ.
fn irradiance(sign: f64, radiance: impl Fn(DVec3) -> [f64; 3]) -> [f64; 3] {
    let (rows, columns) = (300, 500);
    let mut sum = [0.0; 3];
    for row in 0..rows {
        let theta = FRAC_PI_2 * (f64::from(row) + 0.5) / f64::from(rows);
        for column in 0..columns {
            let phi = 2.0 * PI * f64::from(column) / f64::from(columns);
            let direction = DVec3::new(phi.sin() * theta.sin(), sign * theta.cos(), -phi.cos() * theta.sin());
            let found = radiance(direction);
            sum = std::array::from_fn(|c| sum[c] + found[c] * theta.cos() * theta.sin());
        }
    }
    sum.map(|c| c * FRAC_PI_2 / f64::from(rows) * 2.0 * PI / f64::from(columns))
}

fn of_map(map: &EnvironmentMap) -> impl Fn(DVec3) -> [f64; 3] {
    |direction| map.radiance(direction.as_vec3()).to_array().map(f64::from)
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn close(found: [f64; 3], truth: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|c| (found[c] / truth[c] - 1.0).abs() < tolerance)
}

/// The irradiance of the horizontal plane from the map is that of the model, computed by the crate's own function.
#[test]
fn the_map_has_the_irradiance_of_the_model() {
    for (elevation, turbidity) in [(30.0, 3.0), (75.0, 1.0), (2.0, 2.5), (45.0, 10.0)] {
        let (map, towards, _) = baked(elevation, turbidity, 77.0);
        let params = SkyParams {
            elevation: f64::to_radians(elevation) as f32,
            turbidity: turbidity as f32,
            albedo: [sky::GROUND as f32; 3],
        };
        let state = SkyState::new(&params).unwrap();
        let model = |direction: DVec3| {
            let gamma = direction.dot(towards).clamp(-1.0, 1.0).acos() as f32;
            let theta = direction.y.acos() as f32;
            let at = |channel| f64::from(state.radiance(theta, gamma, channel).max(0.0));
            [at(Channel::R), at(Channel::G), at(Channel::B)]
        };
        let (found, truth) = (irradiance(1.0, of_map(&map)), irradiance(1.0, model));
        assert!(close(found, truth, 2e-3), "{elevation} {turbidity}: {found:?} {truth:?}");
        // Another elevation is another sky.
        let other = irradiance(1.0, of_map(&baked(elevation + 5.0, turbidity, 77.0).0));
        assert!(!close(other, truth, 2e-3), "{elevation} {turbidity}: {other:?} {truth:?}");
    }
}

/// Illuminances in lux of a clear day: about 10,000 to 20,000 from the sky, 60,000 to 110,000 facing the sun, 127,000 to
/// 135,000 outside of the atmosphere.
#[test]
fn absolute_units() {
    let (map, _, sun) = baked(50.0, 3.0, 0.0);
    let sky = 683.0 * luminance(irradiance(1.0, of_map(&map)));
    let sun = 683.0 * luminance(sun);
    assert!((8e3..2.2e4).contains(&sky), "{sky}");
    assert!((6e4..1.1e5).contains(&sun), "{sun}");
    // The lower the sun and the hazier the air, the redder and dimmer the sun.
    let [low, high] = [2.0, 60.0].map(|elevation| sun::irradiance(f64::to_radians(elevation), 3.0));
    assert!(luminance(low) < 0.2 * luminance(high) && low[0] / low[2] > 2.0 * high[0] / high[2], "{low:?} {high:?}");
    let hazy = sun::irradiance(f64::to_radians(60.0), 8.0);
    assert!(luminance(hazy) < 0.8 * luminance(high), "{hazy:?} {high:?}");
}

/// The sun stands above −z and turns with the map, counter-clockwise as seen from +y: at its height, the sky is brightest
/// there.
#[test]
fn the_sun_turns_with_the_sky() {
    for (rotation, x, z) in
        [(0.0, 0.0, -1.0), (90.0, -1.0, 0.0), (180.0, 0.0, 1.0), (-90.0, 1.0, 0.0), (450.0, -1.0, 0.0)]
    {
        let (map, towards, _) = baked(30.0, 2.0, rotation);
        let beside = 0.75_f64.sqrt();
        assert!(towards.distance(DVec3::new(x * beside, 0.5, z * beside)) < 1e-6, "{rotation}: {towards}");
        let green = |turn: f64| map.radiance((DQuat::from_rotation_y(turn) * towards).as_vec3()).y;
        for turn in [0.05, 0.5, 1.5, 3.0] {
            assert!(green(turn) < green(0.0) && green(-turn) < green(0.0), "{rotation}: {turn}");
            assert!((green(turn) / green(-turn) - 1.0).abs() < 1e-3, "{rotation}: {turn}");
        }
    }
}

/// The ground has a fifth of its irradiance from sky and sun, and is the same everywhere.
#[test]
fn the_ground_is_lit() {
    let (map, _, sun) = baked(40.0, 4.0, 0.0);
    let above = irradiance(1.0, of_map(&map));
    let below = irradiance(-1.0, of_map(&map));
    let truth = std::array::from_fn(|c| 0.2 * (above[c] + sun[c] * f64::to_radians(40.0).sin()));
    assert!(close(below, truth, 2e-3), "{below:?} {truth:?}");
}

#[test]
fn every_sky_in_range_is_finite_and_others_are_refused() {
    for elevation in [0.0, 1e-300, 0.01, 45.0, 90.0] {
        for turbidity in [1.0, 1.7, 9.99, 10.0] {
            let Environment { map, .. } = EnvironmentDesc::sky(elevation, turbidity).bake().unwrap();
            let mean = map.mean_radiance();
            assert!(mean.iter().all(|c| c.is_finite() && *c > 0.0), "{elevation} {turbidity}: {mean:?}");
        }
    }
    let message = |desc: EnvironmentDesc| desc.bake().unwrap_err().to_string();
    for (desc, part) in [
        (EnvironmentDesc::sky(-1.0, 3.0), "elevation of its sun is -1"),
        (EnvironmentDesc::sky(90.1, 3.0), "between 0, at the horizon, and 90"),
        (EnvironmentDesc::sky(f64::NAN, 3.0), "elevation of its sun is NaN"),
        (EnvironmentDesc::sky(30.0, 0.9), "turbidity is 0.9"),
        (EnvironmentDesc::sky(30.0, 10.5), "between 1 and 10"),
        (EnvironmentDesc::sky(30.0, f64::NAN), "turbidity is NaN"),
        (EnvironmentDesc::sky(30.0, 3.0).scaled(-1.0), "its scale is -1"),
        (EnvironmentDesc::sky(30.0, 3.0).scaled(f64::NAN), "its scale is NaN"),
        (EnvironmentDesc::sky(30.0, 3.0).scaled(1e300), "exceeds 32 bits"),
        (EnvironmentDesc::constant([1.0; 3]).rotated(f64::INFINITY), "its rotation is inf"),
        (EnvironmentDesc::constant([1.0, -1.0, 1.0]), "'constant:1,-1,1': its radiance"),
        (EnvironmentDesc::constant([1.0, f64::NAN, 1.0]), "must be at least 0"),
        (EnvironmentDesc::constant([1e39; 3]), "finite in 32 bits"),
        (EnvironmentDesc::image("square", 4, vec![[1.0; 3]; 16]), "'square': it has 4 × 4 texels"),
        (EnvironmentDesc::image("none", 0, Vec::new()), "twice as wide"),
        (EnvironmentDesc::image("nan", 2, vec![[1.0; 3], [1.0, f32::NAN, 1.0]]), "'nan': column 1, row 0"),
    ] {
        assert!(message(desc.clone()).contains(part), "{part}: {}", message(desc));
    }
}

#[test]
fn scale_applies_to_the_sky_and_to_its_sun() {
    let of = |scale| EnvironmentDesc::sky(30.0, 3.0).scaled(scale).bake().unwrap();
    let (one, two) = (of(1.0), of(2.0));
    assert!(two.map.texels().iter().zip(one.map.texels()).all(|(two, one)| *two == one.map(|c| 2.0 * c)));
    let [a, b] = [one.sun, two.sun].map(|sun| sun.expect("a sun").irradiance);
    assert_eq!(a.map(|c| 2.0 * c), b);
    assert_eq!(of(0.0).sun, None);
}

/// G10: the irradiance of a plane with normal n is π (1 + ⅔ · 0.9 d·n), and the mean radiance is 1.
#[test]
fn the_gradient_shows_every_side() {
    let map = EnvironmentDesc::gradient().bake().expect("a map").map;
    let towards = DVec3::new(-2.0, 4.0, 3.0).normalize_or_zero();
    for sign in [1.0, -1.0] {
        assert!(close(irradiance(sign, of_map(&map)), [PI * (1.0 + 0.6 * sign * towards.y); 3], 2e-3));
        assert!(close(of_map(&map)(sign * towards), [1.0 + 0.9 * sign; 3], 2e-2));
    }
    assert!(close(map.mean_radiance(), [1.0; 3], 1e-3));
}
