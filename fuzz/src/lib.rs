//! Shared by the targets: a temporary file per process, and the invariants of every scene that a loader
//! accepts.
#![expect(clippy::missing_panics_doc, reason = "a panic is what a fuzzer looks for")]

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use backend_cpu::Cpu;
use photon_core::glam::Vec3;
use photon_core::{CausticPhotons, Direct, Pipeline, RayCaster, Render, Settings, View};
use photon_scene::{Accel, LoadReport, Scene, SceneError};

/// A folder of this process.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        // `run.sh` removes this folder afterwards.
        let base = std::env::var_os("PHOTON_FUZZ_FOLDER").map_or_else(std::env::temp_dir, PathBuf::from);
        let folder = base.join(format!("photon-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder of our own");
        folder
    })
}

/// Writes `data` to a file of that name.
pub fn file(name: &str, data: &[u8]) -> PathBuf {
    let path = folder().join(name);
    std::fs::write(&path, data).expect("a file of our own");
    path
}

/// Checks that a scene is finite, in range, and can be intersected by rays; an error has a message.
pub fn check(loaded: Result<(Scene, LoadReport), SceneError>) {
    let scene = match loaded {
        Ok((scene, _)) => scene,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let view = scene.view();
    view.validate().expect("tables that backends accept");
    let vertices = view.positions.len();
    assert!(view.positions.iter().flatten().all(|x| x.is_finite() && x.abs() <= 0.5001));
    assert!(view.triangles.iter().flatten().all(|&index| (index as usize) < vertices));
    assert!(view.primitives.iter().all(|primitive| (primitive.material as usize) < view.materials.len()));
    assert!(view.primitives.iter().all(|primitive| (Vec3::from(primitive.normal).length() - 1.0).abs() < 1e-4));
    for material in view.materials {
        assert!(material.albedo.iter().all(|a| (0.0..=1.0).contains(a)), "{material:?}");
        assert!(material.emission.iter().all(|e| e.is_finite() && *e >= 0.0), "{material:?}");
        assert!(material.ior.is_finite() && material.ior > 0.0, "{material:?}");
    }
    assert!(view.lights.iter().all(|light| light.power.iter().all(|p| p.is_finite() && *p >= 0.0)));
    let camera = scene.camera(None, 16, 9);
    if let Ok(camera) = camera {
        assert!([camera.origin, camera.right, camera.up].iter().flatten().all(|x| x.is_finite()));
    }
    if view.triangles.is_empty() || view.triangles.len() > 5_000 {
        return;
    }
    let accel = Accel::build(view.positions, view.triangles).expect("a scene that was let through");
    for direction in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, -0.64, 0.48)] {
        let ray = photon_core::Ray { origin: Vec3::ZERO, direction, t_max: f32::INFINITY };
        if let Some(hit) = accel.nearest(&ray) {
            assert!(hit.t >= 0.0 && (hit.primitive as usize) < view.triangles.len());
        }
    }
    // Aiming photons takes longer than everything else; the target `settings` covers it.
    let caustic_photons = CausticPhotons::Shared;
    let settings = Settings { photons: 64, max_bounces: 16, shadow_rays: 1, caustic_photons, ..Settings::default() };
    render(&scene, Settings { direct: Direct::Photons, ..settings.clone() }, 1);
    render(&scene, settings, 1);
}

/// Renders a small picture: either an error with a message, or every value finite and ≥ 0, and every photon
/// accounted for.
pub fn render(scene: &Scene, settings: Settings, passes: u32) {
    let Ok(camera) = scene.camera(None, 4, 3) else { return };
    let on = Cpu::with_threads(1).expect("one thread");
    let view = View { camera, width: 4, height: 3 };
    let mut pipeline = match Pipeline::new(on, &scene.view(), view, settings) {
        Ok(pipeline) => pipeline,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    for pass in 0..passes {
        if let Err(error) = pipeline.pass(pass, &mut ()) {
            return assert!(!error.to_string().is_empty());
        }
    }
    let film = pipeline.film().expect("passes that went well");
    let numbers = film.pixels.iter().flat_map(|pixel| pixel.layers.iter().flatten());
    for &number in numbers {
        assert!(number.is_finite() && number >= 0.0, "{number}");
    }
}
