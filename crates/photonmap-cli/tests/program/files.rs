//! Files are written atomically; errors name those that are read.

use std::io::{BufRead, BufReader, Read as _};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::{channels, folder, passes, photonmap, refused, render};

/// Ctrl-C, and the signals by which clusters and terminals end programs, write the picture so far; the exit code says that
/// it is not the one that was asked for. Only a hangup that the user has disabled changes nothing.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_a_valid_picture() {
    let folder = folder("interrupt");
    for (signal, before) in [("INT", ""), ("TERM", ""), ("HUP", ""), ("INT", "trap '' HUP;")] {
        let (picture, json) = (folder.join("a.exr"), folder.join("a.json"));
        let _ = std::fs::remove_file(&picture);
        let script = format!("{before} exec \"$@\"");
        let mut child = Command::new("sh")
            .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_photonmap"), "render"])
            .args(["cornell", "--size", "16x16", "--photons", "2000", "--time", "300", "--backend", "cpu"])
            .args(["-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap(), "--serve", "127.0.0.1:0"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
        let address =
            lines.find_map(|line| Some(line.strip_prefix("watch at http://")?.trim_end_matches('/').to_owned()));
        // A first pass, even on a busy machine.
        while passes(address.as_ref().unwrap()) == 0 {
            std::thread::sleep(Duration::from_millis(20));
        }
        let process = child.id().to_string();
        let send = |signal: &str| Command::new("kill").args([&format!("-{signal}"), &process]).status();
        if !before.is_empty() {
            assert!(send("HUP").unwrap().success());
            std::thread::sleep(Duration::from_millis(100));
        }
        assert!(child.try_wait().unwrap().is_none() && !picture.exists(), "it goes on");
        assert!(send(signal).unwrap().success());
        // `timeout` sends two, too. It may have ended.
        let _ = send("HUP");
        let last = lines.last().unwrap();
        assert!(last.starts_with("wrote ") && last.ends_with("interrupted"), "{last}");
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(channels(&picture)["R"].iter().all(|v| v.is_finite()));
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(report["cancelled"], true);
        assert!(report["passes"].as_u64().unwrap() >= 1);
    }
}

/// Every command that reads a file says what it was given if that is no such file, and what to do.
#[test]
fn files_of_other_kinds_are_named() {
    let folder = folder("kinds");
    let file = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).unwrap();
        folder.join(name).to_str().unwrap().to_owned()
    };
    for (bytes, expected) in [
        (&b"version https://git-lfs.github.com/spec/v1\n"[..], "Git LFS pointer; fetch the file with `git lfs pull`"),
        (b"<!DOCTYPE html>\n<html>", "an HTML page; download the file itself"),
        (b"", "is empty; copy, download or export it again"),
    ] {
        let [glb, stl, hdr, film, exr, npy] =
            ["glb", "stl", "hdr", "film", "exr", "npy"].map(|ext| file(&format!("a.{ext}"), bytes));
        for command in [
            &["explain", &glb][..],
            &["explain", &stl],
            &["explain", "cornell", "--environment", &hdr],
            &["info", &film],
            &["picture", &film, "-o", "a.png"],
            &["compare", &exr, &exr],
            &["map", "--k", "2", "--queries", &npy, "--photons", &npy],
        ] {
            refused(&photonmap(command[0]).args(&command[1..]).output().unwrap(), expected);
        }
    }
    let output = photonmap("compare").args([file("a.exr", b"\x89PNG\r\n"), file("b.exr", b"")]).output().unwrap();
    refused(&output, "a.exr: is a PNG picture, not an OpenEXR picture");
}

/// While a scene is loaded there is nothing to write: the program ends at once, with a line.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_while_loading_ends_at_once() {
    let folder = folder("interrupt-loading");
    let (scene, picture) = (folder.join("large.obj"), folder.join("a.png"));
    // Loading takes seconds.
    let vertices = (0..400_000).map(|i| format!("v {} {} {}\n", i % 631, i / 631, i % 97));
    let faces = (1..399_000).map(|i| format!("f {i} {} {}\n", i + 1, i + 632));
    std::fs::write(&scene, vertices.chain(faces).collect::<String>()).unwrap();
    for (signal, command) in [("INT", "render"), ("TERM", "render"), ("HUP", "explain")] {
        let mut program = photonmap(command);
        program.arg(&scene).args(["--backend", "cpu"]);
        if command == "render" {
            program.arg("-o").arg(&picture);
        }
        let mut child = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let process = child.id().to_string();
        // Until it handles SIGINT, which is signal 2.
        let handles = || {
            let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
            let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
            u64::from_str_radix(caught.trim(), 16).unwrap() & 2 != 0
        };
        while !handles() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let begun = Instant::now();
        assert!(Command::new("kill").args([&format!("-{signal}"), &process]).status().unwrap().success());
        let mut text = String::new();
        child.stderr.take().unwrap().read_to_string(&mut text).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}: {text}");
        assert_eq!(text, "interrupted while loading; nothing was written\n", "{signal}");
        assert!(begun.elapsed() < Duration::from_secs(5) && !picture.exists(), "{signal}");
    }
}

/// Every output is tried, and all that fail are named; here for lack of space, which no check finds beforehand.
#[cfg(unix)]
#[test]
fn an_output_that_fails_does_not_prevent_others() {
    let folder = folder("tried");
    let path = |name: &str| folder.join(name).display().to_string();
    let script = format!(
        "ulimit -f 40; exec '{}' render cornell --size 64x64 --photons 1000 --passes 1 --backend cpu --film '{}' \
         -o '{}' -o '{}' -o '{}' --json -",
        env!("CARGO_BIN_EXE_photonmap"),
        path("a.film"),
        path("large.exr"),
        path("small.png"),
        path("larger.exr")
    );
    // Larger than the limit are the film and the EXR files; the signal of the limit would end the program.
    let output = Command::new("sh").args(["-c", &script]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    for name in ["a.film", "large.exr", "larger.exr"] {
        let error = format!("error: {}: cannot be written", path(name));
        assert_eq!(text.lines().filter(|line| line.starts_with(&error)).count(), 1, "{name}: {text}");
    }
    assert!(!text.contains("ZipWriter"), "{text}");
    assert!(text.contains(&format!("wrote {}: 1 pass", path("small.png"))), "{text}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["passes"], 1);
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "nothing else is left");
}

/// A full disk, simulated by a limit on file size: the previous picture stays, nothing
/// else is left, and the message names the file.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_picture_that_was_there() {
    let folder = folder("full");
    for (name, blocks) in [("a.exr", 8), ("a.png", 1)] {
        let picture = folder.join(name);
        let command = |limit: &str, seed: &str| {
            let script = format!(
                "{limit} exec '{}' render cornell --size 128x128 --photons 1000 --passes 1 --backend cpu --seed {seed} -o '{}'",
                env!("CARGO_BIN_EXE_photonmap"),
                picture.display()
            );
            Command::new("sh").args(["-c", &script]).output().unwrap()
        };
        assert!(command("", "1").status.success());
        let before = std::fs::read(&picture).unwrap();
        // In blocks of 512 bytes or of 1024, depending on the shell.
        let output = command(&format!("ulimit -f {blocks};"), "2");
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {text}");
        assert!(text.contains(name) && text.contains("cannot be written"), "{text}");
        assert!(std::fs::read(&picture).unwrap() == before, "{name}");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2, "nothing else is left");
}

/// Killed at any moment: a file under the final name is complete.
#[cfg(unix)]
#[test]
fn a_kill_leaves_no_half_picture() {
    let folder = folder("kill");
    let picture = folder.join("a.exr");
    for milliseconds in [20, 150, 300, 450] {
        let mut child = photonmap("render")
            .args(["cornell", "--size", "400x400", "--photons", "100", "--passes", "1", "--backend", "cpu"])
            .args(["-o", picture.to_str().unwrap()])
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        let _ = child.kill();
        child.wait().unwrap();
        if picture.exists() {
            assert_eq!(channels(&picture)["R"].len(), 160_000);
        }
    }
}

/// An error that is found only when the scene is built names both files that it may come from.
#[test]
fn an_invalid_material_is_named_with_its_files() {
    let folder = folder("invalid-material");
    let [scene, overrides] = ["a.obj", "a.toml"].map(|name| folder.join(name).display().to_string());
    std::fs::write(&scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glow\nf 1 2 3\n").unwrap();
    std::fs::write(&overrides, "[materials.glow]\nemission = -1\n").unwrap();
    let picture = folder.join("a.png").display().to_string();
    let output = render(&[&scene, "--overrides", &overrides, "-o", &picture]);
    refused(&output, &format!("{scene} with {overrides}: material 'glow': emission is"));
}
