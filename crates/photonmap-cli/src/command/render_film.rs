//! Rendering into a film file.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use photon_core::{BlockOutcome, Film, Outcome, Render, Settings, View};
use photon_film::{FilmFileError, FilmInfo, FilmKey, Maker};
use photon_scene::Scene;

use crate::args::RenderArgs;
use crate::atomic_write;
use crate::command::{picture, render_blocks};
use crate::fault::Fault;
use crate::progress::Progress;
use crate::watch::Watch;

/// A render into a film file.
pub(super) struct FilmOfRender {
    pub(super) outcome: Outcome,
    /// The film for the pictures: that of the file, or of an interrupted block if there is no other.
    pub(super) film: Film,
    /// Whether the file is complete and contains this film; or why it could not be written.
    pub(super) filed: Result<bool, Fault>,
}

/// Checks the name of the film file, before anything is loaded.
pub(super) fn check(args: &RenderArgs) -> Result<(), Fault> {
    let Some(path) = &args.film.film else { return Ok(()) };
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("film")) {
        return Err(Fault::input(format!("{}: the name of a film file ends in .film", path.display())));
    }
    atomic_write::check(path)
}

/// Renders the blocks that are not in the file yet, and writes the file as often as asked for and at the end.
pub(super) fn run(
    path: &Path,
    args: &RenderArgs,
    (scene, view, settings): (&Scene, &View, &Settings),
    renderers: &mut [Box<dyn Render>],
    (watch, stop): (&mut Watch, &'static AtomicBool),
) -> Result<FilmOfRender, Fault> {
    let device = photon_film::device_names(renderers);
    let renderer = &mut *renderers[0];
    let facts = renderer.facts();
    render_blocks::check_memory(facts.photons, settings)?;
    let blocks = render_blocks::blocks(args, settings, facts.photons, 1)?;
    let stored = match photon_film::load(path) {
        Err(FilmFileError::Read { source, .. }) if source.kind() == ErrorKind::NotFound => None,
        result => Some(result?),
    };
    if let Some((_, info)) = &stored {
        let radii = info.key.radii();
        // Otherwise the keys differ.
        if radii.len() == renderer.radii().len() {
            renderer.set_radii(&radii)?;
        }
    }
    let key = FilmKey::new(&scene.view(), view, settings, renderer, blocks.grain());
    let (mut film, mut info) = match stored {
        Some((film, info)) => {
            info.check(&key, picture::without_folder(&args.scene.scene), path)?;
            (Some(film), info)
        }
        None => (None, FilmInfo::new(key, picture::without_folder(&args.scene.scene))),
    };
    let found = film.as_ref().map_or(&info.contains, |film| &film.contains);
    let named = |error| Fault::input(format!("{}: {error}", path.display()));
    let remaining = blocks.remaining(found, settings.seed).map_err(named)?;
    let Some(remaining) = remaining else {
        say!("{}: has all passes already", path.display());
        let film = film.ok_or_else(|| Fault::failure("no passes"))?;
        return Ok(FilmOfRender { outcome: Outcome::default(), film, filed: Ok(true) });
    };
    if let Some(other) = info.makers.iter().find(|maker| maker.backend != facts.backend) {
        say!(
            "warning: {} was begun on the backend {}; a render on one backend has other bits",
            path.display(),
            other.backend
        );
        info.in_order = false;
    }
    if let Some(film) = &film {
        say!("{}: continued after {} passes", path.display(), film.passes);
    }
    let mut file = Checkpoints { path, info, args, begun: Instant::now(), written: Instant::now(), unsaved: false };
    file.info.add_maker(&Maker::new(PROGRAM, facts.backend, &device, 0.0));
    let maker = (facts.backend, device.as_str());
    let results = render_blocks::remaining(renderers, &remaining, &mut film, (watch, stop), |film, progress| {
        file.after_block(film, maker, progress);
    });
    let filed = match &film {
        Some(film) if file.unsaved => file.save(film, maker).map(|()| true),
        Some(_) => Ok(true),
        None => Ok(false),
    };
    // The blocks before an error are in the file.
    let BlockOutcome { outcome, unfinished, .. } = results?;
    if film.is_none() {
        say!("{}: not written, since no block of {} passes was finished", path.display(), blocks.grain());
    }
    let film = film.or(unfinished).ok_or(photon_core::Error::Cancelled)?;
    Ok(FilmOfRender { outcome, film, filed })
}

const PROGRAM: &str = concat!("photonmap ", env!("CARGO_PKG_VERSION"));

/// Writes the film file from time to time.
struct Checkpoints<'a> {
    path: &'a Path,
    info: FilmInfo,
    args: &'a RenderArgs,
    begun: Instant,
    written: Instant,
    /// Whether the film has more blocks than the file.
    unsaved: bool,
}

impl Checkpoints<'_> {
    /// Writes the film if it is time. If that fails, as on a full disk, the previous file is whole, and rendering goes on.
    fn after_block(&mut self, film: &Film, maker: (&str, &str), progress: &Progress) {
        self.unsaved = true;
        if self.written.elapsed() < self.args.film.checkpoint {
            return;
        }
        if let Err(fault) = self.save(film, maker) {
            progress.say(&format!("warning: {fault}; rendering goes on"));
        }
        self.written = Instant::now();
    }

    fn save(&mut self, film: &Film, (backend, device): (&str, &str)) -> Result<(), Fault> {
        let mut info = self.info.clone();
        info.add_maker(&Maker::new(PROGRAM, backend, device, self.begun.elapsed().as_secs_f64()));
        photon_film::save(self.path, film, &info)?;
        self.unsaved = false;
        Ok(())
    }
}
