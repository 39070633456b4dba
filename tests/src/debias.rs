//! What mends an estimate's bias, against closed forms: with and without.

use photon_core::{Area, Bandwidth, Direct, Estimator, Indirect, Kernel, Settings};
use photon_scene::shapes::{self, cuboid};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};
use std::f64::consts::{FRAC_1_PI, PI};

use crate::harness::{TestBackend, film, look_at_point, per_pass};
use crate::stats::{SIGMAS, agrees, assert_agrees, moments, standard_error};

/// The radius of the estimates below, user length.
const RADIUS: f64 = 0.25;

/// What stands beside the point that is looked at, at the origin.
#[derive(Clone, Copy, Debug)]
enum Beside {
    /// The floor goes on.
    Nothing,
    /// It ends at x.
    End(f64),
    /// It ends at x and at y.
    Corner(f64),
    /// A tall box stands on it, from x on.
    Box(f64),
    /// It is a mirror from x on.
    Mirror(f64),
    /// It is black from x on.
    Black(f64),
    /// It is black from x for a tenth of the radius, and goes on.
    Strip(f64),
    /// A sheet of glass lies a little above it.
    Glass,
    /// A wall without thickness stands on it.
    Wall(f64),
    /// A step down, of a tenth of the radius: still the same surface.
    Step(f64),
}

/// A floor under light from straight above, of irradiance 1 and albedo 1/2: radiance 1/2π.
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
            // An index of nearly 1: light goes through as if it were not there, but is refracted.
            let glass = builder.material(MaterialDesc::thin("glass", 1.000_1));
            let z = 0.1 * RADIUS;
            builder.quad("glass", [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]], glass);
        }
        _ => {}
    }
    builder.light("sun", LightDesc::Directional { direction: [0.0, 0.0, -1.0], irradiance: [1.0; 3] });
    // The pixel lies within the floor even where that ends at the origin.
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

/// Radiance over the truth, pass by pass.
fn shares<T: TestBackend>(beside: Beside, settings: &Settings) -> Vec<f64> {
    let truth = 0.5 / PI;
    per_pass::<T>(&floor(beside), settings, 8, 1).iter().map(|radiance| radiance / truth).collect()
}

/// D1: where a disc hangs over an end, or under a box, the light of A8 is lost, and divided by what lies
/// on the surface it is all there again, up to the 0.4 % of `area`. Independent passes; photons are the
/// same with and without, so that one over the other shows the share alone.
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
        assert!(!agrees(moments(&plain).0, 1.0, standard_error(&plain), 4e-3), "{beside:?}: nothing was to be seen");
    }
    // A strip that a spoke ends beyond is overlooked there: of the light that it takes, some stays lost; none is added.
    let [mended, plain] = [Area::Surface, Area::Disc]
        .map(|area| shares::<T>(Beside::Strip(0.3 * RADIUS), &settings(area, round, within())));
    // But for the order of sums.
    let gained: Vec<f64> = mended.iter().zip(&plain).map(|(mended, plain)| mended / plain - 1.0).collect();
    assert!(gained.iter().all(|&gain| gain > -1e-5) && moments(&gained).0 > 1e-3, "{gained:?}");
    assert!(moments(&mended).0 < 1.0 + SIGMAS * standard_error(&mended) + 4e-3, "{mended:?}");
    // The nearest photons' disc reaches as far as there are photons.
    let knn = Estimator::Knn { k: 100, max_radius: None };
    let mended = shares::<T>(Beside::End(0.0), &settings(Area::Surface, round, knn));
    assert_agrees("nearest", moments(&mended).0, 1.0, standard_error(&mended), 4e-3);
}

/// D2: within a surface, under a ceiling of glass, over a step that is none and before a wall that photons
/// leak through, not a bit changes.
pub fn d2_nothing_changes_within_a_surface<T: TestBackend>() {
    for beside in [Beside::Nothing, Beside::Glass, Beside::Step(0.1), Beside::Wall(0.1)] {
        let scene = floor(beside);
        let of = |area| film::<T>(&scene, &settings(area, Kernel::Epanechnikov, within()), 2, 2);
        let (mended, plain) = (of(Area::Surface), of(Area::Disc));
        assert_eq!(mended, plain, "{beside:?}");
        assert!(plain.beauty().iter().flatten().all(|&c| c > 0.0), "{beside:?}");
    }
}

/// D3: rays that take the irradiance of the nearest photon find the furnace of C1: in a ball, and, divided
/// by the surface, in a cube, where the disc loses light along all edges. Passes are independent.
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
    let of = |scene: &Scene, area, irradiance_every, radius| {
        let settings = Settings {
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
    // 0.4 % of `area`, and the ball's facets, as in C1.
    let check = |what: &str, found: &[f64]| {
        assert_agrees(what, moments(found).0, 5.0, standard_error(found), 4e-3 * 5.0);
    };
    // The same photons: one over the other shows what is gained or lost without their noise.
    let over = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a / b - 1.0).collect() };
    // Some 80 photons to a disc. By Epanechnikov's kernel 1 % would be gained.
    let (nearest, asked) = (of(&ball, Area::Disc, Some(8), 0.12), of(&ball, Area::Disc, None, 0.12));
    check("ball", &nearest);
    let gained = over(&nearest, &asked);
    assert_agrees("ball, over all photons", moments(&gained).0, 0.0, standard_error(&gained), 2e-3);
    let (whole, dark) = (of(&cube, Area::Surface, Some(4), 0.3), of(&cube, Area::Disc, Some(4), 0.3));
    check("cube", &whole);
    let lost = over(&dark, &whole);
    assert!(moments(&lost).0 < -0.02 - SIGMAS * standard_error(&lost), "{lost:?}: nothing was to be seen");
}

/// D4: under even light pixels of their own radius see the truth, with less noise; nothing differs before
/// the eighth pass has told something. Independent photons in each pass.
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
    assert!(!calmer(&even, &odd) && !calmer(&odd, &even), "less noise is seen where there is none");
}

/// D7: the second radii lose light at ends too, and other shares of it. Divided by these they tell no bias where light
/// is even, up to the 1.5 % of `area`; divided by the first radius' they would tell that of A8. The same photons with
/// and without, in 24 independent passes.
pub fn d7_second_radii_at_ends_tell_no_bias<T: TestBackend>() {
    // By how much less lies within √2 and more within 1/√2 of the radius, over what lies within the radius.
    let flat = [0.657_481, fraction(0.25 / 2.0_f64.sqrt()), fraction(0.25 * 2.0_f64.sqrt())];
    for (beside, kernel, shares) in [
        (Beside::End(0.25 * RADIUS), Kernel::Constant, Some(flat)),
        (Beside::End(0.5 * RADIUS), Kernel::Epanechnikov, None),
        (Beside::Corner(0.5 * RADIUS), Kernel::Epanechnikov, None),
        (Beside::Box(0.5 * RADIUS), Kernel::Biweight, None),
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
            assert!(!agrees(plain.0, 0.0, plain.1, 1.5e-2), "{name}: nothing was to be seen, {plain:?}");
        }
        if let Some([first, wide, narrow]) = shares {
            let [(bias, error), (half, half_error)] = plain;
            assert_agrees("wide, by the disc", bias, wide - first, error, 0.0);
            assert_agrees("narrow, by the disc", half, first - narrow, half_error, 0.0);
        }
    }
}

/// D8: errors leave the picture alone where what a spoke passes is not its surface all along.
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

/// Of a disc, the part on one side of a line at that distance from its middle, in radii (A8, constant kernel).
fn fraction(at: f64) -> f64 {
    1.0 - (at.acos() - at * (1.0 - at * at).sqrt()) / PI
}
