//! Films come back from files; NumPy reads them.

use std::process::Command;
use std::sync::LazyLock;

use backend_cpu::Cpu;
use photon_core::{Blocks, Film, Pipeline, Settings, View, render_blocks};

use crate::{FilmFileError, FilmInfo, FilmKey, Maker, load, load_from, read_info, save};

mod damage;
mod merging;

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
    let tally = &found.tally;
    assert_eq!((tally.passes, tally.photons.emitted), (6, 6 * 500));
    assert!(tally.photons.balances() && tally.photons.stored.values().sum::<u64>() > 0);
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

/// A film of two passes of 500 paths that the second version wrote, in the present format: it stays readable.
#[test]
fn films_of_format_2_are_read() {
    let bytes = include_bytes!("format2.film");
    let (film, info) = load_from(std::io::Cursor::new(bytes), bytes.len() as u64, "format2.film".as_ref()).unwrap();
    assert_eq!((film.width, film.height, film.passes, info.key.photons()), (2, 1, 2, 500));
    assert_eq!((film.tally.passes, film.tally.photons.emitted, film.tally.photons.balances()), (2, 1000, true));
}

/// A film of two passes that the first version wrote.
#[test]
fn films_of_older_versions_are_read() {
    let bytes = include_bytes!("format1.film");
    let source = std::io::Cursor::new(bytes);
    let (film, info) = load_from(source, bytes.len() as u64, "format1.film".as_ref()).unwrap();
    assert_eq!((film.width, film.height, film.passes, film.contains.to_string().as_str()), (2, 1, 2, "0..2"));
    assert!(
        film.pixels.iter().all(|pixel| pixel.hits == 1) && film.beauty().iter().flatten().all(|&value| value > 0.0)
    );
    assert_eq!((info.scene.as_str(), info.makers[0].backend.as_str()), ("cornell", "cpu"));
    assert_eq!((film.tally.passes, info.tally.passes), (0, 0), "its photons were not counted");
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
