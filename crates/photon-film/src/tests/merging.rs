//! Films of parts of a render.

use std::path::{Path, PathBuf};

use photon_core::{FilmTally, Settings};

use super::{RENDERED, render, settings};
use crate::{FilmFileError, FilmInfo, FilmWords, Maker, load, merge, read_info, save};

/// The three blocks in files.
fn files(folder: &Path) -> Vec<PathBuf> {
    let names = ["b.film", "c.film", "a.film"].map(|name| folder.join(name));
    for (film, path) in RENDERED.blocks.iter().zip(&names) {
        save(path, film, &RENDERED.info).unwrap();
    }
    names.to_vec()
}

#[test]
fn blocks_merge_to_the_bits_of_a_single_render() {
    let folder = tempfile::tempdir().unwrap();
    let (out, names) = (folder.path().join("out.film"), files(folder.path()));
    for order in [[0, 1, 2], [2, 0, 1]] {
        let info = merge(&out, &order.map(|i| names[i].clone())).unwrap();
        let (film, found) = load(&out).unwrap();
        assert!(film == RENDERED.all && found == info && info.in_order, "{order:?}");
    }
    assert_eq!(read_info(&out).unwrap().makers[0].seconds, 4.5);
    assert_eq!(read_info(&out).unwrap().tally, RENDERED.all.tally);
    // A film without counts, as older versions wrote them: it is known how many passes were counted.
    let mut uncounted = RENDERED.blocks[1].clone();
    uncounted.tally = FilmTally::default();
    save(&names[1], &uncounted, &RENDERED.info).unwrap();
    let tally = merge(&out, &names).unwrap().tally;
    assert_eq!((tally.passes, tally.photons.emitted), (4, 4 * 500));
    assert!(load(&out).unwrap().0 != RENDERED.all);
    save(&names[1], &RENDERED.blocks[1], &RENDERED.info).unwrap();
    // Two blocks first: the last one is added in order. The last two first: not.
    for (pair, last, in_order) in [([0, 1], 2, true), ([1, 2], 0, false)] {
        merge(&out, &pair.map(|i| names[i].clone())).unwrap();
        let info = merge(&out, &[names[last].clone(), out.clone()]).unwrap();
        let (film, _) = load(&out).unwrap();
        assert_eq!((info.in_order, film == RENDERED.all), (in_order, in_order));
        assert_eq!(film.contains, RENDERED.all.contains);
    }
    // Passes of two backends are not a single render.
    let mut info = RENDERED.info.clone();
    info.makers = vec![Maker::new("test 1", "other", "device", 1.0)];
    save(&names[1], &RENDERED.blocks[1], &info).unwrap();
    assert!(!merge(&out, &names[..2]).unwrap().in_order);
    // Gaps are allowed, but are not a single render.
    assert!(!merge(&out, &[names[0].clone(), names[2].clone()]).unwrap().in_order);
}

#[test]
fn films_that_do_not_fit_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (out, names, odd) = (folder.path().join("out.film"), files(folder.path()), folder.path().join("odd.film"));
    save(&out, &RENDERED.all, &RENDERED.info).unwrap();
    let before = std::fs::read(&out).unwrap();
    let refused = |culprits: &[&str]| {
        let error = merge(&out, &[names[0].clone(), odd.clone()]).unwrap_err().to_string();
        assert!(culprits.iter().all(|culprit| error.contains(culprit)), "{error}");
        assert!(std::fs::read(&out).unwrap() == before);
    };
    for (other, culprit) in [
        (render(Settings { camera_samples: 2, ..settings() }, 3), "setting camera_samples is 2, not 1"),
        (render(Settings { shadow_rays: 3, ..settings() }, 3), "setting shadow_rays is 3, not 2"),
        (render(Settings { photons: 600, ..settings() }, 3), "number of photons per pass is 600, not 500"),
        (render(settings(), 4), "size is 4x2, not 3x2"),
    ] {
        // Named second, since films are sorted by seed and pass.
        let mut film = other.blocks[1].clone();
        film.contains = photon_core::PassSet::of(u64::MAX, 2..4);
        save(&odd, &film, &other.info).unwrap();
        refused(&["odd.film", culprit]);
    }
    // The first difference on which others depend, in words.
    let key = |change: fn(&mut serde_json::Value)| {
        let mut key = serde_json::to_value(&RENDERED.info.key).unwrap();
        change(&mut key);
        FilmInfo { key: serde_json::from_value(key).unwrap(), ..RENDERED.info.clone() }
    };
    let other = "0".repeat(32);
    for (info, culprit) in [
        (key(|key| (key["scene"], key["camera"]) = ("0".repeat(32).into(), "00".into())), other.as_str()),
        (
            key(|key| key["camera"] = format!("0000003f{}", &key["camera"].as_str().unwrap()[8..]).into()),
            "one with position [0.5, ",
        ),
        (
            key(|key| key["settings"]["kernel"] = "\u{1b}]0;title\u{7}".into()),
            "setting kernel is \\u{1b}]0;title\\u{7}, not",
        ),
        (key(|key| key["settings"]["kernel"] = "x".repeat(9999).into()), "xxx…, not"),
    ] {
        save(&odd, &RENDERED.blocks[1], &info).unwrap();
        refused(&["odd.film", culprit]);
    }
    let mut key = serde_json::to_value(&RENDERED.info.key).unwrap();
    key["radii"][0] = "3e000000".into();
    let info = FilmInfo { key: serde_json::from_value(key).unwrap(), ..RENDERED.info.clone() };
    save(&odd, &RENDERED.blocks[1], &info).unwrap();
    refused(&["odd.film", "list of radii", "3e000000"]);
    std::fs::copy(&names[0], &odd).unwrap();
    refused(&["odd.film", "0..2 of seed 18446744073709551615", "leave one"]);
    // Damage in the pixels, which shows only while they are read.
    let mut bytes = std::fs::read(&names[1]).unwrap();
    bytes[300] ^= 1;
    std::fs::write(&odd, bytes).unwrap();
    refused(&["odd.film", "not a whole film"]);
    assert!(matches!(merge(&out, &[]), Err(FilmFileError::NoFilms)));
}

/// The sums of blocks as words have the bits of merged films; other pixels are not touched.
#[test]
fn words_of_films_are_added_as_films_are() {
    let words = FilmWords::new(true);
    let [first, second, _] = &RENDERED.blocks[..] else { panic!("three blocks") };
    let mut sums = words.of(first, 1..5);
    assert_eq!(sums.len(), 4 * words.per_pixel());
    words.add(&mut sums, &words.of(second, 1..5));
    let mut expected = first.clone();
    expected.merge(second).unwrap();
    let mut film = first.clone();
    words.set(&mut film, 1..5, &sums);
    for pixel in 0..6 {
        let (pixels, errors) = if pixel == 0 || pixel == 5 {
            (&first.pixels, &first.errors)
        } else {
            (&expected.pixels, &expected.errors)
        };
        assert_eq!(film.pixels[pixel], pixels[pixel], "{pixel}");
        assert!(film.errors.as_ref().unwrap()[pixel] == errors.as_ref().unwrap()[pixel], "{pixel}");
    }
    assert!(FilmWords::new(false).per_pixel() < words.per_pixel());
}
