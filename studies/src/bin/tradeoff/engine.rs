//! One backend, reused for all renders: a driver may refuse a program that opens its devices many times.

use std::time::Instant;

use backend_cpu::Cpu;
use backend_vulkan::Vulkan;
use photon_core::{Budget, Film, Outcome, Pipeline, Plan, Render, Settings, TransportBackend, View, render};
use photon_scene::Scene;
use photonmap_cli::backend::BackendName;
use photonmap_cli::backend::{self, Chosen};
use photonmap_cli::fault::Fault;

/// A backend between renders; `None` after a failure.
pub(crate) enum Engine {
    Cpu(Option<Cpu>),
    Vulkan(Option<Box<Vulkan>>),
}

/// A scene and its camera.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) view: View,
}

/// Results of a render besides its picture.
pub(crate) struct Details {
    /// Results of the passes.
    pub(crate) seconds: f64,
    pub(crate) outcome: Outcome,
}

impl Subject {
    /// A built-in scene in a square picture.
    pub(crate) fn new(name: &str, size: u32) -> Result<Self, Fault> {
        let builder = photon_scene::builtin(name);
        let scene = builder.ok_or_else(|| Fault::input(format!("{name}: no built-in scene has that name")))?.build()?;
        let view = View { camera: scene.camera(None, size, size)?, width: size, height: size };
        Ok(Self { name: name.to_owned(), scene, view })
    }
}

impl Engine {
    pub(crate) fn open(name: BackendName) -> Result<Self, Fault> {
        Ok(match backend::open(name, None)? {
            Chosen::Cpu(on) => Self::Cpu(Some(on)),
            Chosen::Vulkan(on) => Self::Vulkan(Some(on)),
        })
    }

    /// Short name of the backend, and its device.
    pub(crate) fn names(&self) -> (&'static str, String) {
        fn of<B: TransportBackend>(on: Option<&B>) -> (&'static str, String) {
            on.map_or_else(|| ("none", String::new()), |on| (on.name(), on.device()))
        }
        match self {
            Self::Cpu(on) => of(on.as_ref()),
            Self::Vulkan(on) => of(on.as_deref()),
        }
    }

    /// Renders; the backend can be reused afterwards.
    pub(crate) fn film(
        &mut self,
        subject: &Subject,
        settings: &Settings,
        plan: impl Into<Plan>,
    ) -> Result<(Film, Details), Fault> {
        let (mut films, details) = self.films_at(subject, settings, &[plan.into()])?;
        Ok((films.pop().ok_or_else(gone)?, details))
    }

    /// Renders several plans in sequence: the film after each, and the results of the last one, with all passes and
    /// paths.
    pub(crate) fn films_at(
        &mut self,
        subject: &Subject,
        settings: &Settings,
        plans: &[Plan],
    ) -> Result<(Vec<Film>, Details), Fault> {
        match self {
            Self::Cpu(place) => {
                let (films, details, on) = run(place.take().ok_or_else(gone)?, subject, settings, plans)?;
                *place = Some(on);
                Ok((films, details))
            }
            Self::Vulkan(place) => {
                let (films, details, on) = run(*place.take().ok_or_else(gone)?, subject, settings, plans)?;
                *place = Some(Box::new(on));
                Ok((films, details))
            }
        }
    }

    /// Renders once for each seed from 1 on. Scene and kernels are prepared once, with one discarded warm-up pass;
    /// `each` receives the results.
    pub(crate) fn films(
        &mut self,
        subject: &Subject,
        (settings, passes): (&Settings, u32),
        seeds: u32,
        each: impl FnMut(&Film, Details),
    ) -> Result<(), Fault> {
        match self {
            Self::Cpu(place) => {
                *place = Some(runs(place.take().ok_or_else(gone)?, subject, (settings, passes), seeds, each)?);
            }
            Self::Vulkan(place) => {
                let on = runs(*place.take().ok_or_else(gone)?, subject, (settings, passes), seeds, each)?;
                *place = Some(Box::new(on));
            }
        }
        Ok(())
    }

    /// Calls `work` with the backend.
    pub(crate) fn with<W: Work>(&mut self, work: W) -> Result<W::Output, Fault> {
        match self {
            Self::Cpu(on) => work.on(on.as_mut().ok_or_else(gone)?),
            Self::Vulkan(on) => work.on(on.as_deref_mut().ok_or_else(gone)?),
        }
    }
}

/// An operation that works with any backend.
pub(crate) trait Work {
    type Output;
    fn on<B: TransportBackend>(self, on: &mut B) -> Result<Self::Output, Fault>;
}

fn gone() -> Fault {
    Fault::Failure("the backend was lost by a render that failed".into())
}

fn run<B: TransportBackend>(
    on: B,
    subject: &Subject,
    settings: &Settings,
    plans: &[Plan],
) -> Result<(Vec<Film>, Details, B), Fault> {
    let mut pipeline = Pipeline::new(on, &subject.scene.view(), subject.view, settings.clone())?;
    let (mut films, mut details) = (Vec::new(), Details { seconds: 0.0, outcome: Outcome::default() });
    for plan in plans {
        let begun = Instant::now();
        let mut outcome = render(&mut pipeline, *plan, &mut ())?;
        details.seconds += begun.elapsed().as_secs_f64();
        outcome.passes += details.outcome.passes;
        outcome.paths += details.outcome.paths;
        details.outcome = outcome;
        films.push(pipeline.film()?);
    }
    Ok((films, details, pipeline.into_backend()?))
}

fn runs<B: TransportBackend>(
    on: B,
    subject: &Subject,
    (settings, passes): (&Settings, u32),
    seeds: u32,
    mut each: impl FnMut(&Film, Details),
) -> Result<B, Fault> {
    let scene = subject.scene.view();
    let mut pipeline = Pipeline::new(on, &scene, subject.view, settings.clone())?;
    render(&mut pipeline, Budget::Passes(1), &mut ())?;
    for seed in 1..=seeds {
        pipeline.restart(&scene, u64::from(seed))?;
        let begun = Instant::now();
        let outcome = render(&mut pipeline, Budget::Passes(passes), &mut ())?;
        let seconds = begun.elapsed().as_secs_f64();
        each(&pipeline.film()?, Details { seconds, outcome });
    }
    Ok(pipeline.into_backend()?)
}
