//! Film files: interrupted renders, job arrays, refusals.

use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use crate::support::{channels, folder, photonmap, refused, run, stderr, stdout, succeeded};

const SETTINGS: [&str; 8] = ["cornell", "--size", "16x12", "--photons", "2000", "--backend", "cpu", "--errors"];

/// Renders into a film file, and writes a picture beside it.
fn render(film: &Path, options: &[&str]) -> Output {
    let picture = film.with_extension("exr");
    let files = ["--film", film.to_str().unwrap(), "-o", picture.to_str().unwrap()];
    photonmap("render").args(SETTINGS).args(files).args(options).output().unwrap()
}

fn film(path: &Path) -> photon_core::Film {
    photon_film::load(path).unwrap().0
}

/// Killed several times at arbitrary moments, the file is whole whenever it is looked at, and the render ends with the film
/// and the picture of one that was left alone.
#[cfg(unix)]
#[test]
fn a_killed_render_ends_with_the_same_bits() {
    let folder = folder("film-kill");
    let (alone, killed) = (folder.join("alone.film"), folder.join("killed.film"));
    let options = ["--passes", "36", "--grain", "3", "--checkpoint", "0s"];
    succeeded(&render(&alone, &options));
    let mut before = 0;
    for kill in 0..4 {
        let mut child = photonmap("render")
            .args(SETTINGS)
            .args(["--film", killed.to_str().unwrap(), "-o", folder.join("killed.exr").to_str().unwrap()])
            .args(options)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Until there is a new block, then for a moment that differs from kill to kill, such as within a write.
        let begun = Instant::now();
        let mut passes = before;
        while passes <= before && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
            passes = if killed.exists() { film(&killed).passes } else { 0 };
        }
        std::thread::sleep(Duration::from_millis(3 * kill));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = film(&killed);
        assert!(found.passes > before && found.passes.is_multiple_of(3), "{}", found.passes);
        before = found.passes;
    }
    assert!(before < 36, "the last kill came too late");
    let output = render(&killed, &options);
    succeeded(&output);
    assert!(stderr(&output).contains("killed.film: continued after"), "{}", stderr(&output));
    assert!(film(&killed) == film(&alone));
    assert!(channels(&folder.join("killed.exr")) == channels(&folder.join("alone.exr")));
    // Complete: nothing is rendered, and the pictures are written again.
    let output = render(&killed, &options);
    succeeded(&output);
    assert!(stderr(&output).contains("has all passes already"), "{}", stderr(&output));
    assert!(film(&killed) == film(&alone));
}

/// A job array of one block a job, and more passes later, give the film of a single render; its picture is that of the
/// render.
#[test]
fn a_job_array_is_a_single_render() {
    let folder = folder("film-array");
    let names = ["one", "a", "b", "out"].map(|name| folder.join(name).with_extension("film"));
    let [one, a, b, out] = &names;
    let paths = names.each_ref().map(|path| path.to_str().unwrap());
    succeeded(&render(one, &["--passes", "8", "--grain", "4"]));
    // Without -o there is no picture.
    let job =
        photonmap("render").args(SETTINGS).args(["--passes", "4..8", "--grain", "4", "--film", paths[2]]).output();
    succeeded(&job.unwrap());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "two films and a picture");
    succeeded(&render(a, &["--passes", "0..4", "--grain", "4"]));
    let merged = run("merge", &[paths[3], paths[2], paths[1]]);
    succeeded(&merged);
    assert!(stderr(&merged).contains("8 passes of 2 films (0..8)") && !stderr(&merged).contains("note"), "{merged:?}");
    assert!(film(out) == film(one));
    // A film of an array can be continued, too.
    let json = folder.join("a.json");
    succeeded(&render(a, &["--passes", "8", "--grain", "4", "--json", json.to_str().unwrap()]));
    assert!(film(a) == film(one));
    // The report has the photons of this run, and of the whole film.
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let of_film = &report["film"];
    assert_eq!((report["passes"].as_u64(), report["counters"]["emitted"].as_u64()), (Some(4), Some(8000)));
    assert_eq!((of_film["passes"].as_u64(), of_film["passes_counted"].as_u64()), (Some(8), Some(8)));
    assert_eq!(of_film["counters"]["emitted"].as_u64(), Some(16000));
    assert_eq!(of_film["counters"]["balance"].as_bool(), Some(true));

    let picture = folder.join("picture.exr");
    succeeded(&run("picture", &[paths[3], "-o", picture.to_str().unwrap()]));
    assert!(channels(&picture) == channels(&folder.join("one.exr")));
    let png = folder.join("picture.png");
    succeeded(&run("picture", &[paths[3], "-o", png.to_str().unwrap(), "--exposure", "auto"]));
    assert!(png.exists());
    let info = run("info", &[paths[3]]);
    let text = stdout(&info);
    for part in ["cornell", "16x12", "0..8 (8 in all)", "2000 paths", "grain        4", "cpu on", "shadow_rays = 2"] {
        assert!(text.contains(part), "{part}: {text}");
    }

    // Of all jobs together.
    assert!(text.contains("16000 emitted: ") && !text.contains("WRONG"), "{text}");
    assert!(stdout(&run("info", &[paths[2]])).contains("8000 emitted: "));

    refused(&run("merge", &[paths[3], paths[0], paths[2]]), "b.film: passes 4..8 of seed 0");
    refused(&run("picture", &[paths[3], "-o", "out.jpg"]), "out.jpg");
    std::fs::write(b, b"not a film").unwrap();
    refused(&run("merge", &[paths[3], paths[0], paths[2]]), "b.film: is not a whole film file");
    refused(&run("info", &[paths[2]]), "b.film");
    assert!(film(out) == film(one), "refused merges leave the file");
}

/// A target error ends a render into a film, at the same pass if it is continued; `merge` and `info` say how many passes are
/// missing.
#[test]
fn a_film_ends_at_a_target_error() {
    let folder = folder("film-target");
    let [alone, part, more] = ["alone", "part", "more"].map(|name| folder.join(name).with_extension("film"));
    let target = ["--target-error", "0.16", "--share", "0.9"];
    let blocks = ["--grain", "2"];
    succeeded(&render(&alone, &[&blocks[..], &target].concat()));
    let expected = film(&alone);
    assert!(expected.passes > 8 && expected.passes < 100, "{}", expected.passes);
    succeeded(&render(&part, &[&blocks[..], &["--passes", "6"]].concat()));
    let output = render(&part, &[&blocks[..], &target].concat());
    succeeded(&output);
    assert!(stderr(&output).contains("predicted: ") && stderr(&output).contains("result: after"), "{output:?}");
    assert!(film(&part) == expected);
    // Reached: nothing is rendered.
    let output = render(&part, &[&blocks[..], &target].concat());
    assert!(stderr(&output).contains(": 0 passes") && film(&part) == expected, "{output:?}");

    let name = part.to_str().unwrap();
    let missing = |output: std::process::Output| {
        succeeded(&output);
        stdout(&output).lines().last().unwrap().parse::<u32>().unwrap()
    };
    assert_eq!(missing(run("info", &[&[name][..], &target].concat())), 0);
    // Half of the error takes several times as many passes; a job array renders them.
    let half = ["--target-error", "0.08", "--share", "0.9"];
    let needed = missing(run("info", &[&[name][..], &half].concat()));
    assert!(needed >= expected.passes && needed.is_multiple_of(2), "{needed}");
    let range = format!("{}..{}", expected.passes, expected.passes + 2);
    succeeded(&render(&more, &[&blocks[..], &["--passes", &range]].concat()));
    let both = [alone.to_str().unwrap(), name, more.to_str().unwrap()];
    let after = missing(run("merge", &[&both[..], &half].concat()));
    assert!(after > 0 && film(&alone).passes == expected.passes + 2, "{after}");
    refused(&run("info", &[name, "--target-error", "0"]), "target-error");
    refused(&run("info", &[name, "--share", "0.5"]), "--target-error");
}

/// What does not fit a film, or cannot be continued with the same bits, is refused by name and leaves the file as it is.
#[test]
fn what_does_not_fit_is_refused() {
    let folder = folder("film-refused");
    let path = folder.join("a.film");
    succeeded(&render(&path, &["--passes", "4", "--grain", "2"]));
    let before = std::fs::read(&path).unwrap();
    let cases: [(&[&str], &str); 13] = [
        (&["--time", "5"], "--time: "),
        (&["--target-error", "0.1"], "its grain is 2, not 1"),
        (&["--target-error", "0", "--grain", "2"], "target-error"),
        (&["--bandwidth", "per-pixel"], "--bandwidth shared"),
        (&["--passes", "5", "--grain", "2"], "multiple of the grain"),
        (&["--passes", "8", "--grain", "0"], "grain is 0"),
        (&["--passes", "8", "--grain", "4"], "its grain is 2, not 4"),
        (&["--passes", "8", "--grain", "2", "--shadow-rays", "3"], "its setting shadow_rays is 2, not 3"),
        (&["--passes", "8", "--grain", "2", "--aperture", "0.1", "--focus", "3"], "its camera"),
        (&["--passes", "8", "--grain", "2", "--environment", "constant"], "its scene is cornell, digest "),
        (&["--passes", "8", "--grain", "2", "--seed", "1"], "one seed"),
        (&["--passes", "4..8", "--grain", "2"], "first of the passes"),
        (&["--passes", "2", "--grain", "2"], "more passes than are asked for"),
    ];
    for (options, culprit) in cases {
        refused(&render(&path, options), culprit);
    }
    // Fewer photons than asked for would be another film.
    let many = ["render", "cornell", "--size", "16x12", "--backend", "cpu", "--photons", "900k", "--memory", "60MB"];
    refused(&run(many[0], &[&many[1..], &["--film", path.to_str().unwrap()]].concat()), "give --photons");
    assert!(std::fs::read(&path).unwrap() == before);
    refused(&render(&folder.join("a.npz"), &[]), "ends in .film");
    let half = folder.join("half.film");
    std::fs::write(&half, &before[..before.len() / 2]).unwrap();
    refused(&render(&half, &["--passes", "8"]), "half.film: is not a whole film file");
}

/// A full disk at a checkpoint, simulated by a limit on file size: the previous film stays, rendering goes on, and the
/// picture is written.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_film_that_was_there() {
    let folder = folder("film-full");
    let (film, picture) = (folder.join("a.film"), folder.join("a.png"));
    succeeded(&render(&film, &["--passes", "2"]));
    let before = std::fs::read(&film).unwrap();
    // In blocks of 512 bytes or of 1024, depending on the shell: enough for the picture alone.
    let script = format!(
        "ulimit -f 4; exec '{}' render {} --passes 4 --checkpoint 0s --film '{}' -o '{}'",
        env!("CARGO_BIN_EXE_photonmap"),
        SETTINGS.join(" "),
        film.display(),
        picture.display()
    );
    let output = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("warning: ") && text.contains("rendering goes on"), "{text}");
    assert!(!text.contains("ZipWriter"), "{text}");
    assert!(text.lines().last().is_some_and(|line| line.contains("a.film: cannot be written")), "{text}");
    assert!(std::fs::read(&film).unwrap() == before && picture.exists());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "nothing else is left");
}
