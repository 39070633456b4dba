//! A scene as other renderers read it: a PLY file for each material, and a JSON file of materials, lights and
//! camera. User space, metres and watts, linear RGB.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use photon_core::{Camera, Light, Material};
use photon_examples::fault::{self, Fault};
use photon_examples::whole;
use photon_scene::Scene;
use serde_json::{Value, json};

/// Writes a scene for other renderers to read.
#[derive(Debug, Parser)]
struct Args {
    /// A .gltf, .glb, .obj or .ply file, or the name of a built-in scene.
    scene: String,
    /// Folder to write to; scene.json is in it afterwards.
    #[arg(long)]
    out: PathBuf,
    /// Pixels across and down, on which the camera's right and up depend.
    #[arg(long, default_value_t = 48)]
    size: u32,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
    let scene = match photon_scene::builtin(&args.scene) {
        Some(builder) => builder.build()?,
        None => photon_scene::load(Path::new(&args.scene), None)?.0,
    };
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let mut materials = Vec::new();
    for (index, material) in scene.view().materials.iter().enumerate() {
        let name = format!("material-{index}.ply");
        let triangles = write_ply(&scene, index as u32, &args.out.join(&name))?;
        materials.push(describe(&scene, material, &name, triangles));
    }
    let camera = scene.camera(None, args.size, args.size)?;
    let whole = json!({
        "scene": args.scene,
        "size": args.size,
        "camera": eye(&scene, &camera),
        "materials": materials,
        "lights": scene.view().lights.iter().filter_map(|light| lamp(&scene, light)).collect::<Vec<_>>(),
    });
    whole::write_bytes(&args.out.join("scene.json"), format!("{whole:#}\n").as_bytes())
}

fn describe(scene: &Scene, material: &Material, file: &str, triangles: usize) -> Value {
    let units = scene.units();
    let kind = match material.kind {
        Material::LAMBERT => "lambert",
        Material::MIRROR => "mirror",
        Material::DIELECTRIC => "dielectric",
        _ => "thin",
    };
    json!({
        "file": file,
        "triangles": triangles,
        "kind": kind,
        "albedo": material.albedo,
        "radiance": material.emission.map(|c| f64::from(c) * units.radiance_to_user()),
        "both_sides": material.flags & Material::EMITS_BOTH_SIDES != 0,
        "absorption": material.absorption.map(|c| f64::from(c) / units.scale),
        "ior": material.ior,
    })
}

fn eye(scene: &Scene, camera: &Camera) -> Value {
    let kind = if camera.kind == Camera::PERSPECTIVE { "perspective" } else { "orthographic" };
    json!({
        "kind": kind,
        "origin": scene.units().point_to_user(camera.origin),
        "forward": camera.forward,
        "right": camera.right,
        "up": camera.up,
    })
}

/// `None` for triangles, which are among the materials.
fn lamp(scene: &Scene, light: &Light) -> Option<Value> {
    let kind = match light.kind {
        Light::POINT => "point",
        Light::SPOT => "spot",
        Light::DIRECTIONAL => "directional",
        _ => return None,
    };
    // Radians off the axis: light is even up to the inner angle, and gone from the outer one on.
    let angle = |versine: f32| 2.0 * (0.5 * f64::from(versine)).sqrt().min(1.0).asin();
    let cone = (light.kind == Light::SPOT).then(|| [angle(light.versine_inner), angle(light.versine_outer)]);
    // Parallel light is that through a disc about the scene.
    let disc = (light.kind == Light::DIRECTIONAL).then(|| scene.units().length_to_user(light.radius));
    Some(json!({
        "kind": kind,
        "position": scene.units().point_to_user(light.position),
        "direction": light.direction,
        "watts": light.power.map(|c| f64::from(c) * scene.units().power),
        "cone": cone,
        "disc_radius": disc,
    }))
}

/// The triangles of one material, binary; returns how many.
fn write_ply(scene: &Scene, material: u32, path: &Path) -> Result<usize, Fault> {
    let view = scene.view();
    let mut numbers = vec![u32::MAX; view.positions.len()];
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for (triangle, _) in view.triangles.iter().zip(view.facets).filter(|(_, facet)| facet.material == material) {
        faces.push(triangle.map(|corner| {
            let number = &mut numbers[corner as usize];
            if *number == u32::MAX {
                *number = corners.len() as u32;
                corners.push(scene.units().point_to_user(view.positions[corner as usize]));
            }
            *number
        }));
    }
    whole::write(path, |file| {
        write!(
            file,
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            corners.len(),
            faces.len()
        )?;
        for corner in corners.iter().flatten() {
            file.write_all(&(*corner as f32).to_le_bytes())?;
        }
        for face in &faces {
            file.write_all(&[3])?;
            for corner in face {
                file.write_all(&corner.to_le_bytes())?;
            }
        }
        Ok(())
    })?;
    Ok(faces.len())
}
