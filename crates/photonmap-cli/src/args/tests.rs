//! Command lines and the settings that they give.

use super::*;
use photon_core::{Area, CausticPhotons, Fixed, Kernel, RandomKind, Scheduling};

fn args(arguments: &[&str]) -> Result<RenderArgs, Fault> {
    RenderArgs::try_parse_from([&["render"], arguments].concat()).map_err(Fault::input)
}

fn settings(arguments: &[&str]) -> Result<Settings, Fault> {
    let args = args(arguments)?;
    args.files.check()?;
    args.settings.settings()
}

#[test]
fn options_reach_the_settings() {
    let s = settings(&["--estimator", "knn", "--k", "70", "--photons", "1.5M", "--index", "vvh"]).unwrap();
    assert_eq!((s.photons, s.index), (1_500_000, IndexKind::Vvh));
    assert_eq!(s.estimator, Estimator::Knn { k: 70, max_radius: None });
    assert_eq!(settings(&["--max-plane-distance", "0.1"]).unwrap().max_plane_distance, Some(0.1));
    assert_eq!(settings(&["--caustic-photons", "50k"]).unwrap().caustic_photons, CausticPhotons::Aimed(50_000));
    assert_eq!(settings(&["--caustic-photons", "shared"]).unwrap().caustic_photons, CausticPhotons::Shared);
    assert_eq!(settings(&["--caustic-roughness", "0.5"]).unwrap().caustic_roughness, Some(0.5));
    assert_eq!(settings(&["--kernel", "constant"]).unwrap().kernel, Kernel::Constant);
}

#[test]
fn the_paper_brings_its_habits_unless_told_otherwise() {
    let s = settings(&["--estimator", "paper"]).unwrap();
    assert_eq!((s.random, s.scheduling, s.index), (RandomKind::Lcg, Scheduling::Static, IndexKind::Median));
    assert_eq!(s.caustic_photons, CausticPhotons::Shared);
    let s = settings(&["--estimator", "paper", "--rng", "counter", "--index", "morton"]).unwrap();
    assert_eq!((s.random, s.index), (RandomKind::Counter, IndexKind::Morton));
}

#[test]
fn a_preset_is_overruled_by_what_is_given() {
    let expected = Settings::preset(Preset::Final, 64 * 32);
    let asked = ["--preset", "final", "--size", "64x32"];
    assert_eq!(settings(&asked).unwrap(), expected);
    let more = [&asked[..], &["--photons", "7k", "--indirect", "gather"]].concat();
    let shared = Settings { bandwidth: Bandwidth::Shared, errors: false, ..expected };
    let given = Settings { photons: 7000, indirect: Indirect::Gather, ..shared };
    assert_eq!(settings(&more).unwrap(), given);
    assert!(settings(&[&more[..], &["--bandwidth", "per-pixel"]].concat()).is_err());
    let nearest = settings(&[&asked[..], &["--estimator", "knn"]].concat()).unwrap();
    assert_eq!((nearest.bandwidth, nearest.errors, nearest.area), (Bandwidth::Shared, false, Area::Surface));
    assert_eq!(settings(&[&asked[..], &["--area", "disc"]].concat()).unwrap().area, Area::Disc);
    assert_eq!(args(&asked).unwrap().settings.plan(None).until, Budget::Passes(Preset::Final.passes()));
    assert!(settings(&["--preset", "final", "--estimator", "paper"]).is_err());
}

#[test]
fn limits_and_targets_become_a_plan() {
    let plan = |arguments: &[&str], time| args(arguments).unwrap().settings.plan(time);
    assert_eq!(plan(&[], None).until, Budget::Passes(PRESET.passes()));
    let second = Some(Duration::from_secs(1));
    let timed = plan(&["--passes", "7"], second);
    assert_eq!((timed.until, timed.passes()), (Budget::Time(Duration::from_secs(1)), 7));
    let error = plan(&["--target-error", "0.05"], second);
    assert_eq!(error.until, Budget::Error { target: 0.05, share_of_pixels: 0.95 });
    assert_eq!((error.time(), error.passes()), (second, u32::MAX - 1));
    for (total, photons) in [("3M", 3_000_000), ("2e10", 20_000_000_000), ("18446744073709551615", u64::MAX)] {
        assert_eq!(plan(&["--total-photons", total], None).until, Budget::Photons(photons));
    }
    assert_eq!(plan(&["--passes", "1e3"], None).until, Budget::Passes(1000));
    let whole = args(&["--photons", "1e5", "--k", "6e1", "--shadow-rays", "4.0"]).unwrap().settings.settings().unwrap();
    assert_eq!((whole.photons, whole.shadow_rays), (100_000, 4));
    let range = plan(&["--passes", "64..128"], None);
    assert_eq!((range.first, range.until), (64, Budget::Passes(64)));
    for wrong in ["8..8", "9..8", "..8", "8..", "0..4294967295", "eight"] {
        let error = args(&["--passes", wrong]).unwrap_err().to_string();
        assert!(error.contains("64..128"), "{wrong}: {error}");
    }
    assert!(settings(&["--errors"]).unwrap().errors && settings(&["--target-error", "0.1"]).unwrap().errors);
}

#[test]
fn one_number_is_a_square() {
    let size = |text| args(&["--size", text]).map(|args| args.settings.picture.size);
    for (text, expected) in [("512", (512, 512)), ("640x480", (640, 480)), ("640X480", (640, 480)), ("9×8", (9, 8))] {
        assert_eq!(size(text).unwrap(), expected, "{text}");
    }
    let error = size("512x").unwrap_err().to_string();
    assert!(error.contains("--size") && error.contains("640x480, or one number"), "{error}");
}

#[test]
fn times_have_units() {
    let checkpoint =
        |text| args(&["--film", "a.film", "--checkpoint", text]).map(|args| args.film.checkpoint.as_secs_f64());
    for (text, seconds) in [("0s", 0.0), ("30", 30.0), ("90s", 90.0), ("5min", 300.0), ("1.5h", 5400.0)] {
        assert_eq!(checkpoint(text).unwrap(), seconds);
    }
    for wrong in ["min", "5 min", "-1s", "1e30h", "nans", ""] {
        assert!(checkpoint(wrong).is_err(), "{wrong}");
    }
    assert_eq!(args(&[]).unwrap().film.checkpoint.as_secs(), 300);
    assert!(args(&["--checkpoint", "1h"]).unwrap_err().to_string().contains("--film"));
}

/// Without any option, areas are those on the surface, and settings are fixed.
#[test]
fn the_default_is_a_preset() {
    let size = ["--size", "512x256"];
    assert_eq!(settings(&size).unwrap(), Settings::preset(PRESET, 512 * 256));
    assert_eq!(settings(&size).unwrap().area, Area::Surface);
    assert_eq!(settings(&["--estimator", "paper"]).unwrap(), Settings { area: Area::Disc, ..Settings::paper() });
    // Radii of presets are adapted to a time.
    let errors = |arguments: &[&str]| settings(&[&["--time", "5"], arguments].concat()).unwrap().errors;
    assert!(!errors(&[]) && errors(&["--errors"]) && errors(&["--bandwidth", "per-pixel"]));
    assert!(errors(&["--preset", "preview"]) && !errors(&["--preset", "preview", "--passes", "7"]));
}

#[test]
fn options_leave_the_others_to_the_rule() {
    let open = |arguments: &[&str]| args(arguments).unwrap().settings.open();
    let none = Fixed::default();
    let target = Fixed { bandwidth: true, indirect: true, ..none };
    for (arguments, expected) in [
        (&["--time", "5"][..], Some((Some(5.0), none))),
        (&["--time", "5", "--errors"], Some((Some(5.0), none))),
        (&["--time", "5", "--photons", "9k"], Some((Some(5.0), Fixed { photons: true, ..none }))),
        (&["--time", "5", "--area", "disc"], Some((Some(5.0), Fixed { area: true, ..none }))),
        (&["--time", "5", "--bandwidth", "shared"], Some((Some(5.0), Fixed { bandwidth: true, ..none }))),
        (&["--time", "5", "--indirect", "map"], Some((Some(5.0), Fixed { indirect: true, ..none }))),
        (&["--time", "5", "--shadow-rays", "2"], Some((Some(5.0), Fixed { shadow_rays: true, ..none }))),
        (&["--preset", "balanced"], Some((None, Fixed { photons: true, ..none }))),
        (&["--preset", "final"], Some((None, Fixed { photons: true, bandwidth: true, ..none }))),
        (&["--target-error", "0.1"], Some((None, target))),
        (&["--target-error", "0.1", "--time", "5"], Some((Some(5.0), target))),
        (&[], Some((None, Fixed { photons: true, ..none }))),
        (&["--preset", "preview"], None),
        (&["--preset", "final", "--time", "5"], None),
    ] {
        assert_eq!(open(arguments), expected, "{arguments:?}");
        for fixed in [["--passes", "7"], ["--total-photons", "1M"]] {
            assert_eq!(open(&[arguments, &fixed].concat()), None, "{arguments:?} {fixed:?}");
        }
    }
}

/// In place of a time, the options that were decided give the same settings.
#[test]
fn decided_settings_become_options() {
    let given = ["--size", "64x64", "--shadow-rays", "3"];
    let timed = args(&[&given[..], &["--time", "5"]].concat()).unwrap().settings;
    let first = photon_core::FirstPass::default();
    let (seconds, fixed) = timed.open().unwrap();
    let within = photon_core::Circumstances { seconds, pixels: 64 * 64, is_gpu: true, fixed };
    let decided = timed.settings().unwrap().for_time(&within, &first);
    let options = timed.decided_options(&decided);
    assert!(!options.contains("shadow-rays"), "{options}");
    let again = settings(&[&given[..], &options.split(' ').collect::<Vec<_>>()].concat()).unwrap();
    assert_eq!(again, decided, "{options}");
}

/// A first look has a limit on time, unless passes or another end are given, and never more passes than its own.
#[test]
fn a_first_look_is_quick() {
    let args = |arguments: &[&str]| args(&[&["--preset", "preview"], arguments].concat()).unwrap().settings;
    assert_eq!(args(&["--photons", "9k"]).quick_look(), Some(Duration::from_secs(2)));
    for end in [["--passes", "4"], ["--time", "9"], ["--total-photons", "1M"], ["--target-error", "0.1"]] {
        assert_eq!(args(&end).quick_look(), None, "{end:?}");
    }
    assert_eq!(args(&[]).plan(None), Plan::from(Budget::Passes(Preset::Preview.passes())));
    // A limit besides another end is a maximum; a time alone is met as nearly as possible.
    let (time, timed) = (Some(Duration::from_secs(9)), Plan::from(Budget::Time(Duration::from_secs(9))));
    assert_eq!(args(&["--time", "9"]).plan(time), timed);
    assert_eq!(args(&["--time", "9", "--target-error", "0.1"]).plan(time).most_time, time);
}

#[test]
fn absurd_values_are_refused() {
    for bad in [
        vec!["--k", "0"],
        vec!["--estimator", "knn", "--k", "1"],
        vec!["--radius", "0"],
        vec!["--radius", "inf"],
        vec!["--radius=-1"],
        vec!["--radius-factor", "0"],
        vec!["--photons", "0"],
        vec!["--caustic-photons", "0"],
        vec!["--caustic-photons", "many"],
        vec!["--caustic-roughness", "1.5"],
        vec!["--caustic-roughness", "nan"],
        vec!["--photons", "1.5"],
        vec!["--photons", "1e308"],
        vec!["--passes", "1.5"],
        vec!["--shadow-rays", "2.5"],
        vec!["--total-photons", "0.5"],
        vec!["--total-photons", "1e30"],
        vec!["--size", "0x0"],
        vec!["--size", "0"],
        vec!["--size", "512x"],
        vec!["--size", "x512"],
        vec!["--size", "8x8x8"],
        vec!["--size", "-8"],
        vec!["--size", "99999999999"],
        vec!["--size", "1e3"],
        vec!["--size", ""],
        vec!["--passes", "0"],
        vec!["--time", "0"],
        vec!["--time", "nan"],
        vec!["--target-error", "0"],
        vec!["--target-error", "nan"],
        vec!["--target-error", "0.1", "--share", "1.5"],
        vec!["--target-error", "0.1", "--estimator", "knn"],
        vec!["--total-photons", "0"],
        vec!["--kernel", "box"],
        vec!["--alpha", "0"],
        vec!["--max-plane-distance", "0"],
        vec!["--max-bounces", "0"],
        vec!["--exposure", "nan"],
        vec!["--backend", "cuda"],
    ] {
        assert!(settings(&bad).is_err(), "{bad:?}");
    }
}
