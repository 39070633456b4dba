//! `--denoise`, with a library in C that has the interface of Open Image Denoise and a known result.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{SMALL, channels, folder, photonmap, refused, render, run, stderr, succeeded};

/// The compiled library.
fn library(folder: &Path) -> PathBuf {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/denoise/oidn.c");
    let library = folder.join("libOpenImageDenoise.so.2");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-o"]).arg(&library).arg(source);
    assert!(cc.status().unwrap().success());
    library
}

fn render_with(library: &Path, arguments: &[&str]) -> Output {
    photonmap("render")
        .args(["cornell", "--backend", "cpu"])
        .args(SMALL)
        .args(arguments)
        .env("PHOTON_OIDN", library)
        .output()
        .unwrap()
}

/// Colour, albedo and normal arrive in order; layers stay as they are; the file says how it was denoised.
#[test]
fn a_picture_is_denoised() {
    let folder = folder("denoise");
    let library = library(&folder);
    let (raw, denoised) = (folder.join("raw.exr"), folder.join("denoised.exr"));
    succeeded(&render_with(&library, &["-o", raw.to_str().unwrap()]));
    let output = render_with(&library, &["--denoise", "-o", denoised.to_str().unwrap()]);
    succeeded(&output);
    assert!(stderr(&output).contains("denoised by Open Image Denoise 2.3.4"), "{output:?}");
    let (raw, denoised_file) = (channels(&raw), &denoised);
    let denoised = channels(denoised_file);
    for (name, axis) in [("R", "X"), ("G", "Y"), ("B", "Z")] {
        let expected = raw[name].iter().zip(&raw[&format!("albedo.{name}")]).zip(&raw[&format!("N.{axis}")]);
        for (&found, ((&color, &albedo), &normal)) in denoised[name].iter().zip(expected) {
            assert_eq!(found, 2.0 * color + albedo + normal);
        }
        for layer in ["emission", "direct", "caustic", "indirect", "albedo"] {
            let channel = format!("{layer}.{name}");
            assert_eq!(raw[&channel], denoised[&channel]);
        }
    }
    let bytes = std::fs::read(denoised_file).unwrap();
    let says = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(says("photon:denoised") && says("Open Image Denoise 2.3.4, by albedo and normal"));
}

/// With error estimates, no pixel with an interval leaves it.
#[test]
fn a_denoised_picture_stays_within_the_claimed_errors() {
    let folder = folder("denoise-errors");
    let library = library(&folder);
    let film = folder.join("a.film");
    let of_film = ["--size", "24x16", "--photons", "3000", "--passes", "8", "--errors", "--film"];
    succeeded(&photonmap("render").args(["cornell", "--backend", "cpu"]).args(of_film).arg(&film).output().unwrap());
    let (raw, denoised) = (folder.join("raw.exr"), folder.join("denoised.exr"));
    succeeded(&run("picture", &[film.to_str().unwrap(), "-o", raw.to_str().unwrap()]));
    let arguments = [film.to_str().unwrap(), "--denoise", "-o", denoised.to_str().unwrap()];
    let output = photonmap("picture").args(arguments).env("PHOTON_OIDN", &library).output().unwrap();
    succeeded(&output);
    assert!(stderr(&output).contains("within the claimed errors"), "{output:?}");
    let (raw, denoised) = (channels(&raw), channels(&denoised));
    let mean = |of: &std::collections::BTreeMap<String, Vec<f32>>, pixel: usize| {
        ["R", "G", "B"].iter().map(|&name| f64::from(of[name][pixel])).sum::<f64>() / 3.0
    };
    let (mut limited, mut free) = (0, 0);
    for (pixel, &claimed) in raw["claimed.Y"].iter().enumerate() {
        let difference = (mean(&denoised, pixel) - mean(&raw, pixel)).abs();
        if claimed.is_finite() {
            // Twice the colour is far outside. Colours are rounded to 24 bits.
            let (most, rounding) = (f64::from(claimed), 1e-6 * mean(&raw, pixel).abs());
            assert!(difference <= most + rounding, "{pixel}: {difference} instead of {most}");
            limited += usize::from(difference > 0.99 * most);
        } else {
            free += usize::from(difference > 0.1 * mean(&raw, pixel).abs());
        }
    }
    assert!(limited > 20 && free > 20, "{limited} {free}");
}

/// Without the library, or with another one, nothing is rendered; if it fails at the end, the picture is written all the same.
#[test]
fn what_is_wrong_with_the_library_is_named() {
    let folder = folder("denoise-faults");
    let picture = folder.join("a.png");
    let missing = render_with(Path::new("/nowhere/lib.so"), &["--denoise", "-o", picture.to_str().unwrap()]);
    refused(&missing, "PHOTON_OIDN");
    let other = folder.join("other.so");
    std::fs::write(folder.join("other.c"), "int other;\n").unwrap();
    let compiled = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&other).arg(folder.join("other.c")).status();
    assert!(compiled.unwrap().success());
    refused(&render_with(&other, &["--denoise", "-o", picture.to_str().unwrap()]), "not version 2");
    assert!(!picture.exists());
    refused(&render(&["cornell", "--denoise", "--transparent"]), "cannot be used with");

    let library = library(&folder);
    let failed = photonmap("render")
        .args(["cornell", "--backend", "cpu", "--denoise", "-o", picture.to_str().unwrap()])
        .args(SMALL)
        .envs([("PHOTON_OIDN", library.as_os_str()), ("FAILS", "1".as_ref())])
        .output()
        .unwrap();
    assert_eq!(failed.status.code(), Some(1), "{failed:?}");
    assert!(stderr(&failed).contains("it is meant to fail"), "{failed:?}");
    assert!(picture.exists());
}
