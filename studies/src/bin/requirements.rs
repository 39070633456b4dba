//! Cost of each feature for a scene that has it, and for one that does not: `cargo xtask requirements` writes it
//! to `docs/studies/data/requirements.txt`.
//!
//! Bytes, time and equality of bits for each feature, with derived and with widened requirements, on every backend, in
//! Markdown; of all scenes, or of those named. `--work SCENE derived|widened PATHS PASSES`: that many passes of that
//! many paths on one CPU thread, for an instruction counter; `--scenes`: the names of the scenes, one per line.
#![expect(clippy::print_stdout, clippy::unwrap_used, reason = "a program for measuring")]

use backend_cpu::Cpu;
use backend_vulkan::{Options, Vulkan};
use photon_core::{
    Area, Bandwidth, CausticPhotons, Direct, Estimator, Indirect, Pipeline, Render, Requirements, Settings, Stage,
    TransportBackend, View,
};
use photon_scene::{
    AlphaMode, EnvironmentDesc, LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, VertexAttributes, shapes,
};
use photon_tests::harness::look_at_point;

const SCENES: [&str; 20] = [
    "diffuse",
    "mirror",
    "dielectric",
    "absorption",
    "thin",
    "glossy",
    "alpha",
    "vertex normals",
    "spot",
    "directional",
    "environment",
    "area",
    "direct map",
    "final gather",
    "aimed photons",
    "area correction",
    "plane distance",
    "error estimates",
    "radius per pixel",
    "precomputed irradiance",
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--scenes"] => {
            for name in SCENES {
                println!("{name}");
            }
        }
        ["--work", name, how, paths, passes] => {
            let (scene, settings) = scene(name, paths.parse().unwrap());
            let required = required(&scene, &settings, how == "widened");
            let mut renderer = start(Cpu::with_threads(1).unwrap(), &scene, &settings, required);
            for pass in 0..passes.parse().unwrap() {
                renderer.pass(pass, &mut ()).unwrap();
            }
        }
        ref named => {
            assert!(named.iter().all(|name| SCENES.contains(name)), "the scenes are {SCENES:?}");
            let scenes: Vec<&str> =
                SCENES.into_iter().filter(|scene| named.is_empty() || named.contains(scene)).collect();
            table("CPU", &scenes, || Cpu::with_threads(2).unwrap(), 60_000);
            if Vulkan::with_options(&Options::default()).is_ok() {
                table("Vulkan", &scenes, || Vulkan::with_options(&Options::default()).unwrap(), 20_000);
            }
        }
    }
}

/// A room with one feature, for passes of that many paths.
fn scene(name: &str, photons: u32) -> (Scene, Settings) {
    let mut builder = SceneBuilder::new();
    let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
    let (positions, mut triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    if name == "environment" {
        // The room is open above.
        triangles.retain(|triangle| triangle.iter().any(|&vertex| positions[vertex as usize][1] < 0.0));
    }
    builder.mesh("room", positions, triangles, grey);
    let surface = |surface| MaterialDesc::new("thing", surface);
    let thing = match name {
        "mirror" => MaterialDesc::mirror("thing", [0.9; 3]),
        "dielectric" | "aimed photons" => MaterialDesc::glass("thing", 1.5),
        "absorption" => surface(Surface::Dielectric { ior: 1.5, absorption: [0.5; 3], tint: [1.0; 3], roughness: 0.0 }),
        "thin" => MaterialDesc::thin("thing", 1.5),
        "glossy" => MaterialDesc::plastic("thing", [0.4; 3], 0.4),
        "alpha" => MaterialDesc::lambert("thing", [0.4; 3]).with_alpha(AlphaMode::Blend, 0.5),
        _ => MaterialDesc::lambert("thing", [0.4; 3]),
    };
    let thing = builder.material(thing);
    let (positions, triangles) = shapes::icosphere(3, [0.2, -0.4, 0.1], 0.4);
    let normals = match name {
        "vertex normals" => positions.iter().map(|p| [p[0] - 0.2, p[1] + 0.4, p[2] - 0.1]).collect(),
        _ => Vec::new(),
    };
    builder.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), thing);
    let (position, direction) = ([0.1, 0.7, 0.2], [0.1, -1.0, 0.0]);
    match name {
        "spot" => {
            let (inner_angle, outer_angle) = (0.4, 0.8);
            builder
                .light("light", LightDesc::Spot { position, direction, intensity: [1.0; 3], inner_angle, outer_angle });
        }
        "environment" => builder.environment_from(&EnvironmentDesc::constant([1.0; 3])).unwrap(),
        "directional" => builder.light("light", LightDesc::Directional { direction, irradiance: [1.0; 3] }),
        "area" => {
            let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [1.0; 3]));
            let (y, h) = (0.9, 0.3);
            builder.quad("light", [[-h, y, -h], [h, y, -h], [h, y, h], [-h, y, h]], area_light);
        }
        _ => builder.light("light", LightDesc::Point { position, intensity: [1.0; 3] }),
    }
    look_at_point(&mut builder, [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 0.05, 0.5);
    let mut settings = Settings {
        photons,
        max_bounces: 16,
        estimator: Estimator::Radius { radius: Some(0.1) },
        gather_rays: 4,
        // Glass and mirrors without the effect of aimed photons.
        caustic_photons: CausticPhotons::Shared,
        ..Settings::default()
    };
    match name {
        "direct map" => settings.direct = Direct::Photons,
        "final gather" => settings.indirect = Indirect::Gather,
        "aimed photons" => settings.caustic_photons = CausticPhotons::Aimed(photons / 4),
        "area correction" => settings.area = Area::Surface,
        "plane distance" => settings.max_plane_distance = Some(0.25),
        "error estimates" => settings.errors = true,
        "radius per pixel" => (settings.errors, settings.bandwidth) = (true, Bandwidth::PerPixel),
        "precomputed irradiance" => (settings.indirect, settings.irradiance_every) = (Indirect::Gather, Some(8)),
        _ => {}
    }
    (builder.build().unwrap(), settings)
}

fn required(scene: &Scene, settings: &Settings, widened: bool) -> Requirements {
    if widened { Requirements::everything(settings) } else { Requirements::of(&scene.view(), settings) }
}

fn start<B: TransportBackend>(on: B, scene: &Scene, settings: &Settings, required: Requirements) -> Pipeline<B> {
    let view = View { camera: scene.camera(None, 64, 64).unwrap(), width: 64, height: 64 };
    Pipeline::with_requirements(on, &scene.view(), view, settings.clone(), required).unwrap()
}

fn table<B: TransportBackend>(name: &str, scenes: &[&str], make: impl Fn() -> B, photons: u32) {
    println!("### Bytes and time on {name}: {}\n", make().device());
    println!("| scene | features | bytes | widened | ms a pass | widened | bits |\n|---|---|---|---|---|---|---|");
    for &scene_name in scenes {
        let (scene, settings) = scene(scene_name, photons);
        let mut both = [false, true].map(|widened| {
            let required = required(&scene, &settings, widened);
            (start(make(), &scene, &settings, required), Vec::new())
        });
        // Alternating, so that other load on the machine affects both; enough passes for radii per pixel.
        let passes = if settings.bandwidth == Bandwidth::PerPixel { 10 } else { 5 };
        for pass in 0..passes {
            for (renderer, times) in &mut both {
                let photon_core::PassEnd::Done(report) = renderer.pass(pass, &mut ()).unwrap() else { continue };
                times.push(Stage::ALL.into_iter().map(|stage| report.seconds.get(stage)).sum::<f64>());
            }
        }
        let [least, most] = both.each_mut().map(|(renderer, times)| {
            times.sort_unstable_by(f64::total_cmp);
            let bytes: u64 = renderer.facts().memory.iter().map(|(_, bytes)| bytes).sum();
            (bytes, times[0] * 1e3, renderer.film().unwrap().pixels)
        });
        let features = Requirements::of(&scene.view(), &settings).features;
        let bits = if least.2 == most.2 { "equal" } else { "**differ**" };
        println!("| {scene_name} | {features} | {} | {} | {:.1} | {:.1} | {bits} |", least.0, most.0, least.1, most.1);
    }
    println!();
}
