//! The study of error against time as a user runs it: measured in parts, assembled afterwards.
#![expect(clippy::unwrap_used, reason = "test code")]

use std::path::Path;
use std::process::{Command, Output};

fn tradeoff(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tradeoff")).args(arguments).output().unwrap()
}

#[test]
fn parts_of_several_calls_become_one_document() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tradeoff");
    let _ = std::fs::remove_dir_all(&folder);
    let (out, document) = (folder.to_str().unwrap(), folder.join("accuracy.md"));
    let small = ["--backend", "cpu", "--size", "6", "--photons", "400", "--out", out];
    let rates = ["--part", "rates", "--rate-passes", "64", "--rate-side", "4"];
    let claims = ["furnace", "--part", "claims", "--claim-seeds", "2"];
    for part in [&rates[..], &claims[..]] {
        let output = tradeoff(&[&small[..], part].concat());
        assert!(output.status.success(), "{output:?}");
    }
    let output = tradeoff(&["--assemble", out, "--document", document.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(document.with_file_name("accuracy-claims.md")).unwrap();
    let rows = std::fs::read_to_string(document.with_file_name("accuracy-rows.csv")).unwrap();
    assert!(rows.starts_with("scene,knob,value,passes,"), "{rows}");
    assert!(std::fs::read_to_string(document).unwrap().contains("(accuracy-claims.md)"));
    for expected in ["| bump of 0.7 | 0.67 | bias² | 2 to 64 |", "| furnace | 64 | 2 |"] {
        assert!(text.contains(expected), "{expected} in\n{text}");
    }
    assert!(std::fs::read_to_string(folder.join("rates.svg")).unwrap().ends_with("</svg>\n"));
}

#[test]
fn nothing_to_assemble_is_said() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tradeoff-empty");
    std::fs::create_dir_all(&folder).unwrap();
    let output = tradeoff(&["--assemble", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("holds no results"), "{output:?}");
}
