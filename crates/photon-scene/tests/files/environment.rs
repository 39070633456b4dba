//! Environments from image files and from override files.

use crate::support::{Folder, MTL, OBJ, message, names};
use photon_core::Light;
use photon_scene::{EnvironmentDesc, LoadReport, Overrides, SceneBuilder, load};

/// A Radiance HDR of 2 × 1 texels: red 1 and 4, green half of it, no blue.
const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x00\x81\x80\x40\x00\x83";

/// An uncompressed EXR of 2 × 1 texels with equal channels.
fn exr(folder: &Folder, name: &str, values: [f32; 2]) -> std::path::PathBuf {
    let path = folder.0.join(name);
    exr::prelude::write_rgb_file(&path, 2, 1, |x, _| (values[x], values[x], values[x])).expect("an image");
    path
}

#[test]
fn an_image_is_read_as_radiance() {
    let folder = Folder::new("environment");
    let mut report = LoadReport::default();
    let desc = EnvironmentDesc::read(&folder.file("sky.hdr", HDR), &mut report).unwrap();
    let map = desc.clone().scaled(0.5).rotated(90.0).bake().unwrap().map;
    assert_eq!((map.width(), map.height(), map.rotation()), (2, 1, 0.25));
    assert_eq!(map.texels(), [[0.5, 0.25, 0.0, 0.0], [2.0, 1.0, 0.0, 0.0]]);
    assert!(report.lines.is_empty(), "{report}");
    assert!(desc.rotated(90.0).to_string().ends_with("sky.hdr, rotated by 90 degrees"));
    // Display colours are decoded, with a note.
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[255, 188, 0, 0, 0, 0]).unwrap();
    let map = EnvironmentDesc::read(&folder.file("sky.png", png), &mut report).unwrap().bake().unwrap().map;
    let [red, green, blue, _] = map.texels()[0];
    assert!(red == 1.0 && (green - 0.503).abs() < 1e-3 && blue == 0.0, "{green}");
    assert!(report.is_exact() && report.to_string().contains("at most 1"), "{report}");
}

#[test]
fn texels_without_a_value() {
    let folder = Folder::new("environment-texels");
    let mut report = LoadReport::default();
    let desc = EnvironmentDesc::read(&exr(&folder, "nan.exr", [f32::NAN, -1.0]), &mut report).unwrap();
    assert_eq!(desc.bake().unwrap().map.mean_radiance(), [0.0; 3]);
    names(&report.to_string(), &["approximated: environment", "nan.exr", "2 texels"]);
    let infinite = exr(&folder, "inf.exr", [1.0, f32::INFINITY]);
    names(
        &message(EnvironmentDesc::read(&infinite, &mut report)),
        &["inf.exr", "column 1, row 0", "infinite", "65504"],
    );
    for (name, content, part) in
        [("text.exr", &b"hello"[..], "unknown format"), ("cut.hdr", &HDR[..HDR.len() - 1], "truncated")]
    {
        names(&message(EnvironmentDesc::read(&folder.file(name, content), &mut report)), &[name, part]);
    }
    names(&message(EnvironmentDesc::read(&folder.0.join("gone.exr"), &mut report)), &["gone.exr", "cannot read"]);
}

#[test]
fn override_files_set_the_environment() {
    let folder = Folder::new("environment-overrides");
    folder.file("scene materials.mtl", MTL);
    folder.file("sky.hdr", HDR);
    let obj = folder.file("scene.obj", OBJ);
    let scene = |text: &str| {
        let overrides = Overrides::read(&folder.file("over.toml", text))?;
        load(&obj, Some(&overrides)).map(|(scene, _)| scene)
    };
    // What a stranger's file names is in its folder.
    for outside in ["../sky.hdr", "/etc/passwd", "a/../../sky.hdr", "..\\\\sky.hdr"] {
        names(&message(scene(&format!("[environment]\nfile = \"{outside}\""))), &["over.toml", "outside the folder"]);
    }
    // The shape is known before texels are decoded: there are none.
    folder.file("tall.hdr", b"#?RADIANCE\n\n-Y 4096 +X 4096\n");
    names(&message(scene("[environment]\nfile = \"tall.hdr\"")), &["tall.hdr", "4096 × 4096", "twice as wide"]);
    let lights = |text: &str| -> Vec<u32> {
        let scene = scene(&format!("[environment]\n{text}")).unwrap();
        scene.view().lights.iter().map(|light| light.kind).filter(|kind| *kind != Light::TRIANGLE).collect()
    };
    assert_eq!(lights("file = \"sky.hdr\"\nrotate_degrees = 90\nscale = 2"), [Light::ENVIRONMENT]);
    assert_eq!(lights("radiance = [1, 2, 3]"), [Light::ENVIRONMENT]);
    assert!(lights("radiance = 0").is_empty());
    assert_eq!(lights("sky = { elevation = 30, turbidity = 3 }"), [Light::DIRECTIONAL, Light::ENVIRONMENT]);
    let found = scene("[environment]\nradiance = 2\nscale = 0.5").unwrap();
    assert_eq!(found.environment_text(), Some("constant:2,2,2, scaled by 0.5"));
    let radiance = f64::from(found.view().environment.unwrap().texels()[0][0]) * found.units().radiance_to_user();
    assert!((radiance - 1.0).abs() < 1e-6, "{radiance}");

    let fault = |text: &str| message(scene(text));
    names(&fault("[environment]\n"), &["over.toml", "has no light", "file, radiance or sky"]);
    names(&fault("[environment]\nradiance = 1\nfile = \"sky.hdr\"\n"), &["over.toml", "more than one"]);
    names(&fault("[environment]\nradience = 1\n"), &["over.toml, line 2", "radience", "'radiance'"]);
    names(&fault("[environment]\nfile = \"gone.exr\"\n"), &["gone.exr", "cannot read"]);
    names(&fault("[environment]\nfile = \"scene.obj\"\n"), &["scene.obj", "unknown format"]);
    names(&fault("[environment]\nradiance = -1\n"), &["constant:-1,-1,-1", "at least 0"]);
    names(&fault("[environment]\nradiance = 1\nscale = nan\n"), &["scale is NaN"]);
    names(&fault("[environment]\nradiance = 1\nrotate_degrees = inf\n"), &["rotation is inf"]);
    names(&fault("[environment]\nsky = { elevation = 30 }\n"), &["line 2", "turbidity"]);
    names(&fault("[environment]\nsky = { elevation = -3, turbidity = 3 }\n"), &["elevation of its sun is -3"]);
    names(&fault("[environment]\nsky = { elevation = 30, turbidity = 3, haze = 1 }\n"), &["line 2", "haze"]);
}

#[test]
fn a_second_environment_replaces_the_first_and_its_sun() {
    let mut builder = SceneBuilder::new();
    builder.environment_from(&EnvironmentDesc::sky(30.0, 3.0)).unwrap();
    assert!(builder.has_light());
    names(&message(photon_scene::glb(&builder)), &["the environment (sky:30,3) cannot be written", "without it"]);
    builder.environment_from(&EnvironmentDesc::constant([1.0; 3])).unwrap();
    let scene = builder.clone().build().unwrap();
    assert_eq!(scene.view().lights.iter().filter(|light| light.kind == Light::DIRECTIONAL).count(), 0);
    builder.environment_from(&EnvironmentDesc::constant([0.0; 3])).unwrap();
    assert!(!builder.has_light() && photon_scene::glb(&builder).is_ok());
}
