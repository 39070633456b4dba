//! Lists, explanations, help, completions and the manual.

use crate::support::{folder, photonmap, refused, run, stdout, succeeded};

const COMMANDS: [&str; 9] =
    ["render", "map", "scenes", "devices", "explain", "compare", "export", "completions", "man"];

#[test]
fn scenes_are_listed() {
    for output in [run("scenes", &[]), run("render", &["--list"])] {
        succeeded(&output);
        let text = stdout(&output);
        for name in [
            "cornell",
            "cornell-glass",
            "ring",
            "pool",
            "prism",
            "rainbow",
            "fog",
            "glass-fog",
            "milk",
            "cloud",
            "textures",
            "gloss",
            "frosted-glass",
            "many-lights",
            "sky",
            "two-rooms",
            "furnace",
            "integrating-sphere",
            "plates",
        ] {
            assert!(text.lines().any(|line| line.split_whitespace().next() == Some(name)), "{name}: {text}");
        }
    }
}

#[test]
fn every_command_has_help() {
    let all = stdout(&run("--help", &[]));
    for command in COMMANDS {
        assert!(all.contains(command), "{command}: {all}");
        let (short, long) = (run(command, &["-h"]), run(command, &["--help"]));
        succeeded(&short);
        assert!(stdout(&long).len() >= stdout(&short).len() && stdout(&short).contains("Usage: photonmap"));
    }
    // Without a command, and with an unknown one.
    assert_eq!(photonmap("nonsense").output().unwrap().status.code(), Some(2));
}

/// Every reason is printed, and nothing is rendered.
#[test]
fn explain_tells_what_is_left_out() {
    let folder = folder("explain");
    for arguments in [["explain", "cornell"].as_slice(), &["render", "cornell", "--explain"]] {
        let output = photonmap(arguments[0]).args(&arguments[1..]).current_dir(&folder).output().unwrap();
        succeeded(&output);
        let text = stdout(&output);
        let (needed, left_out) = text.split_once("left out:").unwrap();
        assert!(needed.contains("area-lights") && needed.contains("shadow rays"), "{text}");
        assert!(needed.contains("colours of photons") && left_out.contains("directions of photons"), "{text}");
        assert!(left_out.contains("mirror") && left_out.contains("map of caustic photons"), "{text}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }
    // With a time it also tells what is decided, and why.
    let timed = stdout(&run("explain", &["cornell", "--time", "9", "--size", "40x30", "--backend", "cpu"]));
    let lines: Vec<&str> = timed.lines().skip_while(|line| !line.starts_with("settings: ")).collect();
    assert!(lines.len() == 3 && lines[1].starts_with("because 0 % of the pixels show caustics"), "{timed}");
    assert!(lines[2].starts_with("as options: --photons 4800 --area surface"), "{timed}");
    assert!(
        timed.contains("of 4800 paths a pass")
            && !stdout(&run("explain", &["cornell", "--passes", "4"])).contains("because ")
    );
    // Glossy surfaces have a hint how to do without them.
    let gloss = stdout(&run("explain", &["gloss"]));
    let line = gloss.lines().find(|line| line.trim_start().starts_with("glossy ")).unwrap();
    assert!(line.contains("11524 triangles") && line.contains("kind = \"lambert\""), "{gloss}");
    // Settings are taken into account.
    let gather = stdout(&run("explain", &["cornell", "--indirect", "gather", "--photons", "1234"]));
    assert!(gather.contains("1234 paths a pass") && gather != stdout(&run("explain", &["cornell"])), "{gather}");
    refused(&run("explain", &["no-such-scene"]), "no-such-scene");
    refused(&run("explain", &["cornell", "--camera", "nobody"]), "nobody");
}

#[test]
fn completions_name_every_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = run("completions", &[shell]);
        succeeded(&output);
        let text = stdout(&output);
        for command in COMMANDS {
            assert!(text.contains(command), "{shell} {command}");
        }
        assert!(text.contains("target-error"), "{shell}");
        // The other shells do not complete values.
        assert_eq!(text.contains("per-pixel"), ["bash", "zsh", "fish"].contains(&shell), "{shell}");
    }
    refused(&run("completions", &["tcsh"]), "bash");
}

#[test]
fn the_manual_names_every_command() {
    // Without the escape sequences of roff.
    let page = |arguments: &[&str]| {
        let output = run("man", arguments);
        succeeded(&output);
        stdout(&output).replace('\\', "")
    };
    let all = page(&[]);
    assert!(all.contains(".TH photonmap 1"), "{all}");
    for command in COMMANDS {
        assert!(all.contains(&format!("photonmap-{command}(1)")), "{command}: {all}");
        let one = page(&[command]);
        assert!(one.contains(&format!(".TH photonmap-{command} 1")), "{one}");
    }
    let render = page(&["render"]);
    assert!(render.contains(".SH \"DENSITY ESTIMATION\"") && render.contains("free scale factor"), "{render}");
    refused(&run("man", &["nonsense"]), "nonsense");
}
