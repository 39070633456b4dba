//! Round trips of scenes through .glb files.
#![cfg(feature = "files")]
#![expect(clippy::unwrap_used, reason = "test code")]

#[path = "common/replaced.rs"]
mod replaced;

use replaced::replaced;
use std::path::PathBuf;

use photon_scene::{
    CameraDesc, Dispersion, LightDesc, LoadReport, MaterialDesc, PhaseDesc, Projection, SceneBuilder, Surface,
    ThinLens, builtin, builtin_names, glb, load_gltf,
};

/// Writes the bytes to a file, and loads it.
fn reload(name: &str, bytes: &[u8]) -> (SceneBuilder, LoadReport) {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("glb-{name}.glb"));
    std::fs::write(&path, bytes).unwrap();
    load_gltf(&path).unwrap()
}

/// All numbers of a scene.
fn described(scene: &SceneBuilder) -> String {
    format!("{scene:#?}")
}

/// One object of each kind, with numbers that single precision cannot represent.
fn everything() -> SceneBuilder {
    let third = 1.0 / 3.0;
    let mut scene = SceneBuilder::new();
    let both = MaterialDesc::emissive("both", [0.1; 3], [third, 2.0, 1e-3]).with_both_sides(true);
    let glass = Surface::Dielectric {
        ior: 1.1 * third + 1.0,
        absorption: [0.1, 7.7, 0.0],
        tint: [0.3, third, 1.0],
        roughness: 0.0,
    };
    let all = [
        MaterialDesc::lambert("diffuse", [third, 0.7, 0.0]),
        MaterialDesc::lambert("dark", [0.5; 3]).with_both_sides(true),
        MaterialDesc::mirror("mirror", [0.9, 0.8, third]),
        MaterialDesc::new("glass", glass).with_priority(3).with_scattering([third, 0.1, 20.0], -0.1 * third),
        MaterialDesc::boundary("mist", [0.0, 0.1, third]).with_scattering([third; 3], PhaseDesc::Rayleigh),
        MaterialDesc::boundary("cloud", [0.0; 3])
            .with_scattering([third; 3], PhaseDesc::Mie { droplet_micrometres: 30.0 * third }),
        MaterialDesc::glass("flint", 1.5).with_dispersion(Dispersion::Cauchy([1.6, 0.06 * third])),
        MaterialDesc::glass("crown", 1.1 + third).with_dispersion(Dispersion::Abbe(150.0 * third)),
        MaterialDesc::glass("fog", 1.0).with_dispersion(Dispersion::Sellmeier([
            third,
            0.0,
            0.1,
            0.01,
            0.1,
            100.0 * third,
        ])),
        // glTF cannot say that red light is bent most.
        MaterialDesc::glass("inverse", 1.0).with_dispersion(Dispersion::Cauchy([1.6, -0.01])),
        MaterialDesc::new(
            "clear",
            Surface::Dielectric { ior: 0.9, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.0 },
        ),
        MaterialDesc::new("pane", Surface::Thin { ior: 1.33, tint: [0.2, 0.4, third], roughness: 0.0 }),
        both,
        MaterialDesc::metal("brass", [0.9, third, 0.1], 0.3 * third),
        MaterialDesc::metal("brushed", [0.9, third, 0.1], 0.3 * third).with_anisotropy(third, 10.0 * third),
        MaterialDesc::lambert("sealed", [0.9, third, 0.1]).with_clearcoat(1.0, third),
        MaterialDesc::mirror("sealed mirror", [0.9, third, 0.1]).with_clearcoat(third, 0.0),
        MaterialDesc::plastic("plastic", [third, 0.9, 0.1], third),
        MaterialDesc::plastic("leaf", [third, 0.9, 0.1], third).with_diffuse_transmission(third, [0.1, third, 1.0]),
        MaterialDesc::plastic("pane", [third, 0.9, 0.1], third).with_transmission(third, None),
        MaterialDesc::plastic("gem", [third, 0.9, 0.1], 0.0)
            .with_transmission(0.9, Some([third, 0.0, 2.0]))
            .with_dispersion(Dispersion::Abbe(20.0 * third))
            .with_priority(2),
        MaterialDesc::lambert("cloth", [third, 0.9, 0.1]).with_sheen([0.1, third, 1.0], third),
        MaterialDesc::mirror("silk", [third, 0.9, 0.1]).with_sheen([0.0, third, 0.0], 0.0).with_clearcoat(third, third),
        MaterialDesc::metal("velvet", [0.9, third, 0.1], third).with_sheen([third; 3], 1.0),
        MaterialDesc::lambert("paper", [third, 0.9, 0.1]).with_diffuse_transmission(1.0, [0.0, third, 0.0]),
        MaterialDesc::new(
            "varnish",
            Surface::Glossy {
                base_color: [third; 3],
                metallic: 0.1 * third,
                roughness: 0.7,
                specular: third,
                ior: 1.0 + third,
            },
        )
        .with_specular_color([third, 1.5, 0.0])
        .with_clearcoat(third, 0.1 * third),
        MaterialDesc::new(
            "reflects all",
            Surface::Glossy { base_color: [third; 3], metallic: 0.0, roughness: 0.0, specular: 0.9, ior: 0.0 },
        ),
    ];
    for (at, desc) in all.into_iter().enumerate() {
        let name = desc.name.clone();
        let material = scene.material(desc);
        let (x, z) = (at as f64 * 1.1, third);
        scene.quad(name, [[x, -0.0, z], [x + 1.0, 0.1, z], [x + 1.0, 0.1, -z], [x, 0.0, -z]], material);
    }
    scene.light("point", LightDesc::Point { position: [0.1, 5.0, third], intensity: [1.0, third, 0.0] });
    scene.light(
        "spot",
        LightDesc::Spot {
            position: [third, 4.0, 0.2],
            direction: [0.1, -2.0, third],
            intensity: [third, 3.0, 9.0],
            inner_angle: 0.1,
            outer_angle: std::f64::consts::FRAC_PI_2,
        },
    );
    scene.light("sun", LightDesc::Directional { direction: [third, -3.0, 0.1], irradiance: [1e-3, third, 2.0] });
    let lens = ThinLens::new(0.1 * third, 5.0 * third);
    let first = CameraDesc::look_at([0.1, 3.0, 9.0], [1.0, third, 0.0], [0.1, 1.0, 0.0], 0.7);
    scene.camera("first", first.with_lens(lens));
    let projection = Projection::Orthographic { half_height: 10.0 * third };
    let along = CameraDesc::new([0.0; 3], [0.0, 0.0, -4.0], [third, 2.0, 1.0], projection);
    scene.camera("second", along);
    scene
}

#[test]
fn every_built_in_scene_comes_back_number_by_number() {
    // An environment is refused: `sky` has one.
    assert!(glb(&builtin("sky").unwrap()).unwrap_err().to_string().contains("sky:32,3"));
    // And so is an ambient medium.
    assert!(glb(&builtin("cloud").unwrap()).unwrap_err().to_string().contains("grid of the material 'cloud'"));
    for name in ["fog", "glass-fog"] {
        assert!(glb(&builtin(name).unwrap()).unwrap_err().to_string().contains("ambient medium"), "{name}");
    }
    let names = builtin_names().iter().filter(|(name, _)| !["sky", "fog", "glass-fog", "cloud"].contains(name));
    let scenes = names.map(|(name, _)| (*name, builtin(name).unwrap()));
    for (name, scene) in scenes.chain([("everything", everything())]) {
        let bytes = glb(&scene).unwrap();
        let (again, report) = reload(name, &bytes);
        assert!(report.lines.is_empty(), "{name}: {report}");
        assert_eq!(described(&scene), described(&again), "{name}");
        // The file is also valid for other readers.
        gltf::Gltf::from_slice(&bytes).unwrap_or_else(|why| panic!("{name}: {why:?}"));
    }
}

/// Surfaces without a glossy reflection are written as what they are, and give the same picture.
#[test]
fn the_simplest_surface_is_written() {
    let glossy = |metallic: f64, specular: f64, ior: f64| {
        MaterialDesc::new("it", Surface::Glossy { base_color: [0.3; 3], metallic, roughness: 0.0, specular, ior })
    };
    for (desc, simplest) in [
        (glossy(0.0, 0.0, 1.5), MaterialDesc::lambert("it", [0.3; 3])),
        (glossy(0.0, 1.0, 1.0), MaterialDesc::lambert("it", [0.3; 3])),
        // A smooth metal is no perfect mirror.
        (glossy(1.0, 0.5, 1.5), glossy(1.0, 0.5, 1.5)),
    ] {
        let scene = |desc: &MaterialDesc| {
            let mut scene = SceneBuilder::new();
            let material = scene.material(desc.clone());
            scene.quad("it", [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], material);
            scene
        };
        let (again, report) = reload("simplest", &glb(&scene(&desc)).unwrap());
        assert!(report.is_exact() && !report.to_string().contains("changed"), "{report}");
        assert_eq!(described(&again), described(&scene(&simplest)));
        let materials = |scene: SceneBuilder| scene.build().unwrap().view().materials.to_vec();
        assert_eq!(materials(scene(&desc)), materials(again));
    }
}

/// A material that no triangle uses is exported, and does no harm.
#[test]
fn unused_glass_does_not_matter() {
    let mut scene = builtin("cornell").unwrap();
    scene.material(MaterialDesc::glass("unused", 1.5));
    let (again, _) = reload("unused", &glb(&scene).unwrap());
    assert_eq!(described(&scene), described(&again));
    again.build().unwrap().view().validate().unwrap();
}

/// Without the extras the file is read as other programs read it: the same scene in single precision.
#[test]
fn the_comparison_sees_single_precision() {
    let scene = everything();
    let bytes = glb(&scene).unwrap();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    assert!(text.contains("photonmap"));
    let plain: Vec<u8> = replaced(&bytes, b"\"photonmap\"", b"\"something\"");
    let (again, _) = reload("plain", &plain);
    assert_ne!(described(&scene), described(&again));
    let (ours, theirs) = (scene.bounds().unwrap(), again.bounds().unwrap());
    for (a, b) in [ours.0, ours.1].into_iter().flatten().zip([theirs.0, theirs.1].into_iter().flatten()) {
        assert!((a - b).abs() < 1e-6 && f64::from(b as f32) == b, "{a} {b}");
    }
    for kind in ["Dielectric", "Thin", "Glossy"] {
        assert!(described(&again).contains(kind), "{kind}");
    }
}

/// Changes by another program take precedence, even if it keeps the extras.
#[test]
fn a_changed_file_is_followed() {
    let mut scene = SceneBuilder::new();
    let wall = scene.material(MaterialDesc::lambert("wall", [0.25, 0.5, 0.75]));
    let at = 1.0 / 3.0;
    scene.quad("wall", [[0.0, 0.0, 0.0], [at, 0.0, 0.0], [at, 1.0, 0.0], [0.0, 1.0, 0.0]], wall);
    scene.light("bulb", LightDesc::Point { position: [0.0, 0.0, 2.0], intensity: [4.0; 3] });
    scene.camera("camera", CameraDesc::look_at([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 0.5));
    let brass = scene.material(MaterialDesc::metal("brass", [0.5; 3], at));
    scene.quad("shelf", [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]], brass);
    let bytes = glb(&scene).unwrap();
    for (from, to, what) in [
        (&b"[0.25,0.5,0.75,1.0]"[..], &b"[0.75,0.5,0.25,1.0]"[..], "material 'wall'"),
        (b"\"roughnessFactor\":0.33333334", b"\"roughnessFactor\":0.53333334", "material 'brass'"),
        (b"\"intensity\":4.0", b"\"intensity\":5.0", "bulb"),
        (b"\"yfov\":0.5", b"\"yfov\":0.7", "camera"),
        (b"\"translation\":[0.0,0.0,3.0]", b"\"translation\":[0.0,9.0,3.0]", "camera"),
    ] {
        let (changed, report) = reload("changed", &replaced(&bytes, from, to));
        assert!(report.is_exact() && report.to_string().contains("was changed after"), "{report}");
        assert!(report.to_string().contains(what), "{report}");
        assert_ne!(described(&changed), described(&scene));
    }
    // Positions: one coordinate is no longer the rounded one.
    let third = (at as f32).to_le_bytes();
    let (_, report) = reload("moved", &replaced(&bytes, &third, &0.5_f32.to_le_bytes()));
    assert!(report.to_string().contains("mesh") && report.to_string().contains("was changed after"), "{report}");
}

#[test]
fn extras_that_make_no_sense_are_ignored_with_a_note() {
    let bytes = glb(&everything()).unwrap();
    for (from, to) in [
        (&b"\"kind\":\"lambert\""[..], &b"\"kind\":\"lumbert\""[..]),
        (b"\"outer_angle\"", b"\"outre_angle\""),
        (b"\"vertical_fov\"", b"\"vertical_fox\""),
        (b"{\"positions\":2}", b"{\"positions\":9}"),
    ] {
        let (_, report) = reload("nonsense", &replaced(&bytes, from, to));
        assert!(!report.lines.is_empty() && report.is_exact(), "{report}");
    }
}

#[test]
fn what_gltf_cannot_hold_is_named() {
    let lit = |intensity: f64| {
        let mut scene = everything();
        scene.light("huge", LightDesc::Point { position: [0.0; 3], intensity: [intensity; 3] });
        glb(&scene)
    };
    assert!(lit(1e3).is_ok());
    let why = lit(1e60).unwrap_err().to_string();
    assert!(why.contains("light 'huge'"), "{why}");
    // An invalid scene is not written.
    assert!(lit(f64::NAN).unwrap_err().to_string().contains("huge"));
}
