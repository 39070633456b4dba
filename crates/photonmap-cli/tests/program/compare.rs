//! `photonmap compare`

use std::path::Path;

use crate::support::{folder, json, refused, render, run, stdout, succeeded};

/// An EXR file with the channels R, G and B.
fn write(path: &Path, width: usize, height: usize, pixel: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    exr::prelude::write_rgb_file(path, width, height, |x, y| {
        let [r, g, b] = pixel(x, y);
        (r, g, b)
    })
    .unwrap();
}

#[test]
fn known_differences_are_told() {
    let folder = folder("compare");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (black, white, grey, off) = (path("black.exr"), path("white.exr"), path("grey.exr"), path("off.exr"));
    write(Path::new(&black), 40, 30, |_, _| [0.0; 3]);
    write(Path::new(&white), 40, 30, |_, _| [1.0; 3]);
    write(Path::new(&grey), 40, 30, |_, _| [0.5; 3]);
    write(Path::new(&off), 40, 30, |x, y| if (x, y) == (20, 15) { [1.5; 3] } else { [0.5; 3] });
    let report = folder.join("report.json");
    let figures = |a: &str, b: &str| {
        let linear = ["--tonemap", "none", "--json", report.to_str().unwrap()];
        succeeded(&run("compare", &[&[a, b][..], &linear].concat()));
        let report = json(&report);
        // JSON has no infinity; null stands for it.
        ["relmse", "flip_mean", "flip_max"].map(|key| report[key].as_f64().unwrap_or(f64::INFINITY))
    };
    assert_eq!(figures(&grey, &grey), [0.0; 3]);
    // Computed by hand in the tests of the module.
    let [relmse, flip, _] = figures(&black, &white);
    assert!(relmse == f64::INFINITY && (flip - 0.9674).abs() < 2e-4, "{relmse} {flip}");
    let [relmse, flip, most] = figures(&grey, &off);
    let expected = 1.0 / (0.25 + 0.0025) / 1200.0;
    assert!((relmse / expected - 1.0).abs() < 1e-6, "{relmse}");
    assert!(flip > 0.001 && flip < 0.1 && most > 0.2, "{flip} {most}");

    let difference = folder.join("signed.png");
    let map = folder.join("flip.png");
    let written = ["-o", difference.to_str().unwrap(), "--flip-map", map.to_str().unwrap(), "--gain", "1"];
    let output = run("compare", &[&[grey.as_str(), &off][..], &written].concat());
    succeeded(&output);
    assert!(stdout(&output).contains("relMSE") && stdout(&output).contains("signed.png"));
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&difference).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    assert_eq!((bytes[0], bytes[3 * (15 * 40 + 20)]), (127, 255));
    assert!(map.is_file());
}

/// More photons bring a render closer to its reference, by both FLIP and relMSE.
#[test]
fn less_noise_is_a_smaller_difference() {
    let folder = folder("compare-render");
    let picture = |name: &str, passes: &str, seed: &str| {
        let path = folder.join(name).to_str().unwrap().to_owned();
        let small = ["cornell", "--size", "32x32", "--photons", "4000", "--backend", "cpu", "--passes", passes];
        succeeded(&render(&[&small[..], &["--seed", seed, "-o", &path]].concat()));
        path
    };
    let (reference, good, poor) =
        (picture("a.exr", "64", "1"), picture("b.exr", "16", "2"), picture("c.exr", "1", "3"));
    let figures = |b: &str| {
        let report: serde_json::Value =
            serde_json::from_slice(&run("compare", &[&reference, b, "--json", "-"]).stdout).unwrap();
        ["relmse", "flip_mean"].map(|key| report[key].as_f64().unwrap())
    };
    let ([better, seen_less], [worse, seen_more]) = (figures(&good), figures(&poor));
    assert!(0.0 < better && better < 0.5 * worse, "{better} {worse}");
    assert!(0.0 < seen_less && seen_less < 0.8 * seen_more, "{seen_less} {seen_more}");
}

#[test]
fn what_cannot_be_compared_is_named() {
    let folder = folder("compare-bad");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (good, small, nan, text) = (path("good.exr"), path("small.exr"), path("nan.exr"), path("text.exr"));
    write(Path::new(&good), 8, 8, |_, _| [1.0; 3]);
    write(Path::new(&small), 8, 7, |_, _| [1.0; 3]);
    write(Path::new(&nan), 8, 8, |x, y| if (x, y) == (3, 5) { [f32::NAN; 3] } else { [1.0; 3] });
    std::fs::write(&text, "no picture").unwrap();
    let nowhere = path("no/such/a.png");
    let cases: [(&[&str], &str); 9] = [
        (&[&good, &small], "8x7"),
        (&[&good, &nan], "nan.exr: the pixel in column 3 and row 5"),
        (&[&text, &good], "text.exr"),
        (&[&good, &path("gone.exr")], "gone.exr"),
        (&[&good], "B.exr"),
        (&[&good, &good, "--gain", "0"], "gain"),
        (&[&good, &good, "--pixels-per-degree", "1e9"], "pixels-per-degree"),
        (&[&good, &good, "-o", "a.jpg"], "a.jpg"),
        (&[&good, &good, "-o", &nowhere], "no/such"),
    ];
    for (arguments, culprit) in cases {
        refused(&run("compare", arguments), culprit);
    }
}
