//! Loads scenes: built-in ones by name, others from files.

use std::path::Path;

use photon_scene::{LoadReport, Overrides, Scene, SceneBuilder};

use crate::args::SceneArgs;
use crate::fault::Fault;

/// Loads and builds a scene, and prints the loader's report and the scene's warnings to standard error.
///
/// # Errors
/// As [`builder`]; the errors of [`SceneBuilder::build`]; with `--strict` anything that the loader approximates.
#[expect(clippy::print_stderr, reason = "warnings go to standard error")]
pub fn scene(args: &SceneArgs) -> Result<(Scene, LoadReport), Fault> {
    let (builder, report) = builder(args)?;
    let scene = builder.build()?;
    for warning in scene.warnings() {
        eprintln!("warning: {warning}");
    }
    print(&report, args.strict)?;
    Ok((scene, report))
}

/// Prints a loader's report on standard error.
///
/// # Errors
/// [`Fault::Input`] if `strict` and anything was approximated or left out.
#[expect(clippy::print_stderr, reason = "reports go to standard error")]
pub fn print(report: &LoadReport, strict: bool) -> Result<(), Fault> {
    for line in &report.lines {
        eprintln!("{line}");
    }
    if strict && !report.is_exact() {
        return Err(Fault::input("--strict: the lines above say what is approximated or left out"));
    }
    Ok(())
}

/// The description of a scene, with the overrides and the environment of the command line applied; not validated yet.
///
/// # Errors
/// [`Fault::Input`] for an unknown name, a file that cannot be read or is invalid, or an invalid environment.
pub fn builder(args: &SceneArgs) -> Result<(SceneBuilder, LoadReport), Fault> {
    let (mut builder, mut report) = described(args)?;
    if let Some(desc) = args.environment.desc(&mut report)? {
        builder.environment_from(&desc)?;
    }
    Ok((builder, report))
}

/// The description of a scene with the overrides applied.
fn described(args: &SceneArgs) -> Result<(SceneBuilder, LoadReport), Fault> {
    let overrides = args.overrides.as_deref().map(Overrides::read).transpose()?;
    match photon_scene::builtin(&args.scene) {
        Some(mut builder) => {
            let mut report = LoadReport::default();
            if let Some(overrides) = &overrides {
                overrides.apply(&mut builder, &mut report)?;
            }
            Ok((builder, report))
        }
        None if Path::new(&args.scene).extension().is_none() => {
            let names: Vec<&str> = photon_scene::builtin_names().iter().map(|(name, _)| *name).collect();
            Err(Fault::input(format!(
                "{}: no built-in scene has that name (there are {}), and it has no extension that gives the format of \
                 a file",
                args.scene,
                names.join(", ")
            )))
        }
        None => Ok(photon_scene::load_builder(Path::new(&args.scene), overrides.as_ref())?),
    }
}
