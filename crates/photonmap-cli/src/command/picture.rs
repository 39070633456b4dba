//! `photonmap picture`, and the pictures of a render.

use std::path::{Path, PathBuf};

use clap::Args;
use photon_core::{Display, Film};

use crate::args::RenderArgs;
use crate::denoise::Denoiser;
use crate::exposure::{self, Exposure};
use crate::fault::Fault;
use crate::outputs::Outputs;
use crate::png_file::Picture;
use crate::tonemap::ToneMap;
use crate::{atomic_write, exr_file, load, png_file};

/// Write the picture of a film file.
#[derive(Clone, Debug, Args)]
pub struct PictureArgs {
    /// The film file.
    #[arg(value_name = "FILE.film")]
    film: PathBuf,
    /// Picture to write, .exr or .png; may be given more than once.
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Exposure of the PNG, in stops, or `auto`.
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_negative_numbers = true)]
    exposure: Exposure,
    /// Tone curve of the PNG.
    #[arg(long, value_enum, default_value_t = ToneMap::Neutral)]
    tonemap: ToneMap,
    /// Denoise the picture by Open Image Denoise 2, which has to be installed; as in `photonmap render`.
    #[arg(long)]
    denoise: bool,
}

/// How a film becomes a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Whether the background is transparent.
    pub(crate) transparent: bool,
    /// Exposure of a PNG.
    pub(crate) exposure: Exposure,
    /// Tone curve of a PNG.
    pub(crate) tonemap: ToneMap,
}

impl Look {
    /// The same for pictures that devices make; `None` if the exposure is derived from the picture.
    pub(crate) fn display(self) -> Option<Display> {
        match self.exposure {
            Exposure::Stops(exposure) => {
                Some(Display { exposure, tone_map: self.tonemap.into(), transparent: self.transparent })
            }
            Exposure::Auto => None,
        }
    }
}

/// Reads the film and writes the pictures.
///
/// # Errors
/// [`Fault::Input`] for a file that is no film, or names that are no pictures; [`Fault::Failure`] if a file cannot be
/// written.
pub fn run(args: &PictureArgs) -> Result<(), Fault> {
    if let Exposure::Stops(stops) = args.exposure
        && !stops.is_finite()
    {
        return Err(Fault::input(format!("--exposure is {stops}, but must be finite")));
    }
    for path in &args.output {
        check_name(path)?;
        atomic_write::check(path)?;
    }
    let denoiser = if args.denoise { Some(Denoiser::load()?) } else { None };
    let (film, info) = photon_film::load(&args.film)?;
    let transparent = info.key.settings().any(|setting| setting == ("transparent_background", "true"));
    if transparent && args.denoise {
        return Err(Fault::input(format!(
            "{}: films with a transparent background cannot be denoised; leave out --denoise",
            args.film.display()
        )));
    }
    let look = Look { transparent, exposure: args.exposure, tonemap: args.tonemap };
    let settings: Vec<String> = info.key.settings().map(|(name, value)| format!("{name}: {value}")).collect();
    let makers: Vec<&str> = info.makers.iter().map(|maker| maker.device.as_str()).collect();
    let attributes = [
        ("photon:scene", info.scene.clone()),
        ("photon:passes", info.contains.to_string()),
        ("photon:photons_per_pass", info.key.photons().to_string()),
        ("photon:settings", settings.join(", ")),
        ("photon:device", makers.join(", ")),
    ];
    let attributes = attributes.map(|(name, value)| (name.to_owned(), value));
    let (shown, denoised) = shown(&film, denoiser.as_ref());
    let mut written = Outputs::default();
    written.keep(denoised);
    for path in &args.output {
        written.file(path, write(path, &shown, look, &attributes));
    }
    say!("wrote {written}: {} passes", film.passes);
    written.result()
}

/// The pictures of the options of a render.
#[expect(missing_debug_implementations, reason = "functions of a library")]
pub struct Pictures {
    pub(super) paths: Vec<PathBuf>,
    pub(super) look: Look,
    pub(super) denoiser: Option<Denoiser>,
}

impl Pictures {
    /// Checks options, names and folders, and loads the denoiser, before anything is rendered. Without a name, there is one PNG
    /// named after the scene, or none with a film file.
    ///
    /// # Errors
    /// [`Fault::Input`] naming the file or option.
    pub fn of(args: &RenderArgs) -> Result<Self, Fault> {
        args.files.check()?;
        let paths = paths(args)?;
        paths.iter().try_for_each(|path| atomic_write::check(path))?;
        let files = &args.files;
        let look = Look { transparent: files.transparent, exposure: files.exposure, tonemap: files.tonemap };
        let denoiser = if files.denoise { Some(Denoiser::load()?) } else { None };
        Ok(Self { paths, look, denoiser })
    }

    /// Writes the pictures of a film, each whatever becomes of the others.
    pub fn write(&self, film: &Film, written: &mut Outputs) {
        let (shown, denoised) = shown(film, self.denoiser.as_ref());
        written.keep(denoised);
        for path in &self.paths {
            written.file(path, write(path, &shown, self.look, &[]));
        }
    }
}

fn paths(args: &RenderArgs) -> Result<Vec<PathBuf>, Fault> {
    if args.files.output.is_empty() && args.film.film.is_some() {
        return Ok(Vec::new());
    }
    if args.files.output.is_empty() {
        let stem = Path::new(&args.scene.scene).file_stem().ok_or_else(|| load::unnamed(&args.scene.scene))?;
        return Ok(vec![Path::new(stem).with_extension("png")]);
    }
    for path in &args.files.output {
        check_name(path)?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Fault::input(format!("{}: there is no folder {}", path.display(), folder.display())));
        }
    }
    Ok(args.files.output.clone())
}

/// A film and the colours that are shown of it.
pub(super) struct Shown<'a> {
    film: &'a Film,
    pixels: Vec<[f32; 3]>,
    /// How they were denoised.
    note: Option<String>,
}

/// The colours of a film, denoised or as they are. If denoising fails, they are as they are, and the fault is returned too: it
/// is reported after the pictures have been written.
pub(super) fn shown<'a>(film: &'a Film, denoiser: Option<&Denoiser>) -> (Shown<'a>, Result<(), Fault>) {
    let as_it_is = || Shown { film, pixels: film.beauty(), note: None };
    let Some(denoiser) = denoiser else { return (as_it_is(), Ok(())) };
    match denoiser.denoise(film) {
        Ok(denoised) => {
            say!("denoised by {}", denoised.note);
            (Shown { film, pixels: denoised.pixels, note: Some(denoised.note) }, Ok(()))
        }
        Err(fault) => (as_it_is(), Err(fault)),
    }
}

/// Checks that a name is that of a picture.
pub(crate) fn check_name(path: &Path) -> Result<(), Fault> {
    if is_exr(path) || path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    Err(Fault::input(format!("{}: the name of a picture ends in .exr or .png", path.display())))
}

/// Whether a name is that of an EXR.
pub(crate) fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// Writes the picture of a film, and prints an automatic exposure; an EXR has the attributes.
pub(super) fn write(path: &Path, shown: &Shown<'_>, look: Look, attributes: &[(String, String)]) -> Result<(), Fault> {
    let denoised = shown.note.iter().map(|note| ("photon:denoised".to_owned(), note.clone()));
    let attributes: Vec<(String, String)> = attributes.iter().cloned().chain(denoised).collect();
    let stops = write_colours(path, (shown.film, shown.pixels.clone()), look, &attributes)?;
    if let Some(stops) = stops.filter(|_| look.exposure == Exposure::Auto) {
        say!("exposure of {}: {stops:.2} stops", path.display());
    }
    Ok(())
}

/// As [`write()`], of a film as it is and without a message. Returns the exposure of a PNG.
pub(crate) fn write_quietly(
    path: &Path,
    film: &Film,
    look: Look,
    attributes: &[(String, String)],
) -> Result<Option<f32>, Fault> {
    write_colours(path, (film, film.beauty()), look, attributes)
}

fn write_colours(
    path: &Path,
    (film, colours): (&Film, Vec<[f32; 3]>),
    look: Look,
    attributes: &[(String, String)],
) -> Result<Option<f32>, Fault> {
    if is_exr(path) {
        return exr_file::write_as(path, film, colours, look.transparent, attributes).map(|()| None);
    }
    let picture = Picture::of(film, colours, look.transparent);
    let stops = look.exposure.stops(&exposure::measured(&picture.colours, &film.alpha()));
    png_file::write(path, &picture, look.tonemap, stops).map(|()| Some(stops))
}

/// A command line as it is stored in pictures: paths are file names, since folders tell about the user.
pub(super) fn command(args: impl Iterator<Item = String>) -> String {
    let short = |arg: String| match arg.split_once('=') {
        Some((option, value)) if option.starts_with('-') => format!("{option}={}", without_folder(value)),
        _ => without_folder(&arg).to_owned(),
    };
    args.map(short).collect::<Vec<_>>().join(" ")
}

/// What follows the last separator of a path.
pub(super) fn without_folder(text: &str) -> &str {
    text.rsplit(['/', '\\']).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_stored_without_folders() {
        let args = [
            "/usr/bin/photonmap",
            "render",
            "/srv/me/a b.glb",
            "--environment=..\\sky.exr",
            "--light=-x",
            "-o",
            "out/a.exr",
        ];
        let expected = "photonmap render a b.glb --environment=sky.exr --light=-x -o a.exr";
        assert_eq!(command(args.into_iter().map(str::to_owned)), expected);
        assert_eq!(without_folder("/srv/me/sky.exr, scaled by 0.5"), "sky.exr, scaled by 0.5");
    }
}
