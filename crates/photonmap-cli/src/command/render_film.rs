//! Rendering into a film file.
#![expect(clippy::print_stderr, reason = "warnings go to standard error")]

use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use photon_core::{
    Bandwidth, BlockOutcome, Blocks, Budget, Event, Film, Outcome, Render, Settings, View, render_blocks,
};
use photon_film::{FilmFileError, FilmInfo, FilmKey, Maker};
use photon_scene::Scene;

use crate::args::RenderArgs;
use crate::atomic_write;
use crate::fault::Fault;
use crate::progress::{Limit, Progress};

/// A render into a film file.
pub(super) struct FilmOfRender {
    pub(super) outcome: Outcome,
    /// The film for the pictures: that of the file, or of an interrupted block if there is no other.
    pub(super) film: Film,
    /// Whether the file is complete and contains this film; or why it could not be written.
    pub(super) filed: Result<bool, Fault>,
}

/// Checks the options, before anything is loaded: what stops a render or changes its passes must not depend on time, nor
/// on passes that are not in the film.
pub(super) fn check(args: &RenderArgs, settings: &Settings) -> Result<(), Fault> {
    let Some(path) = &args.film.film else { return Ok(()) };
    let budget = &args.settings.budget;
    for (option, given) in [("--time", budget.time.is_some()), ("--target-error", budget.target_error.is_some())] {
        if given {
            return Err(Fault::input(format!(
                "{option}: the passes of a film must not depend on when it is interrupted; with --film, give --passes"
            )));
        }
    }
    if settings.bandwidth == Bandwidth::PerPixel {
        return Err(Fault::input(
            "--bandwidth per-pixel: passes then depend on all passes before them, which a film file does not allow; with \
             --film, give --bandwidth shared",
        ));
    }
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("film")) {
        return Err(Fault::input(format!("{}: the name of a film file ends in .film", path.display())));
    }
    blocks(args, settings.photons)?;
    atomic_write::check(path)
}

/// The blocks that the options ask for, with this many paths per pass.
fn blocks(args: &RenderArgs, photons: u32) -> Result<Blocks, Fault> {
    let plan = args.settings.plan(None);
    let count = match plan.until {
        Budget::Photons(all) => {
            let passes = u32::try_from(all.div_ceil(u64::from(photons.max(1)))).unwrap_or(u32::MAX);
            plan.most_passes.map_or(passes, |most| most.min(passes))
        }
        _ => plan.passes(),
    };
    let count = count.min(u32::MAX - 1 - plan.first);
    Ok(Blocks::new(plan.first..plan.first + count, args.film.grain)?)
}

/// Renders the blocks that are not in the file yet, and writes the file as often as asked for and at the end.
pub(super) fn run(
    path: &Path,
    args: &RenderArgs,
    (scene, view, settings): (&Scene, &View, &Settings),
    renderer: &mut dyn Render,
    stop: &AtomicBool,
) -> Result<FilmOfRender, Fault> {
    let facts = renderer.facts();
    if facts.photons < settings.photons {
        return Err(Fault::input(format!(
            "--memory: only {0} paths a pass fit the limit; with --film, give --photons {0}",
            facts.photons
        )));
    }
    let blocks = blocks(args, facts.photons)?;
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
            info.key.check(&key, path)?;
            (Some(film), info)
        }
        None => (None, FilmInfo::new(key, &args.scene.scene)),
    };
    let found = film.as_ref().map_or(&info.contains, |film| &film.contains);
    let named = |error| Fault::input(format!("{}: {error}", path.display()));
    let remaining = blocks.remaining(found, settings.seed).map_err(named)?;
    let Some(remaining) = remaining else {
        eprintln!("{}: has all passes already", path.display());
        let film = film.ok_or_else(|| Fault::failure("no passes"))?;
        return Ok(FilmOfRender { outcome: Outcome::default(), film, filed: Ok(true) });
    };
    if let Some(other) = info.makers.iter().find(|maker| maker.backend != facts.backend) {
        eprintln!(
            "warning: {} was begun on the backend {}; a render on one backend has other bits",
            path.display(),
            other.backend
        );
        info.in_order = false;
    }
    if let Some(film) = &film {
        eprintln!("{}: continued after {} passes", path.display(), film.passes);
    }
    let mut file = Checkpoints { path, info, args, begun: Instant::now(), written: Instant::now(), unsaved: false };
    file.info.add_maker(&Maker::new(PROGRAM, facts.backend, &facts.device, 0.0));
    let maker = (facts.backend, facts.device.as_str());
    let results = render_remaining(renderer, &remaining, &mut film, stop, |film, progress| {
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
        eprintln!("{}: not written, since no block of {} passes was finished", path.display(), blocks.grain());
    }
    let film = film.or(unfinished).ok_or(photon_core::Error::Cancelled)?;
    Ok(FilmOfRender { outcome, film, filed })
}

const PROGRAM: &str = concat!("photonmap ", env!("CARGO_PKG_VERSION"));

/// Renders blocks and shows the progress.
fn render_remaining(
    renderer: &mut dyn Render,
    blocks: &Blocks,
    film: &mut Option<Film>,
    stop: &AtomicBool,
    mut after_block: impl FnMut(&Film, &Progress),
) -> photon_core::Result<BlockOutcome> {
    let passes = blocks.passes();
    let progress = std::cell::RefCell::new(Progress::new(Limit::Passes(passes.end - passes.start)));
    let mut observer = |event: &Event<'_>| {
        match event {
            Event::PassDone(pass) => progress.borrow_mut().passes(pass.index + 1 - passes.start),
            Event::Warning(text) => progress.borrow().say(&format!("warning: {text}")),
            _ => {}
        }
        if stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let results = render_blocks(renderer, blocks, film, &mut observer, &mut |film| {
        after_block(film, &progress.borrow());
        Ok(())
    });
    progress.into_inner().finish();
    results
}

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
