//! `--environment`, and environments in override files.

use std::f64::consts::PI;
use std::path::Path;

use photon_core::glam::Vec3;
use photon_scene::{EnvironmentDesc, Sun};

use crate::support::{channels, folder, json, refused, render, run, stdout, succeeded};

const ALBEDO: f64 = 0.6;

/// Writes a plate in the plane y = 0, without any light, and a file with a camera above it.
fn plate(folder: &Path) -> [String; 2] {
    let text = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    text("plate.mtl", &format!("newmtl plate\nKd {ALBEDO} {ALBEDO} {ALBEDO}\n"));
    let camera = "[[cameras]]\nname = \"above\"\nfrom = [0, 1, 0]\nto = [0, 0, 0]\nup = [0, 0, -1]\nfov_degrees = 40\n";
    [
        text("plate.obj", "mtllib plate.mtl\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nusemtl plate\nf 1 2 3 4\n"),
        text("camera.toml", camera),
    ]
}

/// Mean radiance of a picture of the plate.
fn mean(folder: &Path, scene: &[&str]) -> [f64; 3] {
    let picture = folder.join("plate.exr");
    let small = ["--size", "64x64", "--photons", "1000", "--passes", "16", "--shadow-rays", "4", "--backend", "cpu"];
    succeeded(&render(&[scene, &small, &["-o", picture.to_str().unwrap()]].concat()));
    let all = channels(&picture);
    ["R", "G", "B"].map(|name| all[name].iter().map(|&v| f64::from(v)).sum::<f64>() / all[name].len() as f64)
}

fn close(found: [f64; 3], truth: [f64; 3]) -> bool {
    (0..3).all(|c| (found[c] - truth[c]).abs() <= 0.01 * truth[c])
}

/// A plate under an even environment of radiance L has the radiance albedo · L, and under another albedo / π times the
/// irradiance on the horizontal plane: of a gradient in closed form, of sky and sun integrated here.
#[test]
fn a_plate_shows_its_irradiance() {
    let folder = folder("environment-plate");
    let [obj, camera] = plate(&folder);
    let scene = [obj.as_str(), "--overrides", &camera];
    let under = |arguments: &[&str]| mean(&folder, &[&scene, arguments].concat());
    let even = under(&["--environment", "constant:1,1,1"]);
    assert!(close(even, [ALBEDO; 3]), "{even:?}");
    assert!(!close(even, [1.03 * ALBEDO; 3]), "{even:?}");
    let scaled = under(&["--environment", "constant:1,2,0.5", "--environment-scale", "2"]);
    assert!(close(scaled, [2.0, 4.0, 1.0].map(|c| c * ALBEDO)), "{scaled:?}");

    // The radiance 1 + 0.9 d·ω, times the cosine, over the hemisphere: π (1 + 0.6 d·n). Without any light it is the default.
    let lit = 4.0 / 29.0_f64.sqrt();
    for arguments in [&["--environment", "gradient"][..], &[]] {
        let gradient = under(arguments);
        assert!(close(gradient, [ALBEDO * (1.0 + 0.6 * lit); 3]), "{gradient:?}");
    }

    let baked = EnvironmentDesc::sky(30.0, 3.0).bake().unwrap();
    let Sun { direction, irradiance, .. } = baked.sun.unwrap();
    let mut truth = irradiance.map(|c| -direction[1] * c);
    let (rows, columns) = (400, 800);
    for row in 0..rows {
        let theta = 0.5 * PI * (f64::from(row) + 0.5) / f64::from(rows);
        let weight = theta.cos() * theta.sin() * (0.5 * PI / f64::from(rows)) * (2.0 * PI / f64::from(columns));
        for column in 0..columns {
            let phi = 2.0 * PI * f64::from(column) / f64::from(columns);
            let to = [phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin()].map(|c| c as f32);
            let radiance = baked.map.radiance(Vec3::from(to)).to_array();
            truth = std::array::from_fn(|c| truth[c] + weight * f64::from(radiance[c]));
        }
    }
    let truth = truth.map(|c| c * ALBEDO / PI);
    let sky = under(&["--environment", "sky:30,3", "--environment-rotate", "123"]);
    assert!(close(sky, truth), "{sky:?} {truth:?}");
}

/// An environment of the command line replaces that of the override file, with its sun; what was used is in the report
/// and in the header.
#[test]
fn the_command_line_has_precedence() {
    let folder = folder("environment-precedence");
    let [obj, camera] = plate(&folder);
    let text = std::fs::read_to_string(&camera).unwrap();
    let sky = folder.join("sky.toml");
    std::fs::write(&sky, format!("{text}\n[environment]\nsky = {{ elevation = 40, turbidity = 2 }}\n")).unwrap();
    let scene = [obj.as_str(), "--overrides", sky.to_str().unwrap()];
    let given = ["--environment", "constant:0.25", "--environment-rotate=-90"];
    let found = mean(&folder, &[&scene[..], &given].concat());
    assert!(close(found, [0.25 * ALBEDO; 3]), "{found:?}");

    let (picture, report) = (folder.join("a.exr"), folder.join("a.json"));
    let files = ["-o", picture.to_str().unwrap(), "--json", report.to_str().unwrap()];
    let small = ["--size", "8x8", "--photons", "1000", "--passes", "1", "--backend", "cpu"];
    for (arguments, expected) in
        [(&given[..], Some("constant:0.25,0.25,0.25, rotated by -90 degrees")), (&[], Some("sky:40,2"))]
    {
        succeeded(&render(&[&scene[..], arguments, &small, &files].concat()));
        assert_eq!(json(&report)["environment"].as_str(), expected);
        let meta = exr::meta::MetaData::read_from_file(&picture, false).unwrap();
        let attributes = &meta.headers[0].own_attributes.other;
        let written = attributes.iter().find(|(name, _)| *name == "photon:environment").unwrap().1;
        assert_eq!(Some(written.to_text().unwrap().to_string().as_str()), expected);
        let explained = stdout(&run("explain", &[&scene[..], arguments].concat()));
        assert!(explained.contains(&format!("environment: {}\n", expected.unwrap())), "{explained}");
        assert!(explained.contains("the environment  "), "{explained}");
    }
    // Built-in scenes have none of their own, and may get one.
    succeeded(&render(&[&["cornell"][..], &small, &files].concat()));
    assert!(json(&report)["environment"].is_null());
    succeeded(&render(&[&["cornell", "--environment", "sky:5,2"][..], &small, &files].concat()));
    assert_eq!(json(&report)["environment"], "sky:5,2");
}

/// An image given on the command line, and relative to the override file.
#[test]
fn images_are_found() {
    let folder = folder("environment-image");
    let [obj, camera] = plate(&folder);
    std::fs::create_dir_all(folder.join("maps")).unwrap();
    let image = folder.join("maps/even.exr");
    exr::prelude::write_rgb_file(&image, 8, 4, |_, _| (1.0_f32, 0.5_f32, 0.25_f32)).unwrap();
    let truth = [1.0, 0.5, 0.25].map(|c| c * ALBEDO);
    let given = mean(&folder, &[&obj, "--overrides", &camera, "--environment", image.to_str().unwrap()]);
    assert!(close(given, truth), "{given:?}");
    let relative = folder.join("relative.toml");
    let text = std::fs::read_to_string(&camera).unwrap();
    std::fs::write(&relative, format!("{text}\n[environment]\nfile = \"maps/even.exr\"\n")).unwrap();
    let found = mean(&folder, &[&obj, "--overrides", relative.to_str().unwrap()]);
    assert!(close(found, truth), "{found:?}");
}

/// `--portal` names a material: `explain` says what part of the light passes it, half of π R² |n·ω| for a plate of area 4 in
/// a scene of radius √2, and an unknown name is an error.
#[test]
fn portals_of_the_command_line() {
    let folder = folder("environment-portal");
    let [obj, camera] = plate(&folder);
    let scene = [obj.as_str(), "--overrides", &camera, "--environment", "constant"];
    let explained = stdout(&run("explain", &[&scene[..], &["--portal", "plate"]].concat()));
    let text = explained.lines().find(|line| line.starts_with("portals: 2 triangles; ")).unwrap();
    let share: f64 = text.split(' ').nth(3).unwrap().parse().unwrap();
    assert!((share - 100.0 * 4.0 / (2.0 * PI * 2.0)).abs() < 0.01, "{text}");
    assert!(explained.contains("portals                  2 triangles; photons"), "{explained}");
    let even = mean(&folder, &[&scene[..], &["--portal", "plate"]].concat());
    assert!(close(even, [ALBEDO; 3]), "{even:?}");
    assert!(!stdout(&run("explain", &scene)).contains("portals:"));
    refused(&render(&[&scene[..], &["--portal", "plat"]].concat()), "portal 'plat'");
}

#[test]
fn wrong_environments_are_named() {
    let folder = folder("environment-bad");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let [obj, _] = plate(&folder);
    let square = path("square.exr");
    exr::prelude::write_rgb_file(&square, 4, 4, |_, _| (1.0_f32, 1.0_f32, 1.0_f32)).unwrap();
    let gone = path("gone.exr");
    let cases: [(&[&str], &str); 17] = [
        (&["--environment", &gone], "gone.exr"),
        (&["--environment", &obj], "unknown format"),
        (&["--environment", &square], "twice as wide"),
        (&["--environment", "constant:1,1"], "three numbers"),
        (&["--environment", "constant:a"], "three numbers"),
        (&["--environment", "constant:-1"], "at least 0"),
        (&["--environment", "constant:nan"], "at least 0"),
        (&["--environment", "constant:0"], "light"),
        (&["--environment", "sky"], "sky:30,3"),
        (&["--environment", "sky:30"], "sky:30,3"),
        (&["--environment", "sky:-5,3"], "elevation of its sun is -5"),
        (&["--environment", "sky:95,3"], "between 0, at the horizon, and 90"),
        (&["--environment", "sky:30,11"], "turbidity is 11"),
        (&["--environment", "sky:nan,3"], "NaN"),
        (&["--environment", "constant", "--environment-scale", "-1"], "scale is -1"),
        (&["--environment", "constant", "--environment-rotate", "nan"], "rotation is NaN"),
        (&["--environment-rotate", "30"], "--environment "),
    ];
    for (arguments, culprit) in cases {
        refused(&render(&[&[obj.as_str()], arguments].concat()), culprit);
    }
}

/// glTF has no environment: nothing is lost silently. An even one, and the sun, are emitters of Mitsuba.
#[test]
fn export_writes_or_refuses_the_environment() {
    let folder = folder("environment-export");
    let [obj, _] = plate(&folder);
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (glb, xml) = (path("a.glb"), path("a.xml"));
    let export = |environment: &str, file: &str| run("export", &[&obj, "--environment", environment, "-o", file]);
    refused(&export("sky:30,3", &glb), "the environment (sky:30,3) cannot be written");
    refused(&export("constant", &glb), "the environment (constant:1,1,1)");
    succeeded(&export("sky:30,3", &xml));
    let text = std::fs::read_to_string(&xml).unwrap();
    assert!(text.contains("<emitter type=\"directional\">") && text.contains("a-meshes/environment.exr"), "{text}");
    succeeded(&export("constant:1,2,3", &xml));
    let text = std::fs::read_to_string(&xml).unwrap();
    let emitter = text.split("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"").nth(1).unwrap();
    let radiance: Vec<f64> = emitter.split('"').next().unwrap().split(", ").map(|c| c.parse().unwrap()).collect();
    assert!((0..3).all(|c| (radiance[c] / (c as f64 + 1.0) - 1.0).abs() < 1e-6), "{radiance:?}");
}

/// Mitsuba's lookup in the exported image gives our radiance in every direction: its columns have their centres at
/// φ = 2π (i + ½)/W from −z, and its rows stand for θ = π j/(H − 1) (envmap.cpp of Mitsuba 3.9).
#[test]
fn images_are_resampled_for_mitsuba() {
    let folder = folder("environment-mitsuba");
    let [obj, _] = plate(&folder);
    let xml = folder.join("a.xml").to_str().unwrap().to_owned();
    let options = ["--environment", "sky:10,2", "--environment-rotate", "70", "-o", &xml];
    succeeded(&run("export", &[&[&obj[..]], &options[..]].concat()));
    let text = std::fs::read_to_string(&xml).unwrap();
    let angle = text.split("<rotate y=\"1\" angle=\"").nth(1).unwrap().split('"').next().unwrap();
    let turn = angle.parse::<f64>().unwrap().to_radians();
    let image = photon_scene::load_image(&folder.join("a-meshes/environment.exr")).unwrap();
    let (width, rows, texels) = (image.width as usize, image.height as usize - 1, image.linear_rgb());
    let lookup = |[x, y, z]: [f64; 3], turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let (local_x, local_z) = (cos * x - sin * z, sin * x + cos * z);
        let u = local_x.atan2(-local_z) / std::f64::consts::TAU * width as f64 - 0.5;
        let v = y.acos() / std::f64::consts::PI * rows as f64;
        let (left, above) = (u.floor(), v.floor().min(rows as f64 - 1.0));
        let at = |x: f64, y: f64| f64::from(texels[y as usize * width + x.rem_euclid(width as f64) as usize][1]);
        let line = |y: f64| at(left, y) * (1.0 - u + left) + at(left + 1.0, y) * (u - left);
        line(above) * (1.0 - v + above) + line(above + 1.0) * (v - above)
    };
    let map = EnvironmentDesc::sky(10.0, 2.0).rotated(70.0).bake().unwrap().map;
    let mut differ = [0; 3];
    for step in 0..2000 {
        // Points of a spiral on the sphere.
        let y = 1.0 - (f64::from(step) + 0.5) / 1000.0;
        let (sin, cos) = (2.4 * f64::from(step)).sin_cos();
        let beside = (1.0 - y * y).sqrt();
        let direction = [sin * beside, y, -cos * beside];
        let truth = f64::from(map.radiance(Vec3::from(direction.map(|c| c as f32))).y);
        // Turned by half a column, or the other way round, the comparison fails.
        for (count, turn) in differ.iter_mut().zip([turn, turn + std::f64::consts::PI / width as f64, -turn]) {
            *count += u32::from((lookup(direction, turn) / truth - 1.0).abs() > 1e-3);
        }
    }
    assert!(differ[0] == 0 && differ[1] > 20 && differ[2] > 500, "{differ:?}");
}
