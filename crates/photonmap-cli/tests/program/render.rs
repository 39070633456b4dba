//! `photonmap render`: pictures, reports, errors.

use std::time::{Duration, Instant};

use photonmap_cli::exposure::Exposure;
use photonmap_cli::tonemap::{self, ToneMap};

use crate::support::{SMALL, channels, folder, photonmap, refused, render, stderr, succeeded};

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
    for stage in [
        "load",
        "device",
        "prepare",
        "bvh",
        "project",
        "pipelines",
        "pilot",
        "emit+trace",
        "build",
        "eye",
        "estimate",
        "total",
    ] {
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
        (&[&kind], "scene.xyz"),
        (&["no-such-scene"], "no-such-scene"),
        (&[""], "'' names no scene"),
        (&["..", "-o", "a.png"], "'..' names no scene"),
        (&["--radius-factor", "1e308"], "radius-factor is 1e308,"),
        (&["--overrides", &typo], "materialz"),
        (&[&dark, "--overrides", &bright], "grey"),
        (&["--camera", "nobody"], "nobody"),
        (&["-o", "picture.jpg"], "picture.jpg"),
        (&["--index", "grid"], "vvh"),
        (&["--estimator", "grid"], "knn"),
        (&["--preset", "best"], "balanced"),
        (&["--caustic-photons", "many"], "shared"),
        (&["-o", &nowhere], "no/such"),
        (&["--json", &nowhere], "no/such"),
        (&["--memory", "2 ells"], "2GiB"),
        (&["--memory", "50MiB", "--size", "512x512", "--backend", "cpu"], "allow more"),
        (&["--size", "0x0"], "size"),
        (&["--k", "0"], "k is 0"),
        (&["--estimator", "knn", "--k", "1"], "k is 1"),
        (&["--radius", "0"], "radius"),
        (&["--radius", "inf"], "radius"),
        (&["--photons", "0"], "photons"),
        (&["--passes", "0"], "passes"),
        (&["--time", "nan"], "time"),
        (&["--exposure", "nan"], "exposure"),
        (&["--exposure", "bright"], "auto"),
        (&["--aperture", "0.1"], "--focus"),
        (&["--focus", "1"], "--aperture"),
        (&["--aperture", "-0.1", "--focus", "1"], "diameter of its lens is -0.1"),
        (&["--aperture", "nan", "--focus", "1"], "diameter of its lens is NaN"),
        (&["--aperture", "0.1", "--focus", "0"], "distance of its focus is 0"),
        (&["--threads", "0"], "threads"),
        (&["--kernel", "box"], "kernel"),
        (&["--max-bounces", "0"], "max-bounces"),
    ];
    for (arguments, culprit) in cases {
        let begun = Instant::now();
        let output = photonmap("render").args(*arguments).current_dir(&folder).output().unwrap();
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
    // What is dropped when the scene is prepared, too.
    let path = folder.join("b.ply");
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 0 1\n";
    std::fs::write(&path, text).unwrap();
    refused(&render(&[path.to_str().unwrap(), "--strict"]), "the warnings above");
}

/// A memory limit below what the requested photons would take.
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

/// The header of a texture tells that it does not fit, before its data is read: this one has none.
#[cfg(target_os = "linux")]
#[test]
fn textures_beyond_the_memory_are_named() {
    let folder = folder("large-texture");
    std::fs::write(folder.join("wood.hdr"), "#?RADIANCE\n\n-Y 4096 +X 4096\n").unwrap();
    std::fs::write(folder.join("a.mtl"), "newmtl wood\nmap_Kd wood.hdr\n").unwrap();
    let scene = folder.join("a.obj");
    std::fs::write(&scene, "mtllib a.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let output = render(&[scene.to_str().unwrap(), "--size", "8x8", "--backend", "cpu", "--memory", "500MB"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    for part in ["a.obj: map_Kd wood.hdr of material 'wood' (4096 × 4096 texels)", "allow more memory"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// A light with hardly any photons is named, in a warning and in the report.
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

/// Paths that are cut are a warning that names the remedy, and are in the report; where none is, there is neither.
#[test]
fn cut_paths_are_told() {
    let folder = folder("cut-paths");
    let (picture, json) = (folder.join("a.png"), folder.join("a.json"));
    let paths = [picture.to_str().unwrap(), json.to_str().unwrap()];
    for (max_bounces, cuts) in [("1", true), ("1024", false)] {
        let all = ["cornell-glass", "--size", "16x16", "--passes", "1", "--backend", "cpu", "--photons", "100"];
        let output =
            render(&[all.as_slice(), &["--max-bounces", max_bounces, "-o", paths[0], "--json", paths[1]]].concat());
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(text.contains("light beyond is missing: raise --max-bounces"), cuts, "{text}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        let count = |of: &serde_json::Value| of["counters"]["truncated_camera_paths"].as_u64().unwrap();
        assert_eq!(count(&report) > 0, cuts, "{report:#}");
    }
}

/// A grey triangle before an even environment of radiance 1: where it covers a pixel, its radiance is its albedo.
#[test]
fn transparent_pictures_have_the_alpha_of_their_format() {
    let folder = folder("transparent");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    std::fs::write(path("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let scene = ["a.obj", "--environment", "constant", "--backend", "cpu", "--size", "16x16", "--passes", "8"];
    let run = |more: &[&str]| {
        let output = photonmap("render").args(scene).args(more).current_dir(&folder).output().unwrap();
        succeeded(&output);
        stderr(&output)
    };
    let printed = run(&["--transparent", "--exposure", "auto", "-o", "a.exr", "-o", "a.png"]);
    run(&["-o", "b.exr"]);
    let (with, without) = (channels(&folder.join("a.exr")), channels(&folder.join("b.exr")));
    assert!(!without.contains_key("A"));
    let alpha = &with["A"];
    assert!(alpha.contains(&0.0) && alpha.contains(&1.0) && alpha.iter().any(|&a| a > 0.0 && a < 1.0), "{alpha:?}");
    for (pixel, &alpha) in alpha.iter().enumerate() {
        // The environment is what is missing, and nothing else.
        let (found, opaque) = (with["R"][pixel], without["R"][pixel]);
        assert!((found - (opaque - (1.0 - alpha))).abs() < 1e-5, "{pixel}: {found} {opaque} {alpha}");
    }
    let mean = with["R"].iter().sum::<f32>() / alpha.iter().sum::<f32>();
    assert!((mean - 0.5).abs() < 0.05, "{mean}");
    // About from the radiance 0.5 to 18 %; noise lowers a mean of logarithms.
    let stops: f32 = printed.split("a.png: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((stops - (0.18_f32 / 0.5).log2()).abs() < 0.5, "{printed}");

    // Colours of a PNG are not premultiplied.
    let straight = |pixel: usize| if alpha[pixel] > 0.0 { with["R"][pixel] / alpha[pixel] } else { 0.0 };
    let colours: Vec<[f32; 3]> = (0..alpha.len()).map(|pixel| [straight(pixel); 3]).collect();
    let exposure = Exposure::Auto.stops(&colours);
    let mut reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(folder.join("a.png")).unwrap()))
        .read_info()
        .unwrap();
    assert_eq!(reader.info().color_type, png::ColorType::Rgba);
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    for (pixel, &[red, green, blue, opacity]) in bytes.as_chunks().0.iter().enumerate() {
        let expected = tonemap::map(ToneMap::Neutral, exposure, colours[pixel]).map(tonemap::encode);
        let found = [red, green, blue];
        assert!(found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{pixel}: {found:?} {expected:?}");
        assert_eq!(opacity, (alpha[pixel] * 255.0 + 0.5) as u8);
    }
}

/// What was decided is reported as options, which make the same picture bit by bit.
#[test]
fn decided_settings_can_be_given() {
    let folder = folder("decided");
    let picture = |scene: &str, name: &str, options: &[&str]| {
        let (exr, json) = (folder.join(format!("{name}.exr")), folder.join(format!("{name}.json")));
        let files = ["-o", exr.to_str().unwrap(), "--json", json.to_str().unwrap()];
        let always = [scene, "--size", "40x30", "--backend", "cpu", "--seed", "7"];
        let output = render(&[&always[..], &files, options].concat());
        succeeded(&output);
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        (channels(&exr), report, stderr(&output))
    };
    // Radii per pixel and more shadow rays; a preset, with what is given.
    for (scene, asked) in [("ring", &["--time", "3"][..]), ("cornell", &["--preset", "balanced", "--area", "disc"])] {
        let (found, report, said) = picture(scene, "decided", asked);
        // There are none where passes had to have fewer paths, on a very busy machine.
        let options = report["decided"]["options"].as_str().unwrap_or_else(|| panic!("{said}"));
        assert!(said.contains(options.split_once(" --passes").unwrap().0), "{said}");
        let (again, report, _) =
            picture(scene, "given", &options.split(' ').chain(asked[2..].iter().copied()).collect::<Vec<_>>());
        assert!(found == again, "{options}");
        assert!(report["decided"].is_null());
    }
}
