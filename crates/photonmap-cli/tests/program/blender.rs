//! Scenes from Blender: `--light-units`, and `--overrides auto`.

use std::f64::consts::PI;
use std::path::Path;

use photon_scene::shapes::icosphere;
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, SceneBuilder, VertexAttributes};

use crate::support::{channels, folder, refused, render, run, stderr, succeeded};

const ALBEDO: f64 = 0.6;
/// Of Blender's sun, W/m², and of its point light, W, which is above the plate at this height.
const SUN: f64 = 2.0;
const POWER: f64 = 100.0;
const HEIGHT: f64 = 2.0;
/// lm/W, in Blender's exporter.
const EFFICACY: f64 = 683.0;

/// Writes a diffuse plate in the plane y = 0 under both lights as Blender's exporter does: `factor` is 683 with its
/// lighting mode Standard and 1 with Unitless. Returns the path.
fn plate(folder: &Path, factor: f64) -> String {
    let corners: [[f32; 3]; 4] = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    std::fs::write(folder.join("plate.bin"), &bytes).unwrap();
    // A light of a node shines along −z: a quarter turn about x makes that −y.
    let turn = [-(0.5_f64.sqrt()), 0.0, 0.0, 0.5_f64.sqrt()];
    let document = serde_json::json!({
        "asset": {"version": "2.0", "generator": "Khronos glTF Blender I/O v4.2.57"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_specular"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"name": "Sun", "type": "directional", "intensity": SUN * factor},
            {"name": "Point", "type": "point", "intensity": POWER / (4.0 * PI) * factor},
        ]}},
        "buffers": [{"uri": "plate.bin", "byteLength": bytes.len()}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 0, -1], "max": [1, 0, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "materials": [{
            "name": "plate",
            "pbrMetallicRoughness": {"baseColorFactor": [ALBEDO, ALBEDO, ALBEDO, 1], "metallicFactor": 0},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
        }],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "cameras": [{"name": "above", "type": "orthographic",
                     "orthographic": {"xmag": 0.001, "ymag": 0.001, "znear": 0.1, "zfar": 10}}],
        "nodes": [
            {"mesh": 0},
            {"rotation": turn, "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"translation": [0, HEIGHT, 0], "extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"translation": [0, 1, 0], "rotation": turn, "camera": 0},
        ],
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "scene": 0,
    });
    let path = folder.join("plate.gltf");
    std::fs::write(&path, document.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Radiance of the middle of the plate: ρ/π (E + I/h²).
fn truth(factor: f64) -> f64 {
    ALBEDO / PI * (SUN + POWER / (4.0 * PI) / (HEIGHT * HEIGHT)) * factor
}

/// The mean of the green channel of a picture, and what the program wrote to standard error.
fn radiance(folder: &Path, arguments: &[&str]) -> (f64, String) {
    let picture = folder.join("a.exr");
    let small = ["--size", "4x4", "--photons", "1000", "--passes", "1", "--backend", "cpu"];
    let output = render(&[arguments, &small, &["-o", picture.to_str().unwrap()]].concat());
    succeeded(&output);
    let green = &channels(&picture)["G"];
    (green.iter().map(|&v| f64::from(v)).sum::<f64>() / green.len() as f64, stderr(&output))
}

/// The camera sees 2 mm of the plate and radiances are f32: with two lights, whose probabilities are then those of their
/// light at the plate, the closed form holds to 1e-5.
fn close(found: f64, truth: f64) -> bool {
    (found / truth - 1.0).abs() < 1e-5
}

#[test]
fn both_lighting_modes_of_blender_give_its_radiance() {
    let folder = folder("light-units");
    for (factor, units, hint) in
        [(1.0, "unitless", ""), (EFFICACY, "standard", "2 in cd and lux are divided by 683 lm/W")]
    {
        let path = plate(&folder, factor);
        let (found, log) = radiance(&folder, &[&path, "--light-units", units]);
        assert!(close(found, truth(1.0)), "{units}: {found} {}", truth(1.0));
        assert!(log.contains(hint) && !log.contains("Lighting Mode"), "{log}");
    }
    // Without the option the numbers are radiometric, and there is a note since the file is Blender's.
    let path = plate(&folder, EFFICACY);
    let (found, log) = radiance(&folder, &[&path]);
    assert!(close(found, truth(EFFICACY)), "{found}");
    assert!(log.contains("unless its Lighting Mode is Unitless"), "{log}");
    // A note is no approximation.
    succeeded(&run("explain", &[&path, "--strict"]));
}

/// The option has precedence over the override file, and lights of the override file are always radiometric.
#[test]
fn light_units_of_override_files() {
    let folder = folder("light-units-overrides");
    let path = plate(&folder, EFFICACY);
    let overrides = folder.join("over.toml");
    let sun = "[[lights]]\ntype = \"directional\"\ndirection = [0, -1, 0]\nirradiance = 1.0\n";
    std::fs::write(&overrides, format!("light_units = \"standard\"\n{sun}")).unwrap();
    let given = [&path, "--overrides", overrides.to_str().unwrap()];
    // Of three lights, shadow rays choose one at random: within 4.5 standard errors of the mean over the pixels.
    let picture = folder.join("b.exr");
    let many = ["--size", "8x8", "--photons", "1000", "--passes", "16", "--shadow-rays", "16", "--backend", "cpu"];
    for (option, truth) in [(&[][..], truth(1.0)), (&["--light-units", "unitless"], truth(EFFICACY))] {
        succeeded(&render(&[&given[..], option, &many, &["-o", picture.to_str().unwrap()]].concat()));
        let pixels: Vec<f64> = channels(&picture)["G"].iter().map(|&v| f64::from(v)).collect();
        let count = pixels.len() as f64;
        let mean = pixels.iter().sum::<f64>() / count;
        let error = (pixels.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt();
        let truth = truth + ALBEDO / PI;
        assert!((mean - truth).abs() < 4.5 * error + 1e-5 * truth && error < 0.01 * truth, "{mean} {error} {truth}");
    }
    // Exported files are radiometric.
    let glb = folder.join("a.glb");
    let glb = glb.to_str().unwrap();
    succeeded(&run("export", &[&path, "--light-units", "standard", "-o", glb]));
    let (found, log) = radiance(&folder, &[glb]);
    assert!(close(found, truth(1.0)) && !log.contains("Lighting Mode"), "{found} {log}");
}

#[test]
fn wrong_light_units_are_named() {
    let folder = folder("light-units-bad");
    let path = plate(&folder, 1.0);
    refused(&render(&[&path, "--light-units", "lumens"]), "standard");
    refused(&render(&["cornell", "--light-units", "standard"]), "cornell is not a glTF file");
    let overrides = folder.join("over.toml");
    std::fs::write(&overrides, "light_units = \"lux\"\n").unwrap();
    refused(&render(&[&path, "--overrides", overrides.to_str().unwrap()]), "over.toml, line 1: unknown value 'lux'");
}

#[test]
fn a_starter_file_changes_nothing_until_it_is_edited() {
    let folder = folder("starter");
    let path = plate(&folder, 1.0);
    let toml = folder.join("plate.toml");
    let (plain, _) = radiance(&folder, &[&path]);
    let (with_it, log) = radiance(&folder, &[&path, "--overrides", "auto"]);
    assert!(log.contains("plate.toml: edit it"), "{log}");
    let text = std::fs::read_to_string(&toml).unwrap();
    for line in ["[materials.\"plate\"]", "# kind = \"lambert\"", "# albedo = 0.6", "# half_height = 0.001"] {
        assert!(text.lines().any(|found| found.starts_with(line)), "{line}: {text}");
    }
    let overrides = toml.to_str().unwrap();
    let (unedited, _) = radiance(&folder, &[&path, "--overrides", overrides]);
    assert_eq!([with_it.to_bits(), unedited.to_bits()], [plain.to_bits(); 2]);

    // It is never overwritten, and nothing is rendered.
    let picture = folder.join("b.png");
    let edited = text.replacen("# albedo = 0.6", "albedo = 0.3 #", 1);
    assert_ne!(edited, text);
    std::fs::write(&toml, &edited).unwrap();
    let output = render(&[&path, "--overrides", "auto", "-o", picture.to_str().unwrap()]);
    refused(&output, "plate.toml is there already and is not overwritten");
    assert_eq!((std::fs::read_to_string(&toml).unwrap(), picture.exists()), (edited, false));
    let (half, _) = radiance(&folder, &[&path, "--overrides", overrides]);
    assert!(close(half, truth(0.5)), "{half}");
    refused(&render(&["cornell", "--overrides", "auto"]), "cornell is a built-in scene");
    refused(&render(&[folder.join("gone.glb").to_str().unwrap(), "--overrides", "auto"]), "gone.glb");
    assert!(!folder.join("gone.toml").exists());
}

/// A glass ball in the sun, as Blender writes it: a sheet of transmission 1 in a mesh with normals, and lights in lux.
fn ball_in_the_sun(folder: &Path) -> String {
    const CENTER: [f64; 3] = [0.0, 0.65, 0.0];
    let mut scene = SceneBuilder::new();
    let floor = scene.material(MaterialDesc::lambert("Floor", [ALBEDO; 3]));
    scene.quad("floor", [[-0.6, 0.0, 0.6], [0.6, 0.0, 0.6], [0.6, 0.0, -0.6], [-0.6, 0.0, -0.6]], floor);
    let glass = scene.material(MaterialDesc::thin("Glass", 1.5));
    let (positions, triangles) = icosphere(4, CENTER, 0.5);
    let normals = positions.iter().map(|at| std::array::from_fn(|axis| at[axis] - CENTER[axis])).collect();
    let smooth = VertexAttributes::default().with_normals(normals);
    scene.mesh_with("ball", positions, triangles, smooth, glass);
    scene.light("Sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [SUN * EFFICACY; 3] });
    // Under the ball, which focuses parallel light 0.75 below its centre, and less far beside its axis.
    scene.camera("Camera", CameraDesc::look_at([2.0, 0.6, 0.0], [0.0; 3], [0.0, 1.0, 0.0], 0.02));
    let path = folder.join("scene.glb");
    std::fs::write(&path, photon_scene::glb(&scene).unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The override file of `docs/blender.md` makes the caustic: without its glass there is hardly one.
#[test]
fn overrides_of_the_documentation_make_a_caustic() {
    let folder = folder("blender-caustic");
    let path = ball_in_the_sun(&folder);
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/blender.md")).unwrap();
    let lines = page.split("```toml").nth(1).unwrap().split("```").next().unwrap();
    let overrides = folder.join("scene.toml");
    std::fs::write(&overrides, lines).unwrap();
    let unobstructed = ALBEDO / PI * SUN;
    let picture = folder.join("caustic.exr");
    let render = |options: &[&str]| {
        let small = ["--size", "8x8", "--photons", "100000", "--passes", "2", "--backend", "cpu"];
        succeeded(&render(&[&[path.as_str()], options, &small, &["-o", picture.to_str().unwrap()]].concat()));
        let green = &channels(&picture)["G"];
        green.iter().map(|&v| f64::from(v)).sum::<f64>() / green.len() as f64 / unobstructed
    };
    let caustic = render(&["--overrides", overrides.to_str().unwrap()]);
    let sheet = render(&["--light-units", "standard"]);
    assert!(caustic > 20.0, "{caustic}");
    // Most light goes straight on; what the sides of the ball reflect crosses here too.
    assert!(sheet > 0.5 && sheet < 3.0, "{sheet}");
}
