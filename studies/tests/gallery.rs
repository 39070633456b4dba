//! Runs the gallery on a folder with a model of each kind and one that is broken.
#![expect(clippy::unwrap_used, reason = "test code")]

mod folder;

use std::path::Path;
use std::process::{Command, Output};

use folder::folder;

fn gallery(models: &Path, out: &Path) -> Output {
    gallery_with(models, out, &[])
}

fn gallery_with(models: &Path, out: &Path, more: &[&str]) -> Output {
    let options =
        ["--environment", "constant", "--size", "24", "--passes", "256", "--photons", "1000", "--backend", "cpu"];
    Command::new(env!("CARGO_BIN_EXE_gallery"))
        .arg(models)
        .args(options)
        .args(more)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap()
}

/// A square of half side 1 in the plane y = 0: seen from the side it would be a line.
const FLOOR: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
element face 2\nproperty list uchar int vertex_indices\nend_header\n\
-1 0 1\n1 0 1\n1 0 -1\n-1 0 -1\n3 0 1 2\n3 0 2 3\n";

#[test]
fn every_model_has_a_row_and_those_that_load_a_picture() {
    let (models, out) = (folder("gallery-models"), folder("gallery-out"));
    std::fs::create_dir(models.join("within")).unwrap();
    std::fs::write(models.join("floor.ply"), FLOOR).unwrap();
    let scene = photon_scene::builtin("cornell").unwrap();
    std::fs::write(models.join("within/box.glb"), photon_scene::glb(&scene).unwrap()).unwrap();
    std::fs::write(models.join("notes.txt"), "no model").unwrap();
    let output = gallery(&models, &out);
    assert!(output.status.success(), "{output:?}");
    let table = std::fs::read_to_string(out.join("README.md")).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.contains(".png) |")).collect();
    assert_eq!(rows.len(), 2, "{table}");
    assert!(rows[0].starts_with("| [floor.ply](floor-ply.png) | 2 |") && rows[0].contains("no material"), "{table}");
    assert!(
        rows[1].starts_with("| [within/box.glb](within-box-glb.png) | 36 |") && rows[1].ends_with("exact |"),
        "{table}"
    );
    for (name, [width, height]) in
        [("floor-ply.png", [24, 24]), ("within-box-glb.png", [24, 24]), ("sheet.png", [50, 25])]
    {
        let image = photon_scene::load_image(&out.join(name)).unwrap();
        assert_eq!([image.width, image.height], [width, height], "{name}");
    }
    // The floor is a diffuse grey of one half under L = 1. Its exposure is measured where there is a surface, and makes it
    // 0.18, of which the Khronos PBR Neutral curve subtracts 0.04; the background is twice as bright, 0.32.
    let floor = photon_scene::load_image(&out.join("floor-ply.png")).unwrap().linear_rgb();
    let grey = floor.iter().filter(|texel| (texel[1] - 0.14).abs() < 0.03).count();
    assert!((floor[12 * 24 + 12][1] - 0.14).abs() < 0.03 && grey > 24 * 24 / 10, "{grey}");
    assert!((floor[0][1] - 0.32).abs() < 0.03, "{:?}", floor[0]);

    // Emission by an override file: the floor is brighter than the background.
    let overrides = folder("gallery-overrides");
    std::fs::write(overrides.join("floor.toml"), "[materials.default]\nemission = [9, 9, 9]\n").unwrap();
    let output = gallery_with(&models, &out, &["--overrides", overrides.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let floor = photon_scene::load_image(&out.join("floor-ply.png")).unwrap().linear_rgb();
    assert!(floor[12 * 24 + 12][1] > floor[0][1], "{:?} {:?}", floor[12 * 24 + 12], floor[0]);

    // A broken file: its row has the error, the others are rendered, and the program fails.
    std::fs::write(models.join("broken.glb"), "glTF but not really").unwrap();
    let output = gallery(&models, &out);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let table = std::fs::read_to_string(out.join("README.md")).unwrap();
    assert!(table.lines().any(|line| line.starts_with("| broken.glb | 0 |") && line.contains("**")), "{table}");
    assert_eq!(table.lines().filter(|line| line.contains(".png) |")).count(), 2, "{table}");
    // A folder without models, and one that is not there.
    for nothing in [folder("gallery-none"), models.join("missing")] {
        assert_eq!(gallery(&nothing, &out).status.code(), Some(2));
    }
}
