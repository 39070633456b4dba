//! Damaged and forged files.

use std::path::Path;

use photon_core::Film;

use super::{RENDERED, Rendered};
use crate::header::Header;
use crate::write::FilmWriter;
use crate::{FilmFileError, FilmInfo, atomic_write, load, load_from, save};

/// What comes of bytes.
fn read(bytes: &[u8]) -> Result<(Film, FilmInfo), FilmFileError> {
    load_from(std::io::Cursor::new(bytes), bytes.len() as u64, Path::new("a.film"))
}

/// Whether bytes are refused, or are the same film.
fn is_harmless(bytes: &[u8]) -> bool {
    read(bytes).map_or(true, |(film, info)| film == RENDERED.all && info.key == RENDERED.info.key)
}

#[test]
fn damage_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    save(&path, &RENDERED.all, &RENDERED.info).unwrap();
    let good = std::fs::read(&path).unwrap();
    assert!(read(&good).unwrap().0 == RENDERED.all);
    for at in 0..good.len() {
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (at % 8);
        assert!(is_harmless(&bytes), "byte {at} of {}", good.len());
    }
    for length in (0..good.len()).step_by(7) {
        let error = read(&good[..length]).unwrap_err().to_string();
        assert!(error.contains("a.film") && error.contains("not a whole film file"), "{error}");
    }
    // A few bytes at a time, by a linear congruential generator.
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..2000 {
        let mut bytes = good.clone();
        for _ in 0..1 + next(8) {
            let at = next(bytes.len());
            bytes[at] = next(256) as u8;
        }
        assert!(is_harmless(&bytes));
    }
    assert!(matches!(load(&folder.path().join("none.film")), Err(FilmFileError::Read { .. })));
}

/// Writes a file with the description of the film, changed by `change`, and its arrays.
fn forged(path: &Path, change: impl FnOnce(&mut serde_json::Value)) {
    let Rendered { all, info, .. } = &*RENDERED;
    let info = FilmInfo { errors: true, tally: all.tally.clone(), ..info.clone() };
    let header = std::cell::RefCell::new(Header::new(&info, &all.contains));
    atomic_write::write(path, |file| {
        let mut writer = FilmWriter::new(file, all.width, all.height);
        for column in crate::column::Column::all(true) {
            let mut pixels = 0..all.pixels.len();
            writer.array(column, false, &mut header.borrow_mut(), |row| {
                row.chunks_exact_mut(column.width()).zip(&mut pixels).for_each(|(to, i)| column.get(all, i, to));
                Ok(())
            })?;
        }
        let mut json = serde_json::to_value(&*header.borrow())?;
        change(&mut json);
        writer.finish(&json)
    })
    .unwrap();
}

#[test]
fn descriptions_are_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    forged(&path, |_| {});
    assert!(load(&path).unwrap().0 == RENDERED.all, "the forger works");
    forged(&path, |json| json["format"] = 3.into());
    let error = load(&path).unwrap_err();
    assert!(matches!(error, FilmFileError::Newer { found: 3, known: 2, .. }), "{error}");
    type Change = fn(&mut serde_json::Value);
    let cases: [(&str, Change); 14] = [
        // 2³¹ pixels: refused by the size of the arrays, without memory for them.
        ("needs 51539607680", |json| json["key"]["width"] = (1_u64 << 30).into()),
        ("2^31", |json| json["key"]["width"] = (1_u64 << 31).into()),
        ("0x2", |json| json["key"]["width"] = 0.into()),
        ("6 passes, but lists 8", |json| json["passes"][0]["end"] = 8.into()),
        ("none", |json| json["passes"][0]["first"] = 6.into()),
        ("arrays", |json| json["arrays"].as_array_mut().unwrap().truncate(3)),
        ("arrays", |json| json["errors"] = false.into()),
        ("format", |json| json["format"] = "one".into()),
        ("units", |json| json["key"]["units"][3] = "7ff8000000000000".into()),
        ("counts the photons of 7 passes, but has 6", |json| json["tally"]["passes"] = 7.into()),
        ("map \"third\"", |json| json["tally"]["photons"]["stored"]["third"] = 1.into()),
        ("flux \"1.5\"", |json| json["tally"]["aimed"]["flux_dropped"][2] = "1.5".into()),
        ("integer `-1`", |json| json["tally"]["photons"]["emitted"] = (-1).into()),
        ("radii", |json| json["key"]["radii"][0] = "x".into()),
    ];
    for (culprit, change) in cases {
        forged(&path, change);
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(culprit), "{culprit}: {error}");
    }
}

/// Checksums are right where a broken computer wrote wrong sums: they are refused when a film is read and when it is merged.
#[test]
fn sums_must_be_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let [path, good, out] = ["a.film", "good.film", "out.film"].map(|name| folder.path().join(name));
    let Rendered { blocks, info, .. } = &*RENDERED;
    save(&good, &blocks[0], info).unwrap();
    type Change = fn(&mut Film);
    let cases: [(&str, Change); 9] = [
        ("indirect.npy: the sum of the pixel in column 1 and row 1 is NaN", |film| {
            film.pixels[4].layers[3][2] = f64::NAN
        }),
        ("direct.npy: the sum of the pixel in column 0 and row 0 is inf", |film| {
            film.pixels[0].layers[1][0] = f64::INFINITY
        }),
        ("column 2 and row 1 is -0.5, but must be finite and at least 0", |film| film.pixels[5].square = -0.5),
        ("normal.npy", |film| film.pixels[0].normal[1] = f64::NAN),
        ("albedo.npy", |film| film.pixels[0].albedo[1] = -1.0),
        ("depth.npy", |film| film.pixels[0].depth = f64::INFINITY),
        ("hits.npy: the sum of the pixel in column 1 and row 0 is 3, but there are 2 camera paths", |film| {
            film.pixels[1].hits = 3
        }),
        ("bias.npy", |film| film.errors.as_mut().unwrap()[0].bias = f64::NEG_INFINITY),
        ("narrow_square.npy", |film| film.errors.as_mut().unwrap()[0].narrow_square = -1.0),
    ];
    for (culprit, change) in cases {
        let mut film = blocks[1].clone();
        change(&mut film);
        save(&path, &film, info).unwrap();
        for error in [load(&path).unwrap_err(), crate::merge(&out, &[good.clone(), path.clone()]).unwrap_err()] {
            let text = error.to_string();
            assert!(text.contains("a.film") && text.contains(culprit), "{culprit}: {text}");
        }
        assert!(!out.exists());
    }
    // Directions and differences have signs.
    let mut film = blocks[1].clone();
    (film.pixels[0].normal, film.errors.as_mut().unwrap()[0].narrow) = ([-2.0; 3], -1.0);
    save(&path, &film, info).unwrap();
    assert!(load(&path).is_ok());
}
