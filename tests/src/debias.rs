//! Corrections of an estimate's bias, compared with closed forms, with and without the correction.

use photon_core::{Area, Bandwidth, Direct, Estimator, Indirect, Kernel, Settings};
use photon_scene::shapes::{self, cuboid};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder, Sun};
use std::f64::consts::{FRAC_1_PI, PI};

use crate::harness::{TestBackend, film, look_at_point, per_pass};
use crate::stats::{SIGMAS, agrees, assert_agrees, moments, standard_error};

/// Radius of the estimates below, in user units.
const RADIUS: f64 = 0.25;

/// What lies beside the observed point, which is at the origin.
#[derive(Clone, Copy, Debug)]
enum Beside {
    /// The floor continues.
    Nothing,
    /// The floor ends at x.
    End(f64),
    /// The floor ends at x and at y.
    Corner(f64),
    /// A tall box stands on the floor, from x on.
    Box(f64),
    /// The floor is a mirror from x on.
    Mirror(f64),
    /// The floor is black from x on.
    Black(f64),
    /// The floor is black from x on for a tenth of the radius, then continues.
    Strip(f64),
    /// A sheet of glass lies slightly above the floor.
    Glass,
    /// A wall of zero thickness stands on the floor.
    Wall(f64),
    /// A step down by a tenth of the radius, still counted as the same surface.
    Step(f64),
}

/// A floor lit from straight above, with irradiance 1 and albedo 1/2: radiance 1/2π.
fn floor(beside: Beside) -> Scene {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let mut tile = |name: &str, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64, material| {
        builder.quad(name, [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]], material);
    };
    let all = [-1.0, 1.0];
    match beside {
        Beside::Nothing | Beside::Glass | Beside::Wall(_) | Beside::Box(_) => tile("floor", all, all, 0.0, grey),
        Beside::End(x) => tile("floor", [-1.0, x], all, 0.0, grey),
        Beside::Corner(x) => tile("floor", [-1.0, x], [-1.0, x], 0.0, grey),
        Beside::Mirror(x) | Beside::Black(x) => tile("floor", [-1.0, x], all, 0.0, grey),
        Beside::Step(x) => {
            tile("floor", [-1.0, x], all, 0.0, grey);
            tile("lower", [x, 1.0], all, -0.1 * RADIUS, grey);
        }
        Beside::Strip(x) => {
            tile("floor", [-1.0, x], all, 0.0, grey);
            tile("beyond", [x + 0.1 * RADIUS, 1.0], all, 0.0, grey);
        }
    }
    match beside {
        Beside::Box(x) => {
            let (positions, triangles) = cuboid([x, -0.8, 0.0], [0.9, 0.8, 0.7]);
            builder.mesh("box", positions, triangles, grey);
        }
        Beside::Wall(x) => {
            builder.quad("wall", [[x, -1.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 0.7], [x, -1.0, 0.7]], grey);
        }
        Beside::Mirror(x) | Beside::Black(x) => {
            let other = match beside {
                Beside::Mirror(_) => MaterialDesc::mirror("mirror", [1.0; 3]),
                _ => MaterialDesc::lambert("black", [0.0; 3]),
            };
            let other = builder.material(other);
            builder.quad("other", [[x, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [x, 1.0, 0.0]], other);
        }
        Beside::Strip(x) => {
            let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
            let y = x + 0.1 * RADIUS;
            builder.quad("strip", [[x, -1.0, 0.0], [y, -1.0, 0.0], [y, 1.0, 0.0], [x, 1.0, 0.0]], black);
        }
        Beside::Glass => {
            // An index of nearly 1: light passes almost unchanged, but through the refraction code.
            let glass = builder.material(MaterialDesc::thin("glass", 1.000_1));
            let z = 0.1 * RADIUS;
            builder.quad("glass", [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]], glass);
        }
        _ => {}
    }
    builder.light("sun", LightDesc::Directional { direction: [0.0, 0.0, -1.0], irradiance: [1.0; 3] });
    // The pixel lies entirely on the floor, even where that ends at the origin.
    look_at_point(&mut builder, [-2e-5, -2e-5, 0.0], [0.0, 0.0, 1.0], 2.0, 1e-5);
    builder.build().unwrap()
}

fn settings(area: Area, kernel: Kernel, estimator: Estimator) -> Settings {
    Settings {
        photons: 8_000,
        estimator,
        kernel,
        area,
        direct: Direct::Photons,
        indirect: Indirect::None,
        alpha: 1.0,
        seed: 17,
        ..Settings::default()
    }
}

fn within() -> Estimator {
    Estimator::Radius { radius: Some(RADIUS) }
}

/// Radiance divided by the true value, per pass.
fn shares<T: TestBackend>(beside: Beside, settings: &Settings) -> Vec<f64> {
    let truth = 0.5 / PI;
    per_pass::<T>(&floor(beside), settings, 8, 1).iter().map(|radiance| radiance / truth).collect()
}

/// D1: where the disc extends beyond an edge or under a box, the fraction of light given by A8 is lost. Dividing by
/// the area on the surface restores all of it, to within the 0.4 % of `area`. Passes are independent; the photons
/// are the same with and without the correction, so the ratio shows its share alone.
pub fn d1_light_at_edges_is_whole<T: TestBackend>() {
    let flat = Kernel::Constant;
    let round = Kernel::Epanechnikov;
    for (beside, kernel, lost) in [
        (Beside::End(0.0), round, 0.5),
        (Beside::End(0.25 * RADIUS), flat, 0.657_481),
        (Beside::Corner(0.0), round, 0.25),
        (Beside::Box(0.25 * RADIUS), round, 0.705_638),
        (Beside::Mirror(0.25 * RADIUS), round, 0.705_638),
        (Beside::Black(0.0), round, 0.5),
    ] {
        let mended = shares::<T>(beside, &settings(Area::Surface, kernel, within()));
        let plain = shares::<T>(beside, &settings(Area::Disc, kernel, within()));
        assert_agrees(&format!("{beside:?}"), moments(&mended).0, 1.0, standard_error(&mended), 4e-3);
        let ratios: Vec<f64> = plain.iter().zip(&mended).map(|(plain, mended)| plain / mended).collect();
        let error = standard_error(&ratios);
        assert_agrees(&format!("{beside:?}, share"), moments(&ratios).0, lost, error, 4e-3);
        assert!(!agrees(moments(&plain).0, 1.0, standard_error(&plain), 4e-3), "{beside:?}: bias is not significant");
    }
    // A strip that a spoke crosses completely is missed: some of the light that it takes remains lost, but none is added.
    let [mended, plain] = [Area::Surface, Area::Disc]
        .map(|area| shares::<T>(Beside::Strip(0.3 * RADIUS), &settings(area, round, within())));
    // Up to the order of summation.
    let gained: Vec<f64> = mended.iter().zip(&plain).map(|(mended, plain)| mended / plain - 1.0).collect();
    assert!(gained.iter().all(|&gain| gain > -1e-5) && moments(&gained).0 > 1e-3, "{gained:?}");
    assert!(moments(&mended).0 < 1.0 + SIGMAS * standard_error(&mended) + 4e-3, "{mended:?}");
    // With k nearest photons, the disc extends as far as there are photons.
    let knn = Estimator::Knn { k: 100, max_radius: None };
    let mended = shares::<T>(Beside::End(0.0), &settings(Area::Surface, round, knn));
    assert_agrees("nearest", moments(&mended).0, 1.0, standard_error(&mended), 4e-3);
}

/// D2: in the interior of a surface, under a glass ceiling, over a step that counts as the same surface and before
/// a wall that photons leak through, the correction changes no bit.
pub fn d2_nothing_changes_within_a_surface<T: TestBackend>() {
    for beside in [Beside::Nothing, Beside::Glass, Beside::Step(0.1), Beside::Wall(0.1)] {
        let scene = floor(beside);
        let of = |area| film::<T>(&scene, &settings(area, Kernel::Epanechnikov, within()), 2, 2);
        let (mended, plain) = (of(Area::Surface), of(Area::Disc));
        assert_eq!(mended, plain, "{beside:?}");
        assert!(plain.beauty().iter().flatten().all(|&c| c > 0.0), "{beside:?}");
    }
}

/// D3: precomputed irradiance, looked up at the nearest photon by gather rays, reproduces the furnace of C1: in a
/// sphere, and with area correction in a cube, where the disc loses light along all edges. There it is precomputed unless
/// errors are estimated; each ray then has probes. Passes are independent.
pub fn d3_irradiance_found_beforehand<T: TestBackend>() {
    let room = |shape: shapes::Shape, look: [f64; 3], normal: [f64; 3]| {
        let mut builder = SceneBuilder::new();
        let wall = builder.material(MaterialDesc::emissive("wall", [0.8; 3], [FRAC_1_PI; 3]));
        let (positions, triangles) = shapes::flip(shape);
        builder.mesh("room", positions, triangles, wall);
        look_at_point(&mut builder, look, normal, 0.2, 0.05);
        builder.build().unwrap()
    };
    let cube = room(cuboid([-1.0; 3], [1.0; 3]), [0.2, -1.0, 0.1], [0.0, 1.0, 0.0]);
    let ball = room(shapes::icosphere(4, [0.0; 3], 1.0), [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let with = |scene: &Scene, area, irradiance_every, radius, errors| {
        let settings = Settings {
            errors,
            photons: 4_000,
            max_bounces: 512,
            alpha: 1.0,
            estimator: Estimator::Radius { radius: Some(radius) },
            indirect: Indirect::Gather,
            gather_rays: 32,
            irradiance_every,
            area,
            seed: 3,
            ..Settings::default()
        };
        per_pass::<T>(scene, &settings, 8, 2).iter().map(|l| l * PI).collect::<Vec<f64>>()
    };
    let of = |scene: &Scene, area, irradiance_every, radius| with(scene, area, irradiance_every, radius, false);
    // 0.4 % of `area`, and the tessellation of the sphere, as in C1.
    let check = |what: &str, found: &[f64]| {
        assert_agrees(what, moments(found).0, 5.0, standard_error(found), 4e-3 * 5.0);
    };
    // The same photons: the ratio shows what is gained or lost without their noise.
    let over = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a / b - 1.0).collect() };
    // About 80 photons per disc. With the Epanechnikov kernel, 1 % would be gained.
    let (nearest, asked) = (of(&ball, Area::Disc, Some(8), 0.12), of(&ball, Area::Disc, None, 0.12));
    check("ball", &nearest);
    let gained = over(&nearest, &asked);
    assert_agrees("ball, over all photons", moments(&gained).0, 0.0, standard_error(&gained), 2e-3);
    // Two photons per disc, and every eighth has a point: with points alone, three quarters of the rays would find none.
    check("ball, sparse", &of(&ball, Area::Disc, Some(8), 0.02));
    let (whole, dark) = (of(&cube, Area::Surface, Some(4), 0.3), of(&cube, Area::Disc, Some(4), 0.3));
    check("cube", &whole);
    assert_eq!(of(&cube, Area::Surface, None, 0.3), whole);
    check("cube, probes of rays", &with(&cube, Area::Surface, None, 0.3, true));
    let lost = over(&dark, &whole);
    assert!(moments(&lost).0 < -0.02 - SIGMAS * standard_error(&lost), "{lost:?}: bias is not significant");
}

/// D9: a room in which the sun shines through a window onto floor and wall has the same indirect light by final gathering as by
/// the map, to 1 % after 16 passes. With discs, rays find less where the sun's patch ends at an edge. Photons are the same.
pub fn d9_final_gathering_in_a_sunny_room<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [0.7; 3]));
    let quad = |builder: &mut SceneBuilder, corners| builder.quad("wall", corners, wall);
    let [a, b] = [-1.0, 1.0];
    quad(&mut builder, [[a, a, b], [b, a, b], [b, a, a], [a, a, a]]);
    quad(&mut builder, [[a, b, a], [b, b, a], [b, b, b], [a, b, b]]);
    quad(&mut builder, [[a, a, a], [b, a, a], [b, b, a], [a, b, a]]);
    quad(&mut builder, [[a, a, b], [a, a, a], [a, b, a], [a, b, b]]);
    quad(&mut builder, [[b, a, a], [b, a, b], [b, b, b], [b, b, a]]);
    for [left, right, low, high] in [[a, b, a, -0.5], [a, b, 0.5, b], [a, -0.5, -0.5, 0.5], [0.5, b, -0.5, 0.5]] {
        quad(&mut builder, [[right, low, b], [left, low, b], [left, high, b], [right, high, b]]);
    }
    builder.sun(Sun::new([0.0, -0.7, -1.0], [10.0; 3]));
    // The sun does not shine onto this wall.
    look_at_point(&mut builder, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5, 0.8);
    let scene = builder.build().unwrap();
    let of = |indirect, area, errors| {
        let settings = Settings { photons: 100_000, indirect, area, errors, gather_rays: 32, ..Settings::default() };
        per_pass::<T>(&scene, &settings, 16, 16)
    };
    let over = |found: &[f64], other: &[f64]| {
        let ratio: Vec<f64> = found.iter().zip(other).map(|(found, other)| found / other).collect();
        (moments(&ratio).0, standard_error(&ratio))
    };
    let map = of(Indirect::Map, Area::Surface, false);
    let gathered = of(Indirect::Gather, Area::Surface, false);
    // Each ray has probes where errors are estimated.
    let probed = of(Indirect::Gather, Area::Surface, true);
    for found in [&gathered, &probed] {
        let (mean, error) = over(found, &map);
        assert_agrees("sunny room", mean, 1.0, error, 0.01);
    }
    // The same rays and photons.
    let (mean, error) = over(&of(Indirect::Gather, Area::Disc, false), &probed);
    assert!(mean < 0.985 - SIGMAS * error, "{mean}, {error}: the bias of discs is not significant");
}

/// D4: in uniform light, per-pixel radii leave the mean unchanged and reduce the noise; before the eighth pass,
/// which provides the first statistics, nothing differs. Each pass has independent photons.
pub fn d4_radii_of_pixels_keep_the_mean<T: TestBackend>() {
    let scene = floor(Beside::Nothing);
    let of = |bandwidth| Settings {
        photons: 3_000,
        estimator: Estimator::Radius { radius: Some(0.1) },
        errors: true,
        bandwidth,
        ..settings(Area::Disc, Kernel::Epanechnikov, within())
    };
    let [own, shared] = [Bandwidth::PerPixel, Bandwidth::Shared].map(|bandwidth| {
        let truth = 0.5 / PI;
        per_pass::<T>(&scene, &of(bandwidth), 48, 2).iter().map(|l| l / truth).collect::<Vec<f64>>()
    });
    assert_eq!(own[..8], shared[..8]);
    assert_agrees("own radii", moments(&own).0, 1.0, standard_error(&own), 0.0);
    // r² is 4 times as large from pass 16 on, and 8 times from pass 32 on.
    let calmer = |own: &[f64], shared: &[f64]| moments(own).1 < 0.4 * moments(shared).1;
    assert!(calmer(&own[16..], &shared[16..]), "{own:?} {shared:?}");
    let (even, odd): (Vec<_>, Vec<_>) = shared.iter().enumerate().partition(|(pass, _)| pass % 2 == 0);
    let values = |half: Vec<(usize, &f64)>| half.iter().map(|(_, value)| **value).collect::<Vec<f64>>();
    let (even, odd) = (values(even), values(odd));
    assert!(!calmer(&even, &odd) && !calmer(&odd, &even), "a noise reduction is reported where there is none");
}

/// D7: the second radii also lose light at edges, in different proportions. Divided by their own shares of the area
/// they show no bias in uniform light, to within the 1.5 % of `area`; divided by the share of the first radius they
/// would show that of A8. The same photons with and without the correction, in 24 independent passes.
pub fn d7_second_radii_at_ends_tell_no_bias<T: TestBackend>() {
    // The fractions of light within the radius, within √2 times and within 1/√2 times the radius.
    let flat = [0.657_481, fraction(0.25 / 2.0_f64.sqrt()), fraction(0.25 * 2.0_f64.sqrt())];
    for (beside, kernel, shares) in [
        (Beside::End(0.25 * RADIUS), Kernel::Constant, Some(flat)),
        (Beside::End(0.5 * RADIUS), Kernel::Epanechnikov, None),
        (Beside::Corner(0.5 * RADIUS), Kernel::Epanechnikov, None),
        (Beside::Box(0.5 * RADIUS), Kernel::Epanechnikov, None),
    ] {
        let truth = 0.5 / PI;
        let told = |area| {
            let settings = Settings { errors: true, ..settings(area, kernel, within()) };
            let film = film::<T>(&floor(beside), &settings, 24, 1);
            let (interval, pixel) = (film.confidence_intervals().unwrap()[0], film.errors.as_ref().unwrap()[0]);
            let n = f64::from(film.passes);
            let [mean, square] = [pixel.narrow, pixel.narrow_square].map(|sum| sum / n);
            let unit = film.units.radiance_to_user() / truth;
            let error = ((square - mean * mean) / (n - 1.0)).sqrt();
            [(interval.bias / truth, interval.bias_error / truth), (mean * unit, error * unit)]
        };
        let (mended, plain) = (told(Area::Surface), told(Area::Disc));
        for (what, (mended, plain)) in ["wide", "narrow"].into_iter().zip(mended.into_iter().zip(plain)) {
            let name = format!("{beside:?}, {what}");
            assert_agrees(&name, mended.0, 0.0, mended.1, 1.5e-2);
            assert!(!agrees(plain.0, 0.0, plain.1, 1.5e-2), "{name}: bias is not significant, {plain:?}");
        }
        if let Some([first, wide, narrow]) = shares {
            let [(bias, error), (half, half_error)] = plain;
            assert_agrees("wide, by the disc", bias, wide - first, error, 0.0);
            assert_agrees("narrow, by the disc", half, first - narrow, half_error, 0.0);
        }
    }
}

/// D8: error statistics leave the image unchanged where a spoke crosses something other than its surface.
pub fn d8_errors_change_no_share_of_the_picture<T: TestBackend>() {
    for beside in [Beside::Strip(0.65 * RADIUS), Beside::Strip(0.2 * RADIUS), Beside::End(0.5 * RADIUS)] {
        let of = |errors| {
            let settings = Settings { errors, ..settings(Area::Surface, Kernel::Epanechnikov, within()) };
            film::<T>(&floor(beside), &settings, 4, 8).beauty()
        };
        for (with, without) in of(true).iter().flatten().zip(of(false).iter().flatten()) {
            // The same photons, summed in another order.
            assert!((with - without).abs() <= 1e-5 * without, "{beside:?}: {with} {without}");
        }
    }
}

/// The fraction of a disc on one side of a line at distance `at` from its centre, in radii (A8, constant kernel).
fn fraction(at: f64) -> f64 {
    1.0 - (at.acos() - at * (1.0 - at * at).sqrt()) / PI
}
