//! Round trips, damage, merging.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use backend_cpu::Cpu;
use photon_core::{Blocks, Film, Pipeline, Settings, View, render_blocks};

use crate::header::Header;
use crate::write::FilmWriter;
use crate::{FilmFileError, FilmInfo, FilmKey, Maker, atomic_write, load, load_from, merge, read_info, save};

const GRAIN: u32 = 2;

/// Films of three blocks, and of all passes at once, with their description.
struct Rendered {
    blocks: Vec<Film>,
    all: Film,
    info: FilmInfo,
}

fn render(settings: Settings, width: u32) -> Rendered {
    let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, width, 2).unwrap(), width, height: 2 };
    let mut renderer = Pipeline::new(Cpu::new().unwrap(), &scene.view(), view, settings.clone()).unwrap();
    let mut film = |passes| {
        let mut film = None;
        render_blocks(&mut renderer, &Blocks::new(passes, GRAIN).unwrap(), &mut film, &mut (), &mut |_| Ok(()))
            .unwrap();
        film.unwrap()
    };
    let (blocks, all) = ([0..2, 2..4, 4..6].map(&mut film).to_vec(), film(0..6));
    let key = FilmKey::new(&scene.view(), &view, &settings, &renderer, GRAIN);
    let mut info = FilmInfo::new(key, "cornell");
    info.add_maker(&Maker::new("test 1", "cpu", "two threads", 1.5));
    Rendered { blocks, all, info }
}

fn settings() -> Settings {
    Settings { photons: 500, errors: true, seed: u64::MAX, ..Settings::default() }
}

static RENDERED: LazyLock<Rendered> = LazyLock::new(|| render(settings(), 3));

/// The three blocks in files.
fn files(folder: &Path) -> Vec<PathBuf> {
    let names = ["b.film", "c.film", "a.film"].map(|name| folder.join(name));
    for (film, path) in RENDERED.blocks.iter().zip(&names) {
        save(path, film, &RENDERED.info).unwrap();
    }
    names.to_vec()
}

#[test]
fn a_film_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let (path, again) = (folder.path().join("a.film"), folder.path().join("b.film"));
    let Rendered { all, info, .. } = &*RENDERED;
    save(&path, all, info).unwrap();
    let (film, found) = load(&path).unwrap();
    assert!(film == *all && film.errors.is_some());
    assert_eq!((&found.key, &found.makers, &found.scene), (&info.key, &info.makers, &info.scene));
    assert!(found.contains == all.contains && found.in_order);
    assert_eq!(read_info(&path).unwrap(), found);
    save(&again, &film, &found).unwrap();
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap(), "the same film is the same file");

    let plain = render(Settings { errors: false, ..settings() }, 3);
    save(&path, &plain.all, &plain.info).unwrap();
    assert!(load(&path).unwrap().0 == plain.all);
    let error = found.key.check(&plain.info.key, &path).unwrap_err().to_string();
    assert!(error.contains("setting errors is true, not false"), "{error}");
}

#[test]
fn cut_and_unknown_passes_are_not_stored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    let Rendered { all, info, .. } = &*RENDERED;
    let (mut cut, mut unknown) = (all.clone(), all.clone());
    cut.cut = true;
    unknown.contains = photon_core::PassSet::default();
    for (film, culprit) in [(cut, "cut short"), (unknown, "not known")] {
        let error = save(&path, &film, info).unwrap_err();
        assert!(matches!(error, FilmFileError::NotStorable { .. }) && error.to_string().contains(culprit), "{error}");
    }
    assert!(!path.exists());
}

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
    let info = FilmInfo { errors: true, ..info.clone() };
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
    forged(&path, |json| json["format"] = 2.into());
    let error = load(&path).unwrap_err();
    assert!(matches!(error, FilmFileError::Newer { found: 2, known: 1, .. }), "{error}");
    type Change = fn(&mut serde_json::Value);
    let cases: [(&str, Change); 10] = [
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
        ("radii", |json| json["key"]["radii"][0] = "x".into()),
    ];
    for (culprit, change) in cases {
        forged(&path, change);
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(culprit), "{culprit}: {error}");
    }
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
    // Two blocks first: the last one is added in order. The last two first: not.
    for (pair, last, in_order) in [([0, 1], 2, true), ([1, 2], 0, false)] {
        merge(&out, &pair.map(|i| names[i].clone())).unwrap();
        let info = merge(&out, &[names[last].clone(), out.clone()]).unwrap();
        let (film, _) = load(&out).unwrap();
        assert_eq!((info.in_order, film == RENDERED.all), (in_order, in_order));
        assert_eq!(film.contains, RENDERED.all.contains);
    }
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
        (render(Settings { shadow_rays: 3, ..settings() }, 3), "setting shadow_rays is 3, not 2"),
        (render(Settings { photons: 600, ..settings() }, 3), "number of photons per pass is 600, not 500"),
        (render(settings(), 4), "camera"),
    ] {
        // Named second, since films are sorted by seed and pass.
        let mut film = other.blocks[1].clone();
        film.contains = photon_core::PassSet::of(u64::MAX, 2..4);
        save(&odd, &film, &other.info).unwrap();
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

/// NumPy opens the file, and its arrays are those of the film.
#[test]
fn numpy_reads_films() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    save(&path, &RENDERED.all, &RENDERED.info).unwrap();
    let script = "import json, sys, numpy as np\n\
        film = np.load(sys.argv[1])\n\
        info = json.loads(film['film.json'])\n\
        assert set(film.files) == set(info['arrays']) | {'film.json'}, film.files\n\
        assert film['indirect'].shape == (2, 3, 3) and film['indirect'].dtype == np.float64\n\
        assert film['hits'].shape == (2, 3) and film['hits'].dtype == np.uint64\n\
        print(repr(float(film['indirect'].sum())), info['pass_count'])";
    let python = std::env::var("PHOTON_PYTHON").unwrap_or_else(|_| "python3".into());
    let has_numpy = Command::new(&python).args(["-c", "import numpy"]).output().is_ok_and(|out| out.status.success());
    if !has_numpy {
        eprintln!("skipped: no {python} with numpy");
        return;
    }
    let output = Command::new(python).args(["-c", script]).arg(&path).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let indirect = photon_core::Layer::Indirect as usize;
    let sum: f64 = RENDERED.all.pixels.iter().flat_map(|pixel| pixel.layers[indirect]).sum();
    let mut words = text.split_whitespace();
    let found: f64 = words.next().unwrap().parse().unwrap();
    assert!((found - sum).abs() <= 1e-12 * sum && sum > 0.0, "{found} {sum}");
    assert_eq!(words.next(), Some("6"));
}
