//! Renderers.

use std::ffi::{c_char, c_void};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use photonmap::film::{FilmInfo, FilmKey, Maker};
use photonmap::scene::Scene;
use photonmap::{Decision, Event, Film, Fixed, PassEnd, Pipeline, Render, Settings, TransportBackend, View};

use crate::device::{Device, open};
use crate::error::{Fault, PmStatus, Result, call, free, length};
use crate::film::PmFilm;
use crate::options::{self, PmDevice, PmProgress, PmProgressFunction, PmView};
use crate::pointer;
use crate::scene::PmScene;

/// Photon paths between two calls of the progress function on the CPU.
const BATCH: u32 = 1 << 15;

/// A renderer of one scene, with the sums of its passes. One thread at a time may use it.
#[expect(missing_debug_implementations, reason = "a boxed renderer")]
pub struct PmRenderer {
    renderer: Box<dyn Render>,
    scene: Arc<Scene>,
    view: View,
    settings: Settings,
    /// The pass after the last one in the film, while passes are in ascending order.
    next: Option<u32>,
    /// The settings that were lowered for the time.
    report: String,
}

impl PmRenderer {
    fn new(scene: Arc<Scene>, view: View, settings: Settings, device: Device) -> Result<Self> {
        let renderer: Box<dyn Render> = match device {
            Device::Cpu(cpu) => Box::new(Pipeline::in_batches(cpu, &scene.view(), view, settings.clone(), BATCH)?),
            Device::Vulkan(gpu) => Box::new(Pipeline::new(*gpu, &scene.view(), view, settings.clone())?),
        };
        Ok(Self { renderer, scene, view, settings, next: Some(0), report: String::new() })
    }

    /// With settings that are decided by the facts of a first pass, and passes that end within the time.
    fn for_time(scene: Arc<Scene>, view: View, settings: Settings, device: Device, open: (f64, Fixed)) -> Result<Self> {
        fn made<B: TransportBackend>(
            on: B,
            (scene, view): (&Scene, View),
            settings: &Settings,
            (seconds, fixed): (f64, Fixed),
        ) -> Result<(Box<dyn Render>, Option<Decision>)> {
            let open = (Some(seconds), fixed);
            let (renderer, decision) = Pipeline::for_time(on, &scene.view(), view, settings, open)?;
            Ok((Box::new(renderer), decision))
        }
        let begun = Instant::now();
        let (mut renderer, decision) = match device {
            Device::Cpu(cpu) => made(cpu, (&scene, view), &settings, open)?,
            Device::Vulkan(gpu) => made(*gpu, (&scene, view), &settings, open)?,
        };
        let left = Duration::try_from_secs_f64(open.0).unwrap_or(Duration::MAX).saturating_sub(begun.elapsed());
        let report = renderer.lower(left)?.unwrap_or_default();
        let settings = decision.map_or(settings, |decision| decision.settings);
        Ok(Self { renderer, scene, view, settings, next: Some(0), report })
    }

    /// Renders passes; the number of those that were finished goes to `done`.
    fn passes(&mut self, first: u32, count: u32, progress: &Progress, done: &mut u32) -> Result {
        let end = first.checked_add(count).filter(|&end| end < u32::MAX);
        let end = end.ok_or_else(|| Fault::argument(format!("passes {first} and {count} more exceed 2^32 - 2")))?;
        let cancelled = || Fault::new(PmStatus::Cancelled, "the progress function stopped the render");
        for index in first..end {
            let finished = *done;
            let mut observer = |event: &Event<'_>| match event {
                Event::Photons { pass, traced, total } => {
                    let report = PmProgress {
                        size: size_of::<PmProgress>(),
                        pass: *pass,
                        done: finished,
                        count,
                        traced: *traced,
                        total: *total,
                    };
                    progress.call(&report)
                }
                _ => ControlFlow::Continue(()),
            };
            let last = match self.renderer.pass(index, &mut observer)? {
                PassEnd::Cancelled => return Err(cancelled()),
                end => matches!(end, PassEnd::Last(_)),
            };
            *done += 1;
            self.next = self.next.filter(|&next| index >= next).map(|_| index + 1);
            if last {
                return if index + 1 < end { Err(cancelled()) } else { Ok(()) };
            }
        }
        Ok(())
    }

    fn film(&self, film: Film) -> Result<PmFilm> {
        let facts = self.renderer.facts();
        let key = FilmKey::new(&self.scene.view(), &self.view, &self.settings, &*self.renderer, 1);
        let mut info = FilmInfo::new(key, "");
        info.add_maker(&Maker::new("photonmap-c", facts.backend, &facts.device, 0.0));
        // On other devices, sums are not those of films of one pass.
        info.in_order = facts.backend == "cpu" && self.next.is_some();
        info.errors = film.errors.is_some();
        info.clamp = film.clamp;
        Ok(PmFilm { film, info, transparent: self.settings.transparent_background })
    }
}

/// The caller's progress function.
struct Progress {
    function: PmProgressFunction,
    user: *mut c_void,
}

impl Progress {
    fn call(&self, report: &PmProgress) -> ControlFlow<()> {
        let Some(function) = self.function else { return ControlFlow::Continue(()) };
        // SAFETY: the caller promises that the function can be called during pm_renderer_passes(), on the same thread.
        let code = unsafe { function(self.user, report) };
        if code == 0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

/// Makes a renderer: opens the device, uploads the scene, and traces a pilot pass if radii are derived.
///
/// `settings`: a JSON object of settings, such as `{"photons": 100000, "errors": true}`; fields that are left out have
/// their defaults, and unknown ones are an error. NULL: all defaults. `device` may be NULL: the CPU. The scene may be
/// freed before the renderer. `*renderer` is to be freed with pm_renderer_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_new(
    scene: *const PmScene,
    view: *const PmView,
    settings: *const c_char,
    device: *const PmDevice,
    renderer: *mut *mut PmRenderer,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, structs and texts, and pointer to a handle.
        unsafe {
            pointer::hand_out(renderer, || {
                let (scene, view) = (&pointer::shared(scene, "scene")?.scene, seen(scene, view)?);
                PmRenderer::new(scene.clone(), view, options::settings(settings)?, open(device)?)
            })
        }
    })
}

/// Makes a renderer as pm_renderer_new() does, for about `seconds` of rendering, above 0 and finite, which begin now: settings that
/// `settings` leaves out are decided by the facts of a first pass, which is in no film, and passes that would take more than half
/// of the time have fewer paths and rays than are asked for: pm_renderer_report(). Passes are then rendered by
/// pm_renderer_passes() as long as there is time. Which settings were decided may depend on the speed of the machine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_for_time(
    scene: *const PmScene,
    view: *const PmView,
    seconds: f64,
    settings: *const c_char,
    device: *const PmDevice,
    renderer: *mut *mut PmRenderer,
) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, structs and texts, and pointer to a handle.
        unsafe {
            pointer::hand_out(renderer, || {
                if !(seconds > 0.0 && seconds.is_finite()) {
                    return Err(Fault::argument(format!("seconds is {seconds}, but must be above 0 and finite")));
                }
                let (scene, view) = (&pointer::shared(scene, "scene")?.scene, seen(scene, view)?);
                let (settings, fixed) = options::given_settings(settings)?;
                PmRenderer::for_time(scene.clone(), view, settings, open(device)?, (seconds, fixed))
            })
        }
    })
}

/// The view of a picture.
///
/// # Safety
/// `scene` and `view` are NULL or valid.
unsafe fn seen(scene: *const PmScene, view: *const PmView) -> Result<View> {
    // SAFETY: as the caller ensures.
    unsafe {
        let scene = &pointer::shared(scene, "scene")?.scene;
        let view = pointer::read(view)?;
        let camera = pointer::text_or_null(view.camera, "camera")?;
        let (width, height) = (view.width, view.height);
        Ok(View { camera: scene.camera(camera, width, height)?, width, height })
    }
}

/// Renders the passes `first` to `first + count - 1` and adds them to the film. A pass depends on its index alone, so that
/// passes may be distributed over renderers and machines.
///
/// `progress` may be NULL, and `user` is passed to it. `*done`, which may be NULL, is the number of passes that were
/// finished, even after an error. If the first pass of a film is stopped, the film has what was traced of it: such a film
/// can be shown, but neither merged nor written to a film file, and is to be taken before further passes if these have several
/// camera samples.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_passes(
    renderer: *mut PmRenderer,
    first: u32,
    count: u32,
    progress: PmProgressFunction,
    user: *mut c_void,
    done: *mut u32,
) -> PmStatus {
    let mut finished = 0;
    let status = call(|| {
        // SAFETY: the caller's handle.
        let renderer = unsafe { pointer::exclusive(renderer, "renderer") }?;
        renderer.passes(first, count, &Progress { function: progress, user }, &mut finished)
    });
    if !done.is_null() {
        // SAFETY: not NULL; the caller's number.
        unsafe { done.write(finished) };
    }
    status
}

/// Copies the film: the sums of all passes since the last pm_renderer_take(). `*film` is to be freed with pm_film_free().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_film(renderer: *mut PmRenderer, film: *mut *mut PmFilm) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, and pointer to a handle.
        unsafe {
            pointer::hand_out(film, || {
                let renderer = pointer::exclusive(renderer, "renderer")?;
                let film = renderer.renderer.film()?;
                renderer.film(film)
            })
        }
    })
}

/// As pm_renderer_film(), and the renderer begins an empty film.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_take(renderer: *mut PmRenderer, film: *mut *mut PmFilm) -> PmStatus {
    call(|| {
        // SAFETY: the caller's handle, and pointer to a handle.
        unsafe {
            pointer::hand_out(film, || {
                let renderer = pointer::exclusive(renderer, "renderer")?;
                let film = renderer.renderer.take()?;
                let film = renderer.film(film);
                renderer.next = Some(0);
                film
            })
        }
    })
}

/// Copies a description of the device: as pm_last_error().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_device(renderer: *const PmRenderer, text: *mut c_char, room: usize) -> usize {
    length(|| {
        // SAFETY: the caller's handle.
        let facts = unsafe { pointer::shared(renderer, "renderer") }?.renderer.facts();
        // SAFETY: the caller's buffer of `room` bytes.
        Ok(unsafe { pointer::copy_text(&format!("{}: {}", facts.backend, facts.device), text, room) })
    })
}

/// Copies what pm_renderer_for_time() has lowered, or nothing: as pm_last_error().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_report(renderer: *const PmRenderer, text: *mut c_char, room: usize) -> usize {
    // SAFETY: the caller's handle, and buffer of `room` bytes.
    length(|| Ok(unsafe { pointer::copy_text(&pointer::shared(renderer, "renderer")?.report, text, room) }))
}

/// Frees a renderer; NULL is ignored. Films that it returned stay valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_renderer_free(renderer: *mut PmRenderer) {
    // SAFETY: the caller's handle.
    free(|| unsafe { pointer::free(renderer) });
}
