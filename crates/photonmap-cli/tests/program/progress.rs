//! Messages of the program during and after a render.

use crate::support::{folder, photonmap, render, stderr, stdout, succeeded};

/// Without a terminal there is no bar, at most a line every few seconds, and the last line names the files written.
#[test]
fn the_last_line_says_what_was_written() {
    let folder = folder("last-line");
    let (picture, report) = (folder.join("a.png"), folder.join("a.json"));
    let (picture, report) = (picture.to_str().unwrap(), report.to_str().unwrap());
    let small = ["cornell", "--size", "16x16", "--photons", "500", "--passes", "40", "--backend", "cpu"];
    let output = render(&[&small[..], &["-o", picture, "--json", report]].concat());
    succeeded(&output);
    let text = stderr(&output);
    assert!(!text.contains('\r') && !text.contains('\u{1b}'), "{text}");
    // Far fewer lines than passes.
    assert!(text.lines().count() < 12, "{text}");
    let last = text.lines().last().unwrap();
    assert!(last.starts_with(&format!("wrote {picture}, {report}: 40 passes of 500 paths in ")), "{text}");
    assert_eq!(stdout(&output), "");
}

#[test]
fn a_report_to_standard_output_stands_there_alone() {
    let folder = folder("json-stdout");
    let picture = folder.join("a.png");
    let small = ["cornell", "--size", "8x8", "--photons", "500", "--passes", "1", "--json", "-", "-o"];
    let output = render(&[&small[..], &[picture.to_str().unwrap()]].concat());
    succeeded(&output);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["passes"], 1);
}

/// Nobody reads the messages, or their disk is full: the picture is written all the same.
#[cfg(unix)]
#[test]
fn messages_that_cannot_be_written_end_nothing() {
    use std::path::Path;
    use std::process::Stdio;
    let folder = folder("nobody-reads");
    let picture = folder.join("a.png");
    let files = ["-o", picture.to_str().unwrap(), "--memory", "1GiB"];
    let small = ["--size", "16x16", "--photons", "500", "--passes", "2", "--backend", "cpu", "--exposure", "auto"];
    // Only Linux has a device that is always full.
    let full = Path::new("/dev/full");
    let sink = |what: &str| match what {
        "a full disk" => std::fs::OpenOptions::new().write(true).open(full).unwrap().into(),
        _ => Stdio::from(std::io::pipe().unwrap().1),
    };
    for what in ["a pipe that was closed", "a full disk"].into_iter().take(if full.exists() { 2 } else { 1 }) {
        let _ = std::fs::remove_file(&picture);
        let status = |arguments: &[&str]| {
            let arguments = [arguments, &small, &files].concat();
            photonmap("render").args(arguments).stderr(sink(what)).status().unwrap().code()
        };
        assert_eq!(status(&["cornell"]), Some(0), "{what}");
        assert!(picture.exists(), "{what}");
        // Errors of options and of inputs keep their code.
        assert_eq!(status(&["cornell", "--no-such-option"]), Some(2), "{what}");
        assert_eq!(status(&["none.obj"]), Some(2), "{what}");
    }
}
