//! `photonmap devices`

use std::time::Instant;

use backend_vulkan::Vulkan;
use clap::Args;
use photon_core::{Bandwidth, Indirect, Pipeline, Settings, View};

use crate::backend;
use crate::fault::Fault;
use crate::stdout;

/// Lists the Vulkan devices, and what each lacks.
#[derive(Args, Clone, Debug, Default)]
pub struct DevicesArgs {
    /// Compile the kernels of usual scenes and settings, so that a first render with them does not wait.
    #[arg(long)]
    warm: bool,
    /// The device to prepare: its index, or a part of its name.
    #[arg(long, value_name = "DEVICE", requires = "warm")]
    device: Option<String>,
}

/// Scenes that have the kinds of surfaces and lights that most scenes have.
const USUAL: [&str; 7] = ["cornell", "cornell-glass", "pool", "gloss", "textures", "many-lights", "sky"];

/// Side of the picture: as many queries as in pictures of usual sizes, which are sorted.
const SIDE: u32 = 512;

/// Lists the devices, one per line, or prepares one.
///
/// # Errors
/// [`Fault::Input`] if there is no Vulkan loader or driver, or no such device; [`Fault::Failure`] if it fails.
pub fn run(args: &DevicesArgs) -> Result<(), Fault> {
    if !args.warm {
        return stdout::write((backend::list()?.join("\n") + "\n").as_bytes());
    }
    let on = match &args.device {
        Some(device) => backend::open_device(device)?,
        None => backend::vulkan()?,
    };
    warm(on, &USUAL, SIDE).map(drop)
}

/// Compiles the kernels of these scenes with usual settings, and stores them.
fn warm(mut on: Vulkan, names: &[&str], side: u32) -> Result<Vulkan, Fault> {
    let (begun, paths) = (Instant::now(), 10_000);
    let plain = Settings { photons: paths, ..Settings::default() };
    let own_radii = Settings { errors: true, bandwidth: Bandwidth::PerPixel, ..plain.clone() };
    let gathered = Settings { indirect: Indirect::Gather, ..plain.clone() };
    for name in names {
        let Some(scene) = photon_scene::builtin(name) else { continue };
        let scene = scene.build().map_err(|error| Fault::failure(error.to_string()))?;
        let view = View { camera: scene.camera(None, side, side)?, width: side, height: side };
        for settings in [&own_radii, &plain, &gathered] {
            on = Pipeline::new(on, &scene.view(), view, settings.clone())?.into_backend()?;
            on.wait_for_kernels()?;
        }
        say!("{name}: {:.1} s", begun.elapsed().as_secs_f64());
    }
    Ok(on)
}
