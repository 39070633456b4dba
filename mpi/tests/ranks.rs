//! Real processes on this host: one film for any number of ranks, resumed after a kill.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives};
use photon_core::{Film, PassSet, Units};
use photonmap_mpi::Sums;

fn mpirun(ranks: usize, program: &str) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", &ranks.to_string(), program]);
    command.env("OMPI_MCA_btl", "self,tcp,vader").env("OMPI_MCA_rmaps_base_oversubscribe", "1");
    command
}

const SCENE: [&str; 12] = [
    "cornell-glass",
    "--size",
    "13x7",
    "--photons",
    "2000",
    "--backend",
    "cpu",
    "--threads",
    "1",
    "--errors",
    "--grain",
    "2",
];

fn render(ranks: usize, film: &Path, options: &[&str]) -> Command {
    let mut command = mpirun(ranks, env!("CARGO_BIN_EXE_photonmap-mpi"));
    command.args(SCENE).args(["--film", film.to_str().unwrap(), "-o", film.with_extension("exr").to_str().unwrap()]);
    command.args(options);
    command
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn film(path: &Path) -> Film {
    photon_film::load(path).unwrap().0
}

/// The film of one process by the library, and that of 1 to 4 ranks, in one run and in two; seven blocks, so that the last
/// round is not full.
#[test]
fn any_number_of_ranks_makes_the_film_of_one_process() {
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.film");
    let args = [&["render"], &SCENE[..], &["--film", alone.to_str().unwrap(), "--passes", "14"]].concat();
    photonmap_cli::command::render::run(&clap::Parser::parse_from(args)).unwrap();
    let expected = film(&alone);
    assert_eq!(expected.passes, 14);
    for ranks in 1..=4 {
        let path = folder.path().join(format!("{ranks}.film"));
        if ranks == 3 {
            let output = render(2, &path, &["--passes", "4"]).output().unwrap();
            assert!(output.status.success() && film(&path).passes == 4, "{}", text(&output));
        }
        let output = render(ranks, &path, &["--passes", "14"]).output().unwrap();
        assert!(output.status.success(), "{ranks} ranks: {}", text(&output));
        assert!(film(&path) == expected, "{ranks} ranks");
        // Complete: the picture is written again.
        std::fs::remove_file(path.with_extension("exr")).unwrap();
        assert!(render(ranks, &path, &["--passes", "14"]).output().unwrap().status.success());
        assert!(path.with_extension("exr").exists() && film(&path) == expected);
    }
}

/// A target error ends the job at the pass of one process, whose film has the same bits; continued between two examinations,
/// too.
#[test]
fn any_number_of_ranks_stops_at_the_same_error() {
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.film");
    let target = ["--target-error", "0.2", "--share", "0.95"];
    let args = [&["render"], &SCENE[..], &["--film", alone.to_str().unwrap()], &target].concat();
    photonmap_cli::command::render::run(&clap::Parser::parse_from(args)).unwrap();
    let expected = film(&alone);
    assert!(expected.passes > 8 && expected.passes < 200, "{}", expected.passes);
    for ranks in 1..=3 {
        let path = folder.path().join(format!("{ranks}.film"));
        if ranks == 3 {
            assert!(render(2, &path, &["--passes", "10"]).output().unwrap().status.success());
        }
        for run in ["first", "again"] {
            let output = render(ranks, &path, &target).output().unwrap();
            assert!(output.status.success(), "{ranks} ranks, {run}: {}", text(&output));
            assert!(text(&output).contains("result: after"), "{}", text(&output));
            assert!(film(&path) == expected, "{ranks} ranks, {run}: {} of {}", film(&path).passes, expected.passes);
        }
    }
}

/// Without a name, there is a picture named after the scene; names that cannot be written are refused before rendering, by one
/// line of rank 0.
#[test]
fn pictures_are_checked_first_and_have_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let run = |options: &[&str]| {
        let mut command = mpirun(2, env!("CARGO_BIN_EXE_photonmap-mpi"));
        command.args([
            "cornell",
            "--size",
            "8",
            "--passes",
            "2",
            "--photons",
            "500",
            "--backend",
            "cpu",
            "--threads",
            "1",
        ]);
        command.args(options).current_dir(folder.path()).output().unwrap()
    };
    let output = run(&[]);
    assert!(output.status.success() && text(&output).contains("wrote cornell.png: 2 passes"), "{}", text(&output));
    assert!(folder.path().join("cornell.png").exists());
    for (name, why) in [("none/x.png", "there is no folder none"), ("x.jpg", "ends in .exr or .png")] {
        let output = run(&["-o", name]);
        let said = text(&output);
        assert!(output.status.code() == Some(2) && said.contains(why) && !said.contains("interrupted"), "{said}");
    }
}

/// Killed, the job leaves whole films, and the next one ends with the same bits.
#[test]
fn a_killed_job_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (alone, killed) = (folder.path().join("alone.film"), folder.path().join("killed.film"));
    assert!(render(1, &alone, &["--passes", "40"]).output().unwrap().status.success());
    let options = ["--passes", "40", "--checkpoint", "0s"];
    let mut child = render(2, &killed, &options).stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !killed.exists() && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let passes = film(&killed).passes;
    assert!((4..40).contains(&passes) && passes.is_multiple_of(4), "{passes}");
    // Ranks of the killed job may write one more checkpoint.
    std::thread::sleep(Duration::from_millis(500));
    let output = render(3, &killed, &options).output().unwrap();
    assert!(output.status.success(), "{}", text(&output));
    assert!(film(&killed) == film(&alone));
}

/// A terminated process writes its passes and its picture, and exits with 130.
#[test]
fn a_terminated_job_keeps_its_passes() {
    let folder = tempfile::tempdir().unwrap();
    let (path, options) = (folder.path().join("kept.film"), ["--set", "seed=3", "--passes", "1000000"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_photonmap-mpi"));
    command.args(SCENE).args(options).args(["--film", path.to_str().unwrap(), "-o"]).arg(path.with_extension("exr"));
    let child = command.args(["--checkpoint", "1h"]).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(3));
    assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output));
    assert!(film(&path).passes > 0 && path.with_extension("exr").exists());
}

/// A pass of some seconds is abandoned if there is a film, which keeps the passes before.
#[test]
fn a_terminated_job_abandons_its_pass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.film");
    let start = |passes: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_photonmap-mpi"));
        command.args(["cornell-glass", "--size", "128", "--photons", "2000", "--backend", "cpu", "--threads", "1"]);
        command.args(["--set", "shadow-rays=1024", "--passes", passes]);
        command.args(["--film", path.to_str().unwrap(), "-o", "kept.exr"]).current_dir(folder.path());
        command.stderr(Stdio::piped()).spawn().unwrap()
    };
    let begun = Instant::now();
    assert!(start("1").wait().unwrap().success());
    assert!(begun.elapsed() > Duration::from_secs(3), "the second pass would end before the signal");
    let child = start("2");
    std::thread::sleep(Duration::from_millis(1500));
    assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output));
    assert!(text(&output).contains("wrote") && film(&path).passes == 1, "{}", text(&output));
}

#[test]
fn wrong_options_are_named_and_nobody_waits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    for (options, culprit) in [
        (&["--time", "3"][..], "--time"),
        (&["--passes", "3"], "grain 2"),
        (&["--passes", "4", "--grain", "0"], "grain"),
        (&["--passes", "4", "--overrides", "missing.toml"], "missing.toml"),
        (&["--passes", "4", "--nonsense"], "--nonsense"),
    ] {
        let output = render(2, &path, options).output().unwrap();
        assert!(!output.status.success() && text(&output).contains(culprit), "{options:?}: {}", text(&output));
        assert!(!text(&output).contains("panicked"), "{}", text(&output));
    }
    assert!(render(2, &path, &["--passes", "4"]).output().unwrap().status.success());
    let output = render(2, &path, &["--passes", "8", "--photons", "2001"]).output().unwrap();
    assert!(!output.status.success() && text(&output).contains("photons"), "{}", text(&output));
}

const WORKER: &str = "PHOTONMAP_MPI_WORKER";

/// Blocks of two rounds, summed in small portions by three ranks; a rank without pixels; and, as a control, sums of each
/// rank's blocks that MPI adds, which have other bits.
#[test]
fn sums_have_a_fixed_order() {
    if std::env::var_os(WORKER).is_some() {
        return sums_on_ranks();
    }
    let own = std::env::current_exe().unwrap();
    let mut command = mpirun(3, own.to_str().unwrap());
    let output = command.args(["--exact", "sums_have_a_fixed_order", "--nocapture"]).env(WORKER, "1").output().unwrap();
    assert!(output.status.success(), "{}{}", String::from_utf8_lossy(&output.stdout), text(&output));
}

/// A film with values that do not add exactly; the first has negative zeros.
fn block(number: usize, pixels: u32) -> Film {
    let mut film = Film::new(pixels, 1, Units::default()).unwrap();
    for (index, pixel) in film.pixels.iter_mut().enumerate() {
        let value = ((index * 7 + number * 13) % 31) as f64;
        pixel.layers = [[1.0 / (1.0 + value), value * 0.1, -0.0]; 4];
        pixel.square = value.sqrt();
        pixel.hits = value as u64;
    }
    film.passes = 1;
    film.contains = PassSet::of(0, number as u32..number as u32 + 1);
    film
}

fn sums_on_ranks() {
    let universe = mpi::initialize().unwrap();
    let world = universe.world();
    let rank = world.rank() as usize;
    for (pixels, words) in [(100, 1 << 20), (100, 64), (2, 64)] {
        let mut expected = block(0, pixels);
        (1..5).for_each(|number| expected.merge(&block(number, pixels)).unwrap());
        let mut sums = Sums::in_portions(&world, pixels as usize, false, words);
        sums.add(Some(&block(rank, pixels)), 3);
        // The second round has two blocks.
        let second = (rank < 2).then(|| block(3 + rank, pixels));
        sums.add(second.as_ref(), 2);
        let empty = || (rank == 0).then(|| Film::new(pixels, 1, Units::default()).unwrap());
        let film = sums.gather(empty(), &expected.contains);
        let bits = |film: &Film| -> Vec<u64> {
            film.pixels.iter().flat_map(|p| p.layers.concat().into_iter().chain([p.square])).map(f64::to_bits).collect()
        };
        if let Some(film) = &film {
            assert_eq!(bits(film), bits(&expected), "{pixels} pixels");
            assert!(*film == expected);
        }
        // Distributed again, and continued.
        let mut again = Sums::in_portions(&world, pixels as usize, false, words);
        again.scatter(film.as_ref());
        again.add((rank == 0).then(|| block(5, pixels)).as_ref(), 1);
        expected.merge(&block(5, pixels)).unwrap();
        if let Some(film) = again.gather(empty(), &expected.contains) {
            assert_eq!(bits(&film), bits(&expected), "continued, {pixels} pixels");
        }
    }
    // Control: each rank adds its own blocks first.
    let mut own = block(rank, 100);
    [3, 4, 5]
        .into_iter()
        .filter(|number| number % 3 == rank)
        .for_each(|number| own.merge(&block(number, 100)).unwrap());
    let mine: Vec<f64> = own.pixels.iter().map(|pixel| pixel.layers[0][0]).collect();
    let mut all = vec![0.0; mine.len()];
    world.all_reduce_into(&mine[..], &mut all[..], SystemOperation::sum());
    let mut expected = block(0, 100);
    (1..6).for_each(|number| expected.merge(&block(number, 100)).unwrap());
    assert!(all.iter().zip(&expected.pixels).any(|(sum, pixel)| *sum != pixel.layers[0][0]), "the control is the same");
}
