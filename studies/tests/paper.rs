//! Runs the study of the paper.
#![expect(clippy::unwrap_used, reason = "test code")]

mod folder;

use std::process::{Command, Output};

use folder::folder;

fn paper(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_paper")).args(arguments).output().unwrap()
}

/// Cells without our own grid: four pictures, and the paper's seven columns in two interpretations.
const CELLS: usize = 4 + 2 * 7;

#[test]
fn the_paper_is_run_again_and_what_there_was_no_time_for_is_counted() {
    let out = folder("paper").join("new");
    let arguments = ["--backend", "cpu", "--scene", "ring", "--size", "16", "--repeats", "1", "--time", "2"];
    let output = paper(&[&arguments[..], &["--out", out.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text, std::fs::read_to_string(out.join("paper.md")).unwrap());
    for part in ["Errors of the paper's formulas", "20000 / 1000", "39.5 s", "Global\" read as"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let left_out = text
        .split_once(" cells left out")
        .map_or(0, |(before, _)| before.rsplit('(').next().unwrap().parse::<usize>().unwrap());
    let csv = std::fs::read_to_string(out.join("paper.csv")).unwrap();
    let mut rows = csv.lines();
    let columns = rows.next().unwrap().split(',').count();
    let rows: Vec<&str> = rows.collect();
    assert_eq!(rows.len() + left_out, CELLS, "{csv}");
    for row in rows {
        // The device's name may contain commas, within quotes.
        let bare = row.split('"').enumerate().filter(|(i, _)| i % 2 == 0).map(|(_, part)| part).collect::<String>();
        assert_eq!(bare.split(',').count(), columns, "{row}");
    }
    assert!(out.join("no-photons-cpu.png").is_file());
}

#[test]
fn the_paper_names_what_is_wrong() {
    let folder = folder("paper-bad");
    let file = folder.join("file");
    std::fs::write(&file, "").unwrap();
    let cases: [(&[&str], &str, i32); 6] = [
        (&["--scene", "no-such-scene"], "no-such-scene", 2),
        (&["--backend", "cuda"], "cuda", 2),
        (&["--size", "0"], "size", 2),
        (&["--time", "nan"], "time", 2),
        (&["--large", "7"], "large", 2),
        (&["--out", file.to_str().unwrap(), "--scene", "cornell"], "file", 1),
    ];
    for (arguments, culprit, code) in cases {
        let output = paper(arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
        assert!(text.contains(culprit), "{arguments:?}: {text}");
    }
}
