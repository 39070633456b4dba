//! Selection of backends by programs, and their messages without Vulkan.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::support::{channels, folder, photonmap, refused, stderr};

/// `render` with one environment variable set.
fn render(arguments: &[&str], variable: (&str, &Path)) -> Output {
    let mut command = photonmap("render");
    command.args(arguments).env_remove("PHOTON_VK_DEVICE").env(variable.0, variable.1).output().unwrap()
}

/// Ways to disable Vulkan for a program: a variable, its value, and what the error must mention.
#[cfg(target_os = "linux")]
fn obstacles(folder: &Path) -> Vec<(&'static str, PathBuf, &'static str)> {
    // A file of that name which is not a library: the dynamic linker fails on it.
    std::fs::write(folder.join("libvulkan.so.1"), "").unwrap();
    std::fs::write(folder.join("libvulkan.so"), "").unwrap();
    let mut all = vec![("LD_LIBRARY_PATH", folder.to_owned(), "loader")];
    // The following cases need a loader, and the last one a driver.
    match backend_vulkan::devices() {
        Err(error) => eprintln!("skipped: no Vulkan: {error}"),
        Ok(_) => {
            all.push(("VK_ICD_FILENAMES", folder.join("no.json"), "driver"));
            all.push(("PHOTON_VK_DEVICE", PathBuf::from("no such card"), "no such card"));
        }
    }
    all
}

#[cfg(target_os = "linux")]
#[test]
fn vulkan_that_is_not_there_is_an_error_with_a_hint() {
    let folder = folder("no-vulkan");
    for (variable, value, culprit) in obstacles(&folder) {
        let output = render(&["cornell", "--backend", "vulkan"], (variable, &value));
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{variable}: {text}");
        assert!(text.contains(culprit) && text.contains("CPU backend") | text.contains("--backend cpu"), "{text}");
        assert_eq!(text.lines().filter(|line| line.starts_with("error")).count(), 1, "{text}");
        // A device that cannot be selected by its variable does not prevent the list.
        if culprit != "no such card" {
            for mut list in [photonmap("devices"), photonmap("render")] {
                if list.get_args().last().is_some_and(|name| name == "render") {
                    list.arg("--devices");
                }
                let output = list.env_remove("PHOTON_VK_DEVICE").env(variable, &value).output().unwrap();
                refused(&output, culprit);
            }
        }
    }
}

/// The smallest render that gives a picture.
const SMALL: [&str; 7] = ["cornell", "--size", "8x8", "--photons", "500", "--passes", "1"];

#[test]
fn auto_says_in_one_line_what_it_took() {
    let folder = folder("auto-line");
    let picture = folder.join("a.png");
    let json = folder.join("a.json");
    let files = ["-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap()];
    let output = photonmap("render").args(SMALL).args(files).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = stderr(&output);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("backend: ")).collect();
    let [line] = lines.as_slice() else { panic!("{text}") };
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let taken = report["backend"].as_str().unwrap();
    assert!(line.starts_with(&format!("backend: {taken}")) && line.contains(", since "), "{line}");
}

/// By number, and by a part of the name in any case; an error names a number that does not exist.
#[test]
fn a_device_is_chosen_by_number_or_name() {
    let suitable = |found: Vec<backend_vulkan::Candidate>| found.into_iter().find(|device| device.lacks.is_empty());
    let Some(device) = backend_vulkan::devices().ok().and_then(suitable) else {
        return eprintln!("skipped: no Vulkan");
    };
    let folder = folder("chosen");
    let (picture, json) = (folder.join("a.png"), folder.join("a.json"));
    let files = ["--backend", "vulkan", "-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap()];
    let arguments = [&SMALL[..], &files[..]].concat();
    let part: String = device.name.chars().take(5).collect();
    for wanted in [device.index.to_string(), part.to_uppercase()] {
        let output = render(&arguments, ("PHOTON_VK_DEVICE", Path::new(&wanted)));
        assert!(output.status.success(), "{wanted}: {output:?}");
        assert!(stderr(&output).contains(&format!("backend: vulkan on {}", device.name)), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert!(report["device"].as_str().unwrap().starts_with(&device.name), "{report}");
    }
    let output = render(&arguments, ("PHOTON_VK_DEVICE", Path::new("99")));
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(stderr(&output).contains("PHOTON_VK_DEVICE: there is no device '99'; number 0 is "), "{output:?}");
}

/// Two devices of one kind (the same one twice) make the picture of one, bit by bit, and the report names them.
#[test]
fn several_devices_make_the_picture_of_one() {
    let suitable = |found: Vec<backend_vulkan::Candidate>| found.into_iter().find(|device| device.lacks.is_empty());
    let Some(device) = backend_vulkan::devices().ok().and_then(suitable) else {
        return eprintln!("skipped: no Vulkan");
    };
    let folder = folder("devices");
    let json = folder.join("a.json");
    let run = |devices: &str, options: &[&str]| {
        let picture = folder.join("a.exr");
        let files = ["-o", picture.to_str().unwrap(), "--json", json.to_str().unwrap(), "--device", devices];
        let settings = ["--size", "16x12", "--photons", "2000", "--passes", "8"];
        let output = photonmap("render").arg("cornell").args(settings).args(files).args(options).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        (channels(&picture), report)
    };
    let one = device.index.to_string();
    let (both, report) = run(&format!("{one},{one}"), &[]);
    assert!(report["device"].as_str().unwrap().starts_with(&format!("2 × {}", device.name)), "{report}");
    assert_eq!((report["grain"].as_u64(), report["passes"].as_u64()), (Some(2), Some(8)));
    assert!(run(&one, &["--grain", "2"]).0 == both);
}

/// What does not go together with several devices, or with blocks, is refused by name before anything is rendered.
#[test]
fn impossible_devices_are_refused() {
    let refuse = |options: &[&str], culprit: &str| {
        let output = photonmap("render").args(SMALL).args(options).output().unwrap();
        refused(&output, culprit);
    };
    refuse(&["--device", "0,0", "--time", "3"], "--time");
    refuse(&["--device", "all", "--bandwidth", "per-pixel", "--errors"], "--bandwidth per-pixel");
    refuse(&["--device", "0,0", "--memory", "2GiB"], "--memory");
    refuse(&["--device", "0", "--backend", "cpu"], "--device");
    refuse(&["--device", "0,,1"], "a name is empty");
    refuse(&["--grain", "2"], "grain 2");
    refuse(&["--device", "nonsense"], "--device nonsense");
}

/// Compiled pipelines are cached in the user's cache folder. A damaged cache file is replaced,
/// and a folder that is not writable does not matter.
#[test]
fn compiled_pipelines_are_kept_and_damage_is_survived() {
    if !backend_vulkan::devices().is_ok_and(|found| found.iter().any(|device| device.lacks.is_empty())) {
        return eprintln!("skipped: no Vulkan");
    }
    let folder = folder("cache");
    let picture = folder.join("a.png");
    let arguments = [&SMALL[..], &["--backend", "vulkan", "-o", picture.to_str().unwrap()]].concat();
    let drivers = folder.join("drivers");
    let run = |cache: &Path| {
        let mut program = photonmap("render");
        // The software driver's own cache is no part of this, and compiling without it takes long.
        program.args(&arguments).env("XDG_CACHE_HOME", cache).env("MESA_SHADER_CACHE_DIR", &drivers);
        let output = program.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        std::fs::read(&picture).unwrap()
    };
    let first = run(&folder);
    let kept = || -> Vec<PathBuf> {
        std::fs::read_dir(folder.join("photon-mapping")).unwrap().map(|entry| entry.unwrap().path()).collect()
    };
    let [file] = &kept()[..] else { panic!("{:?}", kept()) };
    let whole = std::fs::read(file).unwrap();
    for damaged in [&whole[..whole.len() / 2], b"", &[0xFF; 4096]] {
        std::fs::write(file, damaged).unwrap();
        assert_eq!(run(&folder), first);
        assert_ne!(std::fs::read(file).unwrap(), damaged);
        assert_eq!(kept().len(), 1);
    }
    assert_eq!(run(&picture), first);
}

#[cfg(target_os = "linux")]
#[test]
fn auto_goes_on_without_vulkan_and_says_so() {
    let folder = folder("auto");
    let picture = folder.join("a.png");
    for (variable, value, _) in obstacles(&folder) {
        let small = ["--size", "8x8", "--photons", "500", "--passes", "1", "-o", picture.to_str().unwrap()];
        let arguments: Vec<&str> = std::iter::once("cornell").chain(small).collect();
        let output = render(&arguments, (variable, &value));
        let text = stderr(&output);
        assert!(output.status.success(), "{variable}: {text}");
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("backend: ")).collect();
        assert!(lines.len() == 1 && lines[0].starts_with("backend: cpu, since "), "{variable}: {text}");
    }
}

#[test]
fn devices_are_listed_with_what_they_lack() {
    let known = match backend_vulkan::devices() {
        Ok(known) => known,
        Err(error) => return eprintln!("skipped: no Vulkan: {error}"),
    };
    let output = photonmap("devices").output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(text.lines().count(), known.len());
    for (line, device) in text.lines().zip(&known) {
        assert!(line.contains(&device.name) && line.contains(device.kind), "{line}");
        assert_eq!(line.ends_with("suitable"), device.lacks.is_empty(), "{line}");
    }
}

#[test]
fn a_picture_is_the_same_on_either_backend() {
    if !backend_vulkan::devices().is_ok_and(|found| found.iter().any(|device| device.lacks.is_empty())) {
        let required = std::env::var_os("PHOTON_REQUIRE_VULKAN").is_some_and(|value| value != "0");
        assert!(!required, "Vulkan is required here");
        return eprintln!("skipped: no Vulkan");
    }
    let folder = folder("either");
    let picture = |backend: &str| {
        let (exr, json) = (folder.join(format!("{backend}.exr")), folder.join(format!("{backend}.json")));
        let output = photonmap("render")
            .args(["cornell-glass", "--backend", backend, "--size", "24x24", "--photons", "5000", "--passes", "2"])
            .args(["-o", exr.to_str().unwrap(), "--json", json.to_str().unwrap()])
            // Where the validation layer is installed, the loader enables it; it writes to standard output.
            .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
            .env("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT")
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        assert!(!String::from_utf8_lossy(&output.stdout).contains("Validation"), "{output:?}");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(report["backend"], backend);
        assert_eq!(report["counters"]["balance"], true);
        // On either backend, by the clock of the device: every stage that ran, and their sum is at most the total.
        let seconds = |stage: &str| report["seconds"][stage].as_f64().unwrap();
        let stages = ["emit+trace", "build", "eye", "direct", "estimate", "film"].map(seconds);
        assert!(stages.iter().all(|&seconds| seconds > 0.0), "{backend}: {report}");
        assert!(stages.iter().sum::<f64>() <= seconds("total"), "{backend}: {report}");
        use exr::prelude::*;
        let image = read_first_flat_layer_from_file(&exr).unwrap();
        let channels = image.layer_data.channel_data.list.into_iter();
        let beauty = channels.filter(|channel| ["R", "G", "B"].contains(&channel.name.to_string().as_str()));
        beauty.flat_map(|channel| channel.sample_data.values_as_f32().collect::<Vec<_>>()).collect::<Vec<f32>>()
    };
    let (cpu, vulkan) = (picture("cpu"), picture("vulkan"));
    // Equal random numbers give equal paths, except for the few that rounding sends to the other side of an
    // edge: those change the mean of the absolute differences by far less than a hundredth.
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let apart: Vec<f32> = cpu.iter().zip(&vulkan).map(|(a, b)| (a - b).abs()).collect();
    assert_eq!(cpu.len(), 3 * 24 * 24);
    assert!(mean(&apart) < 0.01 * mean(&cpu), "{} of {}", mean(&apart), mean(&cpu));
    // The comparison must be able to fail: it does for a picture that is shifted by some pixels.
    let shifted: Vec<f32> = cpu.iter().zip(cpu.iter().skip(3)).map(|(a, b)| (a - b).abs()).collect();
    assert!(mean(&shifted) > 0.01 * mean(&cpu));
}
