//! Blocks of passes by the devices of this process, into a film and its file.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use photonmap::film::{FilmInfo, Maker, save};
use photonmap::{Blocks, Error, ErrorTarget, Film, render_blocks, render_blocks_in_parallel};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::film::RawFilm;
use crate::observe::{Latch, Remote, observed, warn};
use crate::render::{PROGRAM, Renderer};

/// Renders blocks of passes and adds them to a film, which may be that of a file. Each device of the renderer takes the next
/// block when it is done with one; blocks are added in order.
///
/// `target`: error and share of pixels at which it ends. `file`: where the film is written, every so many seconds and at the
/// end, also before an exception. Returns whether the film has passes.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by one place")]
pub(crate) fn add_blocks(
    py: Python<'_>,
    film: &mut RawFilm,
    renderer: &Renderer,
    passes: (u32, u32),
    grain: u32,
    target: Option<(f64, f64)>,
    file: Option<(PathBuf, f64)>,
    observer: Option<Py<PyAny>>,
) -> PyResult<bool> {
    let blocks = Blocks::new(passes.0..passes.1, grain).map_err(Failure::from)?;
    let blocks = match target {
        Some((target, share)) => {
            blocks.with_target(ErrorTarget::new(target, share, renderer.settings()).map_err(Failure::from)?)
        }
        None => blocks,
    };
    let mut latch = Latch::default();
    let rendered = py.detach(|| {
        let mut renderers = renderer.lock();
        let renderers = renderers.get("this renderer")?;
        let known = (film.film.passes > 0).then(|| film.info.key.radii());
        renderer.check_block(&mut *renderers[0], known.as_deref())?;
        let now = renderer.info(renderers, grain, Instant::now());
        let sums = if film.film.passes > 0 {
            let path = file.as_ref().map_or_else(|| "film".into(), |(path, _)| path.clone());
            film.info.check(&now.key, &now.scene, &path)?;
            // Moved, since films are large: below it takes the place of this empty one, whatever happens between.
            Some(std::mem::replace(&mut film.film, Film::new(1, 1, renderer.units())?))
        } else {
            film.info = FilmInfo::new(now.key.clone(), &now.scene);
            None
        };
        let mut state = Sums { film: sums, info: film.info.clone(), makers: now.makers, begun: Instant::now() };
        let mut file = file.map(|(path, seconds)| File {
            path,
            every: Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX),
            written: Instant::now(),
            is_whole: true,
        });
        let result = {
            let Sums { film, info, makers, begun } = &mut state;
            observed(observer.as_ref(), &mut latch, |observer| {
                let python = observer.clone();
                let mut after_block = |film: &Film| match &mut file {
                    Some(file) => file.after_block(film, &described(info, makers, *begun), &python),
                    None => Ok(()),
                };
                match renderers.as_mut_slice() {
                    [one] => render_blocks(&mut **one, &blocks, film, observer, &mut after_block),
                    all => render_blocks_in_parallel(all, &blocks, film, observer, &mut after_block),
                }
            })
        };
        let info = described(&state.info, &state.makers, state.begun);
        let saved = match (&state.film, &file) {
            (Some(film), Some(file)) if !file.is_whole => save(&file.path, film, &info).map_err(Failure::from),
            _ => Ok(()),
        };
        if let Some(sums) = state.film {
            film.info = info;
            film.info.contains = sums.contains.clone();
            (film.film, film.refused) = (sums, None);
        }
        let result = match result {
            Ok(_) | Err(Error::Cancelled) => None,
            Err(error) => Some(PyErr::from(Failure::from(error))),
        };
        Ok::<_, Failure>((result, saved))
    });
    let (failed, saved) = rendered?;
    // What the caller raised comes first: it is why the rest failed.
    let Some(error) = latch.error.or(failed) else {
        saved?;
        return Ok(film.film.passes > 0);
    };
    if let Err(why) = saved {
        warn(py, &why.to_string())?;
    }
    Err(error)
}

/// The sums so far, and what is said of them.
struct Sums {
    film: Option<Film>,
    info: FilmInfo,
    makers: Vec<Maker>,
    begun: Instant,
}

/// The description with the seconds of this render; its sums are those of one render if one backend made them all.
fn described(info: &FilmInfo, makers: &[Maker], begun: Instant) -> FilmInfo {
    let mut info = info.clone();
    for maker in makers {
        info.in_order &= info.makers.iter().all(|known| known.backend == maker.backend);
        let seconds = begun.elapsed().as_secs_f64();
        info.add_maker(&Maker::new(PROGRAM, &maker.backend, &maker.device, seconds));
    }
    info
}

/// The film file of a render.
struct File {
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// Whether it has all blocks.
    is_whole: bool,
}

impl File {
    /// Writes the film if it is time. If that fails, as on a full disk, the previous file is whole, and rendering goes on after
    /// a warning, unless Python makes an exception of it.
    fn after_block(&mut self, film: &Film, info: &FilmInfo, python: &Remote) -> photonmap::Result<()> {
        self.is_whole = false;
        if self.written.elapsed() < self.every {
            return Ok(());
        }
        let saved = save(&self.path, film, info);
        self.written = Instant::now();
        let Err(why) = saved else {
            self.is_whole = true;
            return Ok(());
        };
        let text = format!("{}; rendering goes on", photon_image::fault::chain(&why));
        python.warn(&text)
    }
}
