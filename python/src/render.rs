//! Renderers: a pipeline on a device, and its passes.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use photonmap::cpu::Cpu;
use photonmap::film::{FilmInfo, FilmKey, Maker};
use photonmap::scene::Scene;
use photonmap::{
    Bandwidth, Blocks, Budget, Film, Fixed, Pipeline, Plan, Render, Settings, TransportBackend, Units, View, render,
    render_blocks,
};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::error::Failure;
use crate::film::RawFilm;
use crate::gpu;
use crate::observe::{Latch, observed};
use crate::process::Local;
use crate::scene::RawScene;
use crate::settings::parse;

/// Program and version, in film files.
pub(crate) const PROGRAM: &str = concat!("photonmap for Python ", env!("CARGO_PKG_VERSION"));

/// Renderers of one scene, one for each device.
#[pyclass(frozen, module = "photonmap._photonmap")]
pub(crate) struct Renderer {
    inner: Mutex<Local<Vec<Box<dyn Render>>>>,
    scene: Arc<Scene>,
    name: String,
    view: View,
    settings: Settings,
}

#[pymethods]
impl Renderer {
    /// Uploads a scene to devices and derives the radii. `device`: GPUs as [`gpu::open`] and [`gpu::open_all`] name them, none
    /// for the CPU, and its number of threads, 0 for all cores. `open`: seconds and the names of fixed settings, if the others are
    /// decided by [`Pipeline::for_time`], on one device.
    #[new]
    #[expect(clippy::too_many_arguments, reason = "called by Python alone, by position")]
    fn new(
        py: Python<'_>,
        scene: &RawScene,
        name: &str,
        settings: &str,
        size: (u32, u32),
        camera: Option<&str>,
        device: (Vec<String>, usize),
        open: Option<(Option<f64>, Vec<String>)>,
    ) -> PyResult<Self> {
        let ((width, height), (gpus, threads)) = (size, device);
        let mut settings = parse(settings)?;
        let scene = Arc::clone(&scene.scene);
        let view = View { camera: scene.camera(camera, width, height).map_err(Failure::from)?, width, height };
        let open = open.map(|(time, given)| (time, Fixed::given(|name| given.iter().any(|each| each == name))));
        let inner = py.detach(|| start(&scene, view, &mut settings, (&gpus, threads), open))?;
        Ok(Self { inner: Mutex::new(Local::new(inner)), scene, name: name.to_owned(), view, settings })
    }

    /// Renders until the budget is spent, or the observer stops it. Returns the film, and the KeyboardInterrupt that stopped it,
    /// if one did; then there may be no film. `error`: target and share of pixels.
    fn render(
        &self,
        py: Python<'_>,
        passes: Option<u32>,
        seconds: Option<f64>,
        error: Option<(f64, f64)>,
        observer: Option<Py<PyAny>>,
    ) -> PyResult<(Option<RawFilm>, Option<Py<PyAny>>)> {
        let time = seconds.map(|seconds| {
            let time = Duration::try_from_secs_f64(seconds).ok().filter(|_| seconds > 0.0);
            time.ok_or_else(|| Failure::input(format!("time is {seconds}, but must be above 0 and finite")))
        });
        let time = time.transpose()?;
        let until = match (error, passes, time) {
            (Some((target, share_of_pixels)), ..) => Budget::Error { target, share_of_pixels },
            (None, _, Some(time)) => Budget::Time(time),
            (None, Some(passes), None) => Budget::Passes(passes),
            (None, None, None) => return Err(Failure::input("passes, time or target_error is needed").into()),
        };
        let most_time = time.filter(|_| !matches!(until, Budget::Time(_)));
        let plan = Plan { most_passes: passes, most_time, ..Plan::from(until) };
        let mut latch = Latch::default();
        let begun = Instant::now();
        let rendered = py.detach(|| {
            let mut inner = self.lock();
            let inner = &mut inner.get("this renderer")?[0];
            let outcome = observed(observer.as_ref(), &mut latch, |observer| render(&mut **inner, plan, observer));
            let outcome = match outcome {
                Err(photonmap::Error::Cancelled) => {
                    let _ = inner.take();
                    return Ok(None);
                }
                Err(error) => {
                    // Passes before the error must not be in the next film.
                    let _ = inner.take();
                    return Err(Failure::from(error));
                }
                Ok(outcome) => outcome,
            };
            let film = inner.film()?;
            let mut info = self.info(std::slice::from_ref(inner), 1, begun);
            // A GPU adds passes in another precision.
            info.in_order = info.makers.iter().all(|maker| maker.backend == "cpu") || film.passes == 1;
            let adapted = outcome.predicted.is_some_and(|forecast| forecast.radius_factor != 1.0);
            // Nothing is left for another render; with radii of its own for each pixel, it cannot be used again.
            let _ = inner.take();
            Ok(Some((film, info, adapted)))
        });
        let interrupt = match latch.error {
            Some(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Some(error.into_value(py).into_any()),
            Some(error) => return Err(error),
            None => None,
        };
        let (film, info, adapted) = match rendered {
            Ok(Some(rendered)) => rendered,
            _ if interrupt.is_some() => return Ok((None, interrupt)),
            Ok(None) => return Err(Failure::from(photonmap::Error::Cancelled).into()),
            Err(failure) => return Err(failure.into()),
        };
        let mut raw = RawFilm { film, info, refused: None };
        if self.settings.bandwidth == Bandwidth::PerPixel {
            raw.refused = Some(
                "passes with bandwidth=\"per-pixel\" depend on all passes before them, which a film file \
                                does not allow; use bandwidth=\"shared\""
                    .to_owned(),
            );
        } else if adapted {
            raw.refused = Some(
                "its radii were adapted to the target or the time, so that it cannot be continued as a \
                                film file; render a number of passes, or save a picture"
                    .to_owned(),
            );
        }
        Ok((Some(raw), interrupt))
    }

    /// Renders one block of passes; stopped by the observer, there is none.
    fn block(
        &self,
        py: Python<'_>,
        first: u32,
        grain: u32,
        radii: Option<Vec<f32>>,
        observer: Option<Py<PyAny>>,
    ) -> PyResult<Option<RawFilm>> {
        let blocks = Blocks::new(first..first.saturating_add(grain), grain).map_err(Failure::from)?;
        let mut latch = Latch::default();
        let begun = Instant::now();
        let rendered = py.detach(|| {
            let mut inner = self.lock();
            let inner = &mut inner.get("this renderer")?[0];
            self.check_block(&mut **inner, radii.as_deref())?;
            let mut film: Option<Film> = None;
            let rendered = observed(observer.as_ref(), &mut latch, |observer| {
                render_blocks(&mut **inner, &blocks, &mut film, observer, &mut |_| Ok(()))
            });
            match rendered {
                Ok(_) | Err(photonmap::Error::Cancelled) => {}
                Err(error) => return Err(Failure::from(error)),
            }
            Ok(film.map(|film| (film, self.info(std::slice::from_ref(inner), grain, begun))))
        });
        if let Some(error) = latch.error {
            return Err(error);
        }
        Ok(rendered?.map(|(film, info)| RawFilm { film, info, refused: None }))
    }

    /// A film without passes, whose key is that of the blocks of a render with these radii, or with its own.
    #[pyo3(signature = (grain, radii=None))]
    fn empty(&self, py: Python<'_>, grain: u32, radii: Option<Vec<f32>>) -> PyResult<RawFilm> {
        let made = py.detach(|| {
            let mut inner = self.lock();
            let inner = inner.get("this renderer")?;
            if let Some(radii) = radii.filter(|radii| radii.len() == inner[0].radii().len()) {
                inner[0].set_radii(&radii)?;
            }
            let film = Film::new(self.view.width, self.view.height, self.scene.units())?;
            let info = self.info(inner, grain, Instant::now());
            Ok::<_, Failure>(RawFilm { film, info, refused: Some("it has no passes".to_owned()) })
        });
        Ok(made?)
    }

    /// Name of the backend, description of the device, paths per pass.
    fn facts(&self, py: Python<'_>) -> PyResult<(String, String, u32)> {
        // A render in another thread holds this lock while it waits for that of the interpreter.
        let facts = py.detach(|| Ok::<_, Failure>(self.lock().get("this renderer")?[0].facts()))?;
        Ok((facts.backend.to_owned(), facts.device, facts.photons))
    }
}

impl Renderer {
    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    pub(crate) fn units(&self) -> Units {
        self.scene.units()
    }

    /// The renderers, at least one. Without the lock of the interpreter: a render holds them while it waits for that.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Local<Vec<Box<dyn Render>>>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prepares a renderer for blocks of a film with these radii, if they are known, and checks that its passes do not depend on
    /// memory.
    pub(crate) fn check_block(&self, renderer: &mut dyn Render, radii: Option<&[f32]>) -> Result<(), Failure> {
        if let Some(radii) = radii.filter(|radii| radii.len() == renderer.radii().len()) {
            renderer.set_radii(radii)?;
        }
        let photons = renderer.facts().photons;
        if photons < self.settings.photons {
            return Err(Failure::input(format!(
                "memory: only {photons} paths a pass fit the limit, and passes of a film must not depend on it; give \
                 photons={photons}"
            )));
        }
        Ok(())
    }

    /// What the passes depend on, and who rendered them.
    pub(crate) fn info(&self, renderers: &[Box<dyn Render>], grain: u32, begun: Instant) -> FilmInfo {
        let key = FilmKey::new(&self.scene.view(), &self.view, &self.settings, &*renderers[0], grain);
        let mut info = FilmInfo::new(key, &self.name);
        let facts = renderers[0].facts();
        let device = photonmap::film::device_names(renderers);
        info.add_maker(&Maker::new(PROGRAM, facts.backend, &device, begun.elapsed().as_secs_f64()));
        info
    }
}

/// Renderers on these devices; `settings` get what is decided.
fn start(
    scene: &Scene,
    view: View,
    settings: &mut Settings,
    (gpus, threads): (&[String], usize),
    open: Option<(Option<f64>, Fixed)>,
) -> Result<Vec<Box<dyn Render>>, Failure> {
    if gpus.is_empty() {
        let on = if threads == 0 { Cpu::new()? } else { Cpu::with_threads(threads)? };
        return Ok(vec![decided(on, scene, view, settings, open)?]);
    }
    let mut devices = gpu::open_all(gpus)?;
    if devices.len() == 1
        && let Some(on) = devices.pop()
    {
        return Ok(vec![decided(on, scene, view, settings, open)?]);
    }
    let settings = &*settings;
    // They compile their kernels at the same time.
    std::thread::scope(|threads| {
        let start = |on| threads.spawn(move || pipeline(on, scene, view, settings));
        let starting: Vec<_> = devices.into_iter().map(start).collect();
        let joined = starting
            .into_iter()
            .map(|renderer| renderer.join().map_err(|_| Failure::device("a device failed while it was prepared"))?);
        joined.collect()
    })
}

fn decided<B: TransportBackend>(
    on: B,
    scene: &Scene,
    view: View,
    settings: &mut Settings,
    open: Option<(Option<f64>, Fixed)>,
) -> Result<Box<dyn Render>, Failure> {
    let Some(open) = open else { return pipeline(on, scene, view, settings) };
    let (renderer, decision) = Pipeline::for_time(on, &scene.view(), view, settings, open)?;
    if let Some(decision) = decision {
        *settings = decision.settings;
    }
    Ok(Box::new(renderer))
}

fn pipeline<B: TransportBackend>(
    on: B,
    scene: &Scene,
    view: View,
    settings: &Settings,
) -> Result<Box<dyn Render>, Failure> {
    Ok(Box::new(Pipeline::new(on, &scene.view(), view, settings.clone())?))
}
