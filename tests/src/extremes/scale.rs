//! S1, S3, S4: the same scene in every size and at every position.

use photon_core::{Film, Layer, PerMap, Photon, Settings};

use super::scenes::{Put, mean, studio};
use super::sheet::Sheet;
use crate::equivalence::matched;
use crate::harness::{TestBackend, film, trace};
use crate::numerics::{turned_drum, turned_room, turned_wedge};

/// Runs the group.
pub fn all<T: TestBackend>(sheet: &mut Sheet) {
    leaks::<T>(sheet);
    let base = see::<T>(sheet, Put::default());
    sizes::<T>(sheet, &base);
    places::<T>(sheet, &base);
    beyond_pictures(sheet);
}

/// S1: diffuse bounces in a closed room without axis-aligned walls.
fn leaks<T: TestBackend>(sheet: &mut Sheet) {
    let exponents: Vec<i32> = sheet.choose(vec![-30, 30], vec![-30, 0, 30], (-30..=30).step_by(5).collect());
    let paths = sheet.either(1500, 10_500);
    let (mut met, mut lost) = (0, 0);
    for exponent in &exponents {
        let scene = turned_room(0.99, 10.0_f64.powi(*exponent)).build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 2000, ..Settings::default() }, &[paths]);
        met += tally.surfaces;
        lost += tally.escaped + tally.dropped;
    }
    let range = format!("10^k m, k = {exponents:?}, {met} bounces");
    sheet.holds("S1", "closed rotated box, albedo 0.99: paths that escape", range, lost.to_string(), lost == 0);

    let rooms = [
        ("drum of 512 sides, slivers", turned_drum(0.99, 1.0), sheet.either(300, 20_000)),
        ("wedge of 60 degrees", turned_wedge(60.0, 0.99, 1.0), sheet.either(1500, 100_000)),
    ];
    for (name, room, paths) in rooms {
        let scene = room.build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 2000, ..Settings::default() }, &[paths]);
        let lost = tally.escaped + tally.dropped;
        let range = format!("{} bounces", tally.surfaces);
        sheet.holds("S1", format!("closed rotated {name}: paths that escape"), range, lost.to_string(), lost == 0);
    }
}

fn settings(sheet: &Sheet) -> Settings {
    Settings { photons: sheet.either(6000, 60_000), max_bounces: 24, seed: 4, ..Settings::default() }
}

struct Seen {
    photons: PerMap<Vec<Photon>>,
    film: Film,
}

fn see<T: TestBackend>(sheet: &Sheet, put: Put) -> Seen {
    let scene = studio(put).build().unwrap();
    let settings = settings(sheet);
    let (photons, tally) = trace::<T>(2, &scene, &settings, &[settings.photons]);
    assert!(tally.balances(), "{tally:?}");
    Seen { photons, film: film::<T>(&scene, &Settings { photons: 2000, ..settings }, 1, 12) }
}

/// Minimum over the maps of the proportion of photons that both have, at the same position with the same power.
fn share(a: &Seen, b: &Seen) -> f64 {
    a.photons.iter().map(|(kind, a)| matched(a, &b.photons[kind])).fold(1.0, f64::min)
}

/// Relative difference of two means.
fn apart(a: f64, b: f64) -> f64 {
    (a / b - 1.0).abs()
}

/// S4: the same power in a room `s` times as large gives `s⁻²` times the irradiance.
fn sizes<T: TestBackend>(sheet: &mut Sheet, base: &Seen) {
    let powers = sheet.either(vec![99], (-99..=99).step_by(11).collect());
    let bits = powers.iter().all(|&power| {
        let seen = see::<T>(sheet, Put { size: 2.0_f64.powi(power), ..Put::default() });
        seen.photons == base.photons && seen.film.pixels == base.film.pixels
    });
    let range = format!("2^k, k = {}…{}, {} sizes", powers[0], powers[powers.len() - 1], powers.len());
    let found = if bits { "all bits equal" } else { "bits differ" };
    sheet.holds("S4", "powers of two: photon maps and picture, bit by bit", range, found, bits);

    let exponents: Vec<i32> = sheet.choose(vec![-30], vec![-30, 11, 30], (-30..=30).collect());
    let (mut least, mut direct, mut whole) = (1.0_f64, 0.0_f64, 0.0_f64);
    for &exponent in &exponents {
        let size = 10.0_f64.powi(exponent);
        let seen = see::<T>(sheet, Put { size, ..Put::default() });
        least = least.min(share(base, &seen));
        let of = |layer| apart(mean(&seen.film, layer) * size * size, mean(&base.film, layer));
        direct = direct.max(of(Some(Layer::Direct)));
        whole = whole.max(of(None));
    }
    let range = format!("10^k, k = {}…{}, {} sizes", exponents[0], exponents[exponents.len() - 1], exponents.len());
    let found = format!("{least:.5} of the photons the same, {direct:.1e}, {whole:.1e}");
    let what = "powers of ten: share of photons that are the same; E·s² of direct light and of the picture, relative";
    sheet.holds("S4", what, range, found, least > 0.999 && direct < 1e-6 && whole < 1e-3);
}

/// S3: a scene far from the user's origin, given in f64.
fn places<T: TestBackend>(sheet: &mut Sheet, base: &Seen) {
    let exponents: Vec<i32> = sheet.choose(vec![9], vec![4, 7, 9], (0..=9).collect());
    for &exponent in &exponents {
        let far = 10.0_f64.powi(exponent);
        let put = Put { place: [far, -0.7 * far, 0.3 * far], ..Put::default() };
        let seen = see::<T>(sheet, put);
        let least = share(base, &seen);
        let apart = apart(mean(&seen.film, Some(Layer::Direct)), mean(&base.film, Some(Layer::Direct)));
        let scene = studio(put).build().unwrap();
        let warned = scene.warnings().iter().any(|warning| warning.contains("away from the origin"));
        let found = format!("{least:.5}; {apart:.1e}; {}", if warned { "warned" } else { "not warned" });
        // Beyond 1e8, the user's f64 coordinates have no more digits than f32 relative to the scene's centre.
        let good = if exponent <= 7 { least > 0.995 && apart < 1e-6 } else { least > 0.9 && apart < 1e-4 };
        let what = "share of photons that are the same; direct light, relative; whether the builder warns";
        sheet.holds(
            "S3",
            what,
            format!("offset of 10^{exponent} times half the size"),
            found,
            good && warned == (far > 3e4),
        );
    }
}

/// The builder must warn of radiances that an f32 image cannot hold.
fn beyond_pictures(sheet: &mut Sheet) {
    let warns = |size: f64, watts: f64| {
        let scene = studio(Put { size, watts, ..Put::default() }).build().unwrap();
        scene.warnings().iter().any(|warning| warning.contains("32 bits of a picture"))
    };
    let good = warns(1e-30, 1.0) && warns(1e30, 1.0) && !warns(1e-12, 1.0) && !warns(1e12, 1.0) && !warns(1e15, 1e30);
    let what = "radiances that 32 bits of a picture cannot hold: the builder warns (the film itself is f64)";
    sheet.holds("S4", what, "1e-30 m, 1e30 m; not at 1e-12 m, 1e12 m", if good { "warned" } else { "silent" }, good);
}
