//! Files are written atomically; errors name those that are read.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::support::{channels, folder, photonmap, refused, render};

/// Ctrl-C writes the picture so far.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_a_valid_picture() {
    let folder = folder("interrupt");
    let (picture, json) = (folder.join("a.exr"), folder.join("a.json"));
    let mut child = photonmap("render")
        .args(["cornell", "--size", "32x32", "--photons", "20000", "--passes", "1000000"])
        .args(["-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap()])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The first progress line comes after some passes, even on a busy machine.
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.starts_with("pass ")));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let last = lines.last().unwrap();
    assert!(last.starts_with("wrote ") && last.ends_with("interrupted"), "{last}");
    assert!(child.wait().unwrap().success());
    assert!(channels(&picture)["R"].iter().all(|v| v.is_finite()));
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(report["cancelled"], true);
    assert!(report["passes"].as_u64().unwrap() >= 1);
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
                "trap '' XFSZ; {limit} exec '{}' render cornell --size 128x128 --photons 1000 --passes 1 --backend cpu --seed {seed} -o '{}'",
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

/// What is found only when the scene is built names its file too.
#[test]
fn an_invalid_material_is_named_with_its_file() {
    let folder = folder("invalid-material");
    std::fs::write(folder.join("a.mtl"), "newmtl glow\nKe -1 0 0\n").unwrap();
    let scene = folder.join("a.obj");
    std::fs::write(&scene, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glow\nf 1 2 3\n").unwrap();
    let output = render(&[scene.to_str().unwrap(), "-o", folder.join("a.png").to_str().unwrap()]);
    refused(&output, &format!("{}: material 'glow': emission is", scene.display()));
}
