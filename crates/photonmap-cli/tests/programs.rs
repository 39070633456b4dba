//! The programs as a user meets them.
#![expect(clippy::unwrap_used, reason = "test code")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A folder of this test's own, empty.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn render(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_render")).args(arguments).output().unwrap()
}

const SMALL: [&str; 6] = ["--size", "24x16", "--photons", "3000", "--passes", "3"];

/// Channels of a file by name.
fn channels(path: &Path) -> std::collections::BTreeMap<String, Vec<f32>> {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(path).unwrap();
    let list = image.layer_data.channel_data.list;
    list.into_iter().map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn layers_of_the_exr_sum_to_the_picture_and_the_report_balances() {
    let folder = folder("layers");
    let (exr, png, json) = (folder.join("a.exr"), folder.join("a.png"), folder.join("a.json"));
    let mut arguments = vec!["cornell-glass", "-o", exr.to_str().unwrap(), "-o", png.to_str().unwrap()];
    arguments.extend(["--json", json.to_str().unwrap(), "--backend", "cpu"]);
    arguments.extend(SMALL);
    let output = render(&arguments);
    assert!(output.status.success(), "{output:?}");

    let all = channels(&exr);
    for c in ["R", "G", "B"] {
        let part = |name: &str| &all[&format!("{name}.{c}")];
        let (emission, direct, caustic, indirect) =
            (part("emission"), part("direct"), part("caustic"), part("indirect"));
        assert!(direct.iter().any(|&v| v > 0.0) && indirect.iter().any(|&v| v > 0.0));
        for (pixel, &beauty) in all[c].iter().enumerate() {
            assert_eq!(beauty, emission[pixel] + direct[pixel] + caustic[pixel] + indirect[pixel]);
        }
    }
    for name in ["depth.Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B", "error.Y"] {
        assert_eq!(all[name].len(), 24 * 16, "{name}");
    }

    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&png).unwrap()));
    let reader = decoder.read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (24, 16));

    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(report["counters"]["balance"], true);
    assert_eq!(report["counters"]["emitted"], 9000);
    assert_eq!(report["backend"], "cpu");
    assert_eq!(report["maps"]["caustic"], true);
    for stage in ["load", "bvh", "emit+trace", "build", "eye", "estimate", "total"] {
        assert!(report["seconds"][stage].as_f64().unwrap() >= 0.0, "{stage}");
    }
    assert!(report["photons_per_second"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_same_command_writes_the_same_picture() {
    let folder = folder("same");
    let picture = |name: &str, threads: &str| {
        let path = folder.join(name);
        let mut arguments = vec!["cornell", "-o", path.to_str().unwrap(), "--threads", threads];
        arguments.extend(SMALL);
        assert!(render(&arguments).status.success());
        channels(&path)
    };
    assert_eq!(picture("one.exr", "1"), picture("three.exr", "3"));
}

#[test]
fn lists_and_helps() {
    let output = render(&["--list"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for name in ["cornell", "cornell-glass", "ring", "pool", "two-rooms", "furnace", "integrating-sphere", "plates"] {
        assert!(text.lines().any(|line| line.split_whitespace().next() == Some(name)), "{name}: {text}");
    }
    assert!(render(&["--help"]).status.success());
}

#[test]
fn bad_input_is_named_with_code_2_within_seconds() {
    let folder = folder("bad");
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let missing = folder.join("missing.gltf").to_str().unwrap().to_owned();
    let cut = file("cut.glb", "glTF");
    let range = file("range.obj", "v 0 0 0\nf 1 2 3\n");
    let nan = file("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
    let dark = file("dark.obj", obj);
    let kind = file("scene.xyz", "");
    let typo = file("typo.toml", "[materialz]\n");
    let bright = file("bright.toml", "[materials.grey]\nalbedo = 2.0\n");
    let nowhere = folder.join("no/such/a.png").to_str().unwrap().to_owned();
    let cases: &[(&[&str], &str)] = &[
        (&[&missing], "missing.gltf"),
        (&[&cut], "cut.glb"),
        (&[&range], "range.obj"),
        (&[&nan], "nan.obj"),
        (&[&dark], "light"),
        (&[&kind], "scene.xyz"),
        (&["no-such-scene"], "no-such-scene"),
        (&["--overrides", &typo], "materialz"),
        (&[&dark, "--overrides", &bright], "grey"),
        (&["--camera", "nobody"], "nobody"),
        (&["-o", "picture.jpg"], "picture.jpg"),
        (&["-o", &nowhere], "no/such"),
        (&["--json", &nowhere], "no/such"),
        (&["--memory", "2 ells"], "2GiB"),
        (&["--memory", "50MiB", "--size", "512x512"], "allow more"),
        (&["--size", "0x0"], "size"),
        (&["--k", "0"], "k is 0"),
        (&["--estimator", "knn", "--k", "1"], "k is 1"),
        (&["--radius", "0"], "radius"),
        (&["--radius", "inf"], "radius"),
        (&["--photons", "0"], "photons"),
        (&["--passes", "0"], "passes"),
        (&["--time", "nan"], "time"),
        (&["--threads", "0"], "threads"),
        (&["--kernel", "box"], "kernel"),
        (&["--max-bounces", "0"], "max-bounces"),
    ];
    for (arguments, culprit) in cases {
        let begun = Instant::now();
        let output = Command::new(env!("CARGO_BIN_EXE_render")).args(*arguments).current_dir(&folder).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(culprit), "{arguments:?}: {text}");
        assert!(begun.elapsed() < Duration::from_secs(20), "{arguments:?}");
    }
}

#[test]
fn strict_refuses_what_is_approximated() {
    let folder = folder("strict");
    let path = folder.join("a.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl nothing\nf 1 2 3\n").unwrap();
    let output = render(&[path.to_str().unwrap(), "--strict"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--strict"), "{output:?}");
}

/// Ctrl-C writes what is there.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_a_valid_picture() {
    let folder = folder("interrupt");
    let (picture, json) = (folder.join("a.exr"), folder.join("a.json"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_render"))
        .args(["cornell", "--size", "32x32", "--photons", "20000", "--passes", "1000000"])
        .args(["-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap()])
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(2));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert!(child.wait().unwrap().success());
    assert!(channels(&picture)["R"].iter().all(|v| v.is_finite()));
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(report["cancelled"], true);
    assert!(report["passes"].as_u64().unwrap() >= 1);
}

/// A disk that is full, by a limit on the size of files: the picture that was there stays, nothing
/// else is left, and the message names the file.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_picture_that_was_there() {
    let folder = folder("full");
    for (name, blocks) in [("a.exr", 8), ("a.png", 1)] {
        let picture = folder.join(name);
        let command = |limit: &str, seed: &str| {
            let script = format!(
                "trap '' XFSZ; {limit} exec '{}' cornell --size 128x128 --photons 1000 --passes 1 --backend cpu --seed {seed} -o '{}'",
                env!("CARGO_BIN_EXE_render"),
                picture.display()
            );
            Command::new("sh").args(["-c", &script]).output().unwrap()
        };
        assert!(command("", "1").status.success());
        let before = std::fs::read(&picture).unwrap();
        // In blocks of 512 bytes or of 1024, by the shell.
        let output = command(&format!("ulimit -f {blocks};"), "2");
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {text}");
        assert!(text.contains(name) && text.contains("cannot be written"), "{text}");
        assert!(std::fs::read(&picture).unwrap() == before, "{name}");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2, "nothing else is left");
}

/// Killed at any moment: what has its name is whole.
#[cfg(unix)]
#[test]
fn a_kill_leaves_no_half_picture() {
    let folder = folder("kill");
    let picture = folder.join("a.exr");
    for milliseconds in [20, 150, 300, 450] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_render"))
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

/// A cap on memory that is below what the photons asked for would take.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_capped_and_the_photons_are_all_there() {
    let folder = folder("memory");
    let (picture, json) = (folder.join("a.png"), folder.join("a.json"));
    let cap = 96 << 20;
    let output = render(&[
        "cornell",
        "--size",
        "64x64",
        "--photons",
        "1500k",
        "--passes",
        "1",
        "--backend",
        "cpu",
        "--threads",
        "2",
        "--memory",
        &cap.to_string(),
        "-o",
        picture.to_str().unwrap(),
        "--json",
        json.to_str().unwrap(),
    ]);
    assert!(output.status.success(), "{output:?}");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let number = |key: &str| report[key].as_u64().unwrap();
    assert!(number("peak_resident_bytes") <= cap, "{}", number("peak_resident_bytes"));
    assert_eq!(report["bytes_of_photon_in_map"]["global"], 28, "{report:#}");
    assert!(number("paths_per_pass") < 1_500_000 && number("paths") >= 1_500_000, "{report:#}");
}

/// Every reason is told, and nothing is rendered.
#[test]
fn explain_tells_what_is_left_out() {
    let folder = folder("explain");
    let program =
        Command::new(env!("CARGO_BIN_EXE_render")).args(["cornell", "--explain"]).current_dir(&folder).output();
    let output = program.unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let (needed, left_out) = text.split_once("left out:").unwrap();
    assert!(output.status.success() && needed.contains("area-lights") && needed.contains("shadow rays"), "{text}");
    assert!(needed.contains("colours of photons") && left_out.contains("directions of photons"), "{text}");
    assert!(left_out.contains("mirror") && left_out.contains("map of caustic photons"), "{text}");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
}

/// A light that hardly any photon leaves from is named, in words and in the report.
#[test]
fn lights_that_get_too_few_photons_are_named() {
    let folder = folder("starving");
    let (picture, json) = (folder.join("a.png"), folder.join("a.json"));
    let paths = [picture.to_str().unwrap(), json.to_str().unwrap()];
    for (photons, starves) in [("2000", false), ("100", true)] {
        let all = ["ring", "--size", "8x8", "--passes", "1", "--backend", "cpu", "--photons", photons];
        let output = render(&[all.as_slice(), &["-o", paths[0], "--json", paths[1]]].concat());
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(text.contains("warning: spot light"), starves, "{text}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(report["lights"][1]["starves"], serde_json::Value::Bool(starves), "{report:#}");
        assert_eq!(report["warnings"].as_array().unwrap().is_empty(), !starves);
    }
}

/// A .npy file of float32.
fn save(path: &Path, points: &[[f32; 3]]) {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 3), }}", points.len());
    while (11 + header.len()) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(points.iter().flatten().flat_map(|x| x.to_le_bytes()));
    std::fs::write(path, bytes).unwrap();
}

fn load(path: &Path) -> (String, Vec<u32>) {
    let bytes = std::fs::read(path).unwrap();
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    (String::from_utf8_lossy(&bytes[10..end]).into_owned(), bytes[end..].chunks(4).map(word).collect())
}

#[test]
fn map_only_finds_what_brute_force_finds() {
    let folder = folder("map");
    // Coordinates on a coarse grid: many photons are equally far from a query.
    let point = |i: u32| [i % 7, i / 7 % 5, i / 35 % 3].map(|c| c as f32 * 0.25);
    let photons: Vec<_> = (0..200).map(point).collect();
    let queries: Vec<_> = (0..20).map(|i| point(i * 11 + 3).map(|c| c + 0.05)).collect();
    let (p, q, out, json) =
        (folder.join("p.npy"), folder.join("q.npy"), folder.join("out.npy"), folder.join("out.json"));
    save(&p, &photons);
    save(&q, &queries);
    let run = |backend: &str, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_map_only"));
        command.args(["--backend", backend]);
        command
            .arg("--photons")
            .arg(&p)
            .arg("--queries")
            .arg(&q)
            .arg("--neighbours")
            .arg(&out)
            .arg("--json")
            .arg(&json);
        let output = command.args(arguments).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(report["backend"], backend);
        assert!(report["seconds_build"].is_number() && report["seconds_query"].is_number());
        load(&out)
    };
    let sorted = |query: &[f32; 3], reach: f32| {
        let mut all: Vec<(f32, u32)> = photons
            .iter()
            .zip(0..)
            .map(|(photon, id)| {
                let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| photon[axis] - query[axis]);
                (x * x + y * y + z * z, id)
            })
            .filter(|(square, _)| *square <= reach * reach)
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all
    };
    let all = ["cpu", "vulkan"].into_iter().filter(|&backend| backend == "cpu" || has_vulkan());
    let cases = all.flat_map(|backend| ["median", "vvh", "morton"].map(|index| (backend, index)));
    for (backend, index) in cases {
        for (k, reach) in [(10, f32::INFINITY), (10, 0.3), (300, f32::INFINITY)] {
            let (k_text, reach_text) = (k.to_string(), reach.to_string());
            let mut arguments = vec!["--k", &k_text, "--index", index];
            if reach.is_finite() {
                arguments.extend(["--max-radius", &reach_text]);
            }
            let (header, found) = run(backend, &arguments);
            assert!(header.contains("<u4") && header.contains(&format!("({}, {k})", queries.len())), "{header}");
            for (query, row) in queries.iter().zip(found.chunks(k)) {
                let mut expected: Vec<u32> = sorted(query, reach).into_iter().map(|(_, id)| id).take(k).collect();
                expected.resize(k, u32::MAX);
                assert_eq!(row, expected, "{backend} {index} {k} {reach}");
            }
        }
        let (header, counts) = run(backend, &["--radius", "0.4", "--index", index]);
        assert!(header.contains("(20,)"), "{header}");
        for (query, count) in queries.iter().zip(counts) {
            assert_eq!(count as usize, sorted(query, 0.4).len());
        }
    }
}

/// Whether some device will do; says so if not.
fn has_vulkan() -> bool {
    let there = backend_vulkan::devices().is_ok_and(|found| found.iter().any(|device| device.lacks.is_empty()));
    if !there {
        let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
        assert!(!required, "Vulkan is required here");
        eprintln!("skipped: no Vulkan");
    }
    there
}

#[test]
fn map_only_names_what_is_wrong() {
    let folder = folder("map-bad");
    let (good, nan, bad) = (folder.join("good.npy"), folder.join("nan.npy"), folder.join("bad.npy"));
    save(&good, &[[0.0; 3]]);
    save(&nan, &[[0.0; 3], [f32::NAN; 3]]);
    std::fs::write(&bad, b"no array").unwrap();
    let good = good.to_str().unwrap();
    let cases: [(&Path, &[&str], &str); 6] = [
        (&bad, &["--k", "1"], "bad.npy"),
        (&nan, &["--k", "1"], "point 1"),
        (&folder.join("gone.npy"), &["--k", "1"], "gone.npy"),
        (Path::new(good), &["--k", "0"], "k is 0"),
        (Path::new(good), &["--radius", "inf"], "radius"),
        (Path::new(good), &[], "--k"),
    ];
    for (photons, arguments, culprit) in cases {
        let output = Command::new(env!("CARGO_BIN_EXE_map_only"))
            .args(["--photons", photons.to_str().unwrap(), "--queries", good])
            .args(arguments)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(culprit), "{culprit}: {text}");
    }
}

#[test]
fn a_foreign_caster_gives_the_same_picture() {
    let output = Command::new(env!("CARGO_BIN_EXE_own_caster"))
        .args(["cornell", "--size", "48", "--photons", "5000", "--passes", "3"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
}

/// Lights with all that another renderer needs of them, and as many triangles as the files have.
#[test]
fn an_exported_scene_is_whole() {
    let folder = folder("export");
    let export = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_export")).args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let to = folder.to_str().unwrap();
    assert_eq!(export(&["ring", "--out", to]), (Some(0), String::new()));
    let told: serde_json::Value = serde_json::from_slice(&std::fs::read(folder.join("scene.json")).unwrap()).unwrap();
    let spots = told["lights"].as_array().unwrap().iter().filter(|light| light["kind"] == "spot");
    for spot in spots.clone() {
        let [inner, outer] = [0, 1].map(|i: usize| spot["cone"][i].as_f64().unwrap());
        assert!(0.0 <= inner && inner <= outer && outer <= std::f64::consts::PI, "{spot}");
    }
    assert!(spots.count() > 0);
    for material in told["materials"].as_array().unwrap() {
        let file = std::fs::read(folder.join(material["file"].as_str().unwrap())).unwrap();
        let header = String::from_utf8_lossy(&file[..file.len().min(200)]).into_owned();
        assert!(header.contains(&format!("element face {}\n", material["triangles"])), "{header}");
    }
    let (code, text) = export(&["no-such-scene", "--out", to]);
    assert!(code == Some(2) && text.contains("no-such-scene"), "{text}");
    let (code, text) = export(&["ring", "--size", "0", "--out", to]);
    assert!(code == Some(2) && text.contains("0x0"), "{code:?} {text}");
}
