//! Loads scenes: built-in ones by name, others from files.

use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use photon_scene::{LoadOptions, LoadReport, Overrides, Scene, SceneBuilder};

use crate::args::SceneArgs;
use crate::fault::Fault;
use crate::{memory, summary};

/// The bytes that loading may take now; without, half of what is available on this machine.
pub type Limit<'a> = Option<&'a dyn Fn() -> u64>;

/// Loads and builds a scene, and prints the loader's report and the scene's warnings to standard error.
///
/// # Errors
/// As [`builder`]; the errors of [`SceneBuilder::build`]; with `--strict` anything that the loader approximates, and warnings of
/// the scene.
pub fn scene(args: &SceneArgs) -> Result<(Scene, LoadReport), Fault> {
    scene_within(args, None)
}

/// As [`scene`]; loading keeps to the limit that `limit` gives when it starts.
///
/// # Errors
/// As [`scene`]; textures and other parts that do not fit.
pub fn scene_within(args: &SceneArgs, limit: Limit<'_>) -> Result<(Scene, LoadReport), Fault> {
    let (mut builder, mut report) = builder_within(args, limit)?;
    if builder.light_if_dark()? {
        report.note(
            "the scene",
            "has no light; --environment gradient is used; give an image or sky:30,3 instead, or add lights in an \
             override file (--overrides auto writes one to begin with)",
        );
    }
    // Errors of reading name the file themselves; those of building may come from either file.
    let files = match &args.overrides {
        Some(overrides) => format!("{} with {}", args.scene, overrides.display()),
        None => args.scene.clone(),
    };
    let scene = builder.build().map_err(|error| Fault::input(format!("{files}: {error}")))?;
    summary::say("warning: ", scene.warnings());
    print(&report, args.strict)?;
    if args.strict && !scene.warnings().is_empty() {
        return Err(Fault::input("--strict: the warnings above say what is assumed, replaced or left out"));
    }
    Ok((scene, report))
}

/// Prints a loader's report on standard error.
///
/// # Errors
/// [`Fault::Input`] if `strict` and anything was approximated or left out.
pub fn print(report: &LoadReport, strict: bool) -> Result<(), Fault> {
    summary::say("", &report.lines);
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
    builder_within(args, None)
}

fn builder_within(args: &SceneArgs, limit: Limit<'_>) -> Result<(SceneBuilder, LoadReport), Fault> {
    // Measured each time, since a scene that is loaded takes up memory.
    let memory = || limit.map_or_else(memory::for_loading_by_default, |limit| Some(limit()));
    let options = || LoadOptions::default().with_memory(memory());
    let (mut builder, mut report) = described(args, &options())?;
    if let Some(desc) = args.environment.desc_with(&mut report, &options())? {
        builder.environment_from(&desc)?;
    }
    for name in &args.environment.portals {
        builder.portal_named(name);
    }
    Ok((builder, report))
}

/// The fault of a scene whose name is empty, or no name of a file.
pub(crate) fn unnamed(scene: &str) -> Fault {
    Fault::input(format!("'{scene}' names no scene; give a file, or a built-in scene, which `photonmap scenes` lists"))
}

/// The description of a scene with the overrides applied.
fn described(args: &SceneArgs, options: &LoadOptions) -> Result<(SceneBuilder, LoadReport), Fault> {
    let starts = args.overrides.as_deref() == Some(Path::new(STARTER));
    let given =
        args.overrides.as_deref().filter(|_| !starts).map(|path| Overrides::read_with(path, options)).transpose()?;
    let overrides = match args.light_units {
        Some(units) => Some(given.unwrap_or_default().with_light_units(units)),
        None => given,
    };
    let path = Path::new(&args.scene);
    if path.file_name().is_none() {
        return Err(unnamed(&args.scene));
    }
    let is_gltf =
        path.extension().is_some_and(|name| name.eq_ignore_ascii_case("gltf") || name.eq_ignore_ascii_case("glb"));
    if args.light_units.is_some() && !is_gltf {
        return Err(Fault::input(format!("--light-units: {} is not a glTF file; leave the option out", args.scene)));
    }
    match photon_scene::builtin(&args.scene) {
        Some(_) if starts => Err(Fault::input(format!(
            "--overrides {STARTER}: {} is a built-in scene; `photonmap export` writes it to a file",
            args.scene
        ))),
        Some(mut builder) => {
            let mut report = LoadReport::default();
            if let Some(overrides) = &overrides {
                overrides.apply(&mut builder, &mut report)?;
            }
            Ok((builder, report))
        }
        None if path.extension().is_none() && !path.is_dir() => {
            let names = photon_scene::builtin_names().iter().map(|(name, _)| *name);
            Err(Fault::input(format!(
                "{}: no built-in scene (`photonmap scenes` lists them) has that name, and it has no extension that gives \
                 the format of a file; {}",
                args.scene,
                photon_scene::did_you_mean(&args.scene, names)
            )))
        }
        None => {
            let (builder, report) = photon_scene::load_builder_with(path, overrides.as_ref(), options)?;
            if starts {
                write_starter(&path.with_extension("toml"), &builder)?;
            }
            Ok((builder, report))
        }
    }
}

/// The argument of `--overrides` for an override file to begin with.
const STARTER: &str = "auto";

/// Writes an override file to begin with, unless there is a file of that name.
fn write_starter(path: &Path, scene: &SceneBuilder) -> Result<(), Fault> {
    let mut file = File::create_new(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Fault::input(format!(
            "--overrides {STARTER}: {} is there already and is not overwritten; render with `--overrides {0}`, or remove it",
            path.display()
        )),
        _ => Fault::writing(path, error),
    })?;
    file.write_all(Overrides::starter(scene).as_bytes()).map_err(|error| Fault::writing(path, error))?;
    say!("wrote {}: edit it, then render with `--overrides {0}`", path.display());
    Ok(())
}
