//! `photonmap export`

use std::path::PathBuf;

use clap::Args;

use crate::args::{PictureArgs, SceneArgs};
use crate::fault::Fault;
use crate::{atomic_write, load, mitsuba, summary};

/// Write a scene as a glTF binary (.glb), or for Mitsuba 3 (.xml).
///
/// A .glb contains the whole scene: `photonmap render F.glb` gives the same picture, bit for bit. What glTF cannot
/// express is in its extras, which other programs ignore; they read the same scene in single precision.
///
/// An .xml is for Mitsuba 3, with its triangles in the folder F-meshes beside it, and has one camera, that of --camera
/// for a picture of --size with the lens of --aperture and --focus.
#[derive(Clone, Debug, Args)]
pub struct ExportArgs {
    /// The scene to export.
    #[command(flatten)]
    scene: SceneArgs,
    /// File to write; its extension, .glb or .xml, chooses the format.
    #[arg(short, long, value_name = "F.glb|F.xml", help_heading = "Output")]
    output: PathBuf,
    /// Size and viewpoint, for Mitsuba.
    #[command(flatten)]
    picture: PictureArgs,
}

/// Writes the file.
///
/// # Errors
/// [`Fault::Input`] for a scene that cannot be loaded or expressed in the format, or an unknown extension;
/// [`Fault::Failure`] if the file cannot be written.
pub fn run(args: &ExportArgs) -> Result<(), Fault> {
    let path = &args.output;
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let is = |wanted: &str| extension.eq_ignore_ascii_case(wanted);
    if !is("glb") && !is("xml") {
        return Err(Fault::input(format!("{}: the name of an exported scene ends in .glb or .xml", path.display())));
    }
    atomic_write::check(path)?;
    if is("glb") {
        let (builder, report) = load::builder(&args.scene)?;
        load::print(&report, args.scene.strict)?;
        atomic_write::write_bytes(path, &photon_scene::glb(&builder)?)?;
        say!("wrote {}", path.display());
        return Ok(());
    }
    let (scene, _) = load::scene(&args.scene)?;
    let camera = args.picture.view(&scene)?.camera;
    let written = mitsuba::write(path, &scene, &camera, args.picture.size)?;
    summary::say("warning: ", &written.warnings);
    say!("wrote {} and {} meshes in {}", path.display(), written.meshes, written.folder.display());
    Ok(())
}
