//! One pass, from photons to film, on any backend.

pub(crate) mod blocks;
pub(crate) mod error_target;
pub(crate) mod parallel_blocks;
pub(crate) mod render;

use std::time::Duration;

use crate::backend::memory::MemoryPlan;
use crate::backend::observer::Observer;
use crate::backend::stages::{Stages, View};
use crate::backend::{Stage, StageTimings, TransportBackend};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::film::confidence::ErrorPixel;
use crate::film::display::{Display, DisplayImage};
use crate::film::film_tally::FilmTally;
use crate::film::forecast::ErrorModel;
use crate::film::pass_set::PassSet;
use crate::pipeline::render::{Facts, PassEnd, Render};
use crate::radius::bandwidth;
use crate::radius::radii;
use crate::radius::schedule::Schedule;
use crate::requirements::Requirements;
use crate::requirements::features::Features;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{ErrorMoments, Estimate, PhotonRay, Query};
use crate::scene::units::Units;
use crate::settings::{Bandwidth, Settings};

/// Index of the pass from which radii are derived; no pass of a picture has this index.
const PILOT_PASS: u32 = u32::MAX;
const PILOT_PATHS: u32 = 65_536;

/// Camera paths split at the first two smooth boundaries of glass, sheets or glossy surfaces, therefore into four at most.
pub const QUERIES_PER_PIXEL: u32 = 4;

/// Renders one scene with one camera on one backend.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Pipeline<B: TransportBackend> {
    on: B,
    scene: B::Scene,
    stages: Stages<B>,
    required: Requirements,
    weights: Weights,
    settings: Settings,
    /// Paths per pass in the settings, even if fewer fit into memory or time; camera samples, shadow rays and final-gather rays
    /// likewise.
    asked: u32,
    asked_rays: [u32; 3],
    units: Units,
    view: View,
    film: B::Film,
    schedule: Schedule,
    passes: u32,
    /// The passes in the film, and whether its only one was cut short.
    contains: PassSet,
    cut: bool,
    /// Whether it has fewer camera samples than others would have.
    lacks_samples: bool,
    /// What their photons did.
    tally: FilmTally,
    batch: u32,
    setup: StageTimings,
    rays: B::Buffer<PhotonRay>,
    /// One for each required map.
    maps: Vec<MapSlot<B>>,
    state: State,
    /// The memory plan before photons were counted, and its batch size, if memory is limited.
    cap: Option<(MemoryPlan, u32)>,
    queries: B::Buffer<Query>,
    /// Most camera samples that are traced together; queries and segments of so many, once there are some.
    together: u32,
    sample_room: u32,
    sample_queries: Option<B::Buffer<Query>>,
    sample_segments: Option<B::Buffer<Query>>,
    /// Queries for the reflection of glossy surfaces, with [`crate::GlossCaustics`].
    reflections: Option<B::Buffer<Query>>,
    /// Segments in media, with [`crate::MediaStages`].
    segments: Option<B::Buffer<Query>>,
    estimates: Option<B::Buffer<Estimate>>,
    error_moments: Option<B::Buffer<ErrorMoments>>,
    points: Option<irradiance::Points<B>>,
    /// The film as it was read for a forecast after the last pass.
    read: Option<Film>,
    /// Where paths are aimed to, for other settings of the same scene; `None` if the scene or the stages of a caller aim none.
    aiming: Option<Aiming>,
    /// If each pixel has its own radius; the factors once they are known.
    bandwidth: Option<(bandwidth::Radii, Option<B::Buffer<u32>>)>,
}

mod aimed;
mod announce;
mod camera_samples;
mod check;
mod end;
mod estimate;
mod first_pass;
mod fit;
pub(crate) mod irradiance;
mod look;
mod lower;
mod medium;
mod own_radii;
mod photon_format;
mod photons;
mod pilot;
mod read;
mod slot;
mod small_pass;
mod whole_pass;
mod with_settings;

use aimed::Aiming;
use announce::Weights;
pub use medium::segments_per_pixel;
use slot::{MapSlot, State};

impl<B: TransportBackend> Pipeline<B> {
    /// Validates the scene, derives its requirements, uploads it to the backend, and derives the radii.
    ///
    /// # Errors
    /// Those of [`SceneView::validate`], [`Error::InvalidSetting`], [`Error::NoTriangles`], [`Error::NoLight`],
    /// [`Error::NoReceiver`], and errors of the backend.
    pub fn new(on: B, scene: &SceneView<'_>, view: View, settings: Settings) -> Result<Self> {
        scene.validate()?;
        let (required, batch) = (Requirements::of(scene, &settings), on.batch());
        Self::with_own_stages(on, scene, view, settings, required, batch)
    }

    /// Like [`Pipeline::new`], with more than the scene requires: the same picture, with more work.
    ///
    /// # Errors
    /// Those of [`Pipeline::new`], and [`Error::MissingFeatures`] if `required` lacks something.
    pub fn with_requirements(
        on: B,
        scene: &SceneView<'_>,
        view: View,
        settings: Settings,
        required: Requirements,
    ) -> Result<Self> {
        scene.validate()?;
        let batch = on.batch();
        Self::with_own_stages(on, scene, view, settings, required, batch)
    }

    /// Like [`Pipeline::with_requirements`], with stages chosen by the caller.
    ///
    /// # Errors
    /// Those of [`Pipeline::with_requirements`].
    pub fn with_stages(
        on: B,
        scene: &SceneView<'_>,
        view: View,
        settings: Settings,
        required: Requirements,
        stages: Stages<B>,
    ) -> Result<Self> {
        scene.validate()?;
        let batch = on.batch();
        Self::assemble(on, scene, (view.within(scene), None), settings, (required, stages), batch)
    }

    /// Like [`Pipeline::new`], with `batch` paths per batch instead of [`TransportBackend::batch`]. The picture is the
    /// same; smaller batches need less memory and are slower.
    ///
    /// # Errors
    /// Those of [`Pipeline::new`], and [`Error::InvalidSetting`] for a batch of 0 paths.
    pub fn in_batches(on: B, scene: &SceneView<'_>, view: View, settings: Settings, batch: u32) -> Result<Self> {
        if batch == 0 {
            return Err(Error::InvalidSetting {
                name: "batch",
                value: batch.to_string(),
                hint: "at least 1 path is needed",
            });
        }
        scene.validate()?;
        let required = Requirements::of(scene, &settings);
        Self::with_own_stages(on, scene, view, settings, required, batch)
    }

    /// With the backend's stages, for a scene that has been validated.
    fn with_own_stages(
        mut on: B,
        scene: &SceneView<'_>,
        view: View,
        settings: Settings,
        required: Requirements,
        batch: u32,
    ) -> Result<Self> {
        let settings = irradiance::with_points(scene, settings);
        let view = view.within(scene);
        let (stages, aiming) = aimed::stages(&mut on, (scene, view), &settings, &required, None)?;
        let mut pipeline = Self::assemble(on, scene, (view, None), settings, (required, stages), batch)?;
        pipeline.add_aiming(aiming);
        Ok(pipeline)
    }

    /// Adds whether paths are aimed, and its seconds.
    fn add_aiming(&mut self, aiming: Option<Aiming>) {
        let seconds = aiming.as_ref().filter(|_| self.required.aimed).map_or(0.0, |aiming| aiming.seconds);
        self.setup.add(Stage::Project, seconds);
        self.aiming = aiming;
    }

    /// `view` is already [`View::within`] the scene; `prepared` is the scene, if it is kept from other settings.
    fn assemble(
        mut on: B,
        scene: &SceneView<'_>,
        (view, prepared): (View, Option<B::Scene>),
        settings: Settings,
        (required, stages): (Requirements, Stages<B>),
        batch: u32,
    ) -> Result<Self> {
        settings.validate()?;
        check::check_scene(scene)?;
        view.camera.check()?;
        check::check_irradiance(scene, &settings)?;
        check::check_media(scene, &settings)?;
        required.check(Features::of(scene))?;
        required.check_format(PhotonFormat::of(scene, &settings))?;
        let required =
            Requirements { photon_format: required.photon_format.max(photon_format::least(&stages)), ..required };
        let mut film = on.film(scene.units, view.width, view.height)?;
        if settings.errors {
            on.keep_errors(&mut film)?;
        }
        on.mark(Some(Stage::Prepare));
        let prepared = match prepared {
            Some(prepared) => prepared,
            None => on.prepare(scene, &required)?,
        };
        on.mark(None);
        let pixels = u64::from(view.width) * u64::from(view.height);
        let splits = required.features.splits_camera_paths();
        let per_pixel = if splits { u64::from(QUERIES_PER_PIXEL) } else { 1 };
        let mut stages = stages;
        if !(required.gloss_caustics && stages.map.estimator.weighs_reflections()) {
            stages.gloss_caustics = None;
        }
        let weights = Weights::new(scene, &settings, &required, stages.gloss_caustics.is_some())?;
        let has_full_photons = stages.gloss_caustics.is_some() || stages.media.is_some();
        let format = if has_full_photons { PhotonFormat::Full } else { required.photon_format };
        // Two copies, in slots and compacted, and their estimates.
        let moments = if settings.errors { size_of::<ErrorMoments>() } else { 0 };
        let segment = (2 * size_of::<Query>() + size_of::<Estimate>() + moments) as u64;
        let segments = stages.media.as_ref().map_or(0, |_| u64::from(medium::segments_per_pixel(&required)));
        let (most, place) = (on.samples_together(pixels), place_bytes(per_pixel, segments));
        // Not at the cost of photons, nor where there may be one sample alone.
        let together = match settings.memory {
            None => most,
            Some(_) if settings.camera_samples == 1 => 1,
            Some(cap) => (cap / 8 / (pixels * place)).clamp(1, u64::from(most)) as u32,
        };
        let of_samples = if together > 1 { pixels * u64::from(together) * place } else { 0 };
        let costs = irradiance::costs(&on, aimed::costs(on.costs(format), &stages), &settings);
        let plan = match settings.memory {
            Some(cap) => {
                let tables: u64 = on.memory(&prepared).iter().map(|(_, bytes)| bytes).sum();
                // Error statistics: those of a query, and a copy of those of a pixel for reading the film.
                let copy = if settings.errors { size_of::<ErrorPixel>() } else { 0 };
                // As they are found, and one after another.
                let reflection = if stages.gloss_caustics.is_some() { 2 * size_of::<Query>() } else { 0 };
                let query = costs.query + (moments + reflection) as u64;
                // Factors on radii of each pixel, and seven words for their updates.
                let radii = if settings.bandwidth == Bandwidth::PerPixel { size_of::<[u32; 8]>() } else { 0 };
                let picture = pixels * (costs.pixel + (copy + radii) as u64 + per_pixel * query + segments * segment)
                    + of_samples;
                Some(MemoryPlan::new(cap, tables.saturating_add(picture), &costs)?)
            }
            None => None,
        };
        let batch = plan.map_or(batch, |plan| batch.min(plan.batch));
        let aimed = stages.aimed.as_ref().map_or(0, |aimed| aimed.paths);
        let most = settings.photons.max(PILOT_PATHS).max(aimed);
        let rays = on.alloc("photon rays", u64::from(batch.min(most)))?;
        let queries = on.alloc("queries", pixels * per_pixel)?;
        let reflections = match stages.gloss_caustics {
            Some(_) => Some(on.alloc("queries of reflections", pixels * per_pixel)?),
            None => None,
        };
        let most_estimates = pixels * per_pixel.max(segments);
        let segments = match segments {
            0 => None,
            each => Some(on.alloc("segments in media", pixels * each)?),
        };
        let any_map = required.maps.any();
        let estimates = if any_map { Some(on.alloc("estimates", most_estimates)?) } else { None };
        let error_moments = if any_map && settings.errors { Some(on.alloc("spreads", most_estimates)?) } else { None };
        let schedule = Schedule::new(settings.alpha);
        let own_radii = Self::own_radii(&settings);
        let mut pipeline = Self {
            maps: MapSlot::of(
                &settings,
                &required,
                (stages.gloss_caustics.is_some(), stages.media.is_some()),
                radii::given(&settings, &scene.units),
            ),
            units: scene.units,
            scene: prepared,
            state: State::Ready,
            cap: plan.filter(|_| any_map).map(|plan| (plan, batch)),
            on,
            stages,
            required,
            weights,
            asked: settings.photons,
            asked_rays: [settings.camera_samples, settings.shadow_rays, settings.gather_rays],
            settings,
            view,
            film,
            schedule,
            passes: 0,
            contains: PassSet::default(),
            cut: false,
            lacks_samples: false,
            tally: FilmTally::default(),
            batch,
            setup: StageTimings::default(),
            rays,
            queries,
            together,
            sample_room: 0,
            sample_queries: None,
            sample_segments: None,
            reflections,
            segments,
            estimates,
            error_moments,
            points: None,
            read: None,
            aiming: None,
            bandwidth: own_radii,
        };
        match pipeline.cap {
            Some((plan, _)) => pipeline.fit(plan)?,
            None => pipeline.allocate_maps(2.0)?,
        }
        if any_map && radii::need_pilot(&pipeline.settings) {
            pipeline.pilot()?;
        }
        pipeline.setup = pipeline.on.timings()?;
        Ok(pipeline)
    }

    /// The backend that the pipeline runs on.
    #[must_use]
    pub fn backend(&self) -> &B {
        &self.on
    }
}

impl<B: TransportBackend> Render for Pipeline<B> {
    fn pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd> {
        if self.state == State::RestartFailed {
            return Err(Error::InvalidSetting {
                name: "pass",
                value: "after a restart that ended in an error".into(),
                hint: "restart once more, or make another pipeline",
            });
        }
        if self.state == State::PassFailed {
            self.recover()?;
        }
        // Until the pass has succeeded.
        self.state = State::PassFailed;
        self.read = None;
        let end = self.whole_pass(index, observer)?;
        self.state = State::Ready;
        Ok(end)
    }

    fn film(&mut self) -> Result<Film> {
        let mut film = self.sums()?;
        film.clamp = self.settings.estimator.clamps();
        (film.contains, film.cut, film.tally) = (self.contains.clone(), self.cut, self.tally.clone());
        Ok(film)
    }

    fn display(&mut self, display: &Display) -> Result<DisplayImage> {
        self.on.read_display(&mut self.film, display, self.settings.estimator.clamps())
    }

    fn take(&mut self) -> Result<Film> {
        if self.bandwidth.is_some() {
            return Err(Error::InvalidSetting {
                name: "bandwidth",
                value: "per pixel".into(),
                hint: "passes then depend on the film of all earlier passes; use a shared bandwidth",
            });
        }
        let film = self.film()?;
        self.on.clear_film(&mut self.film)?;
        self.schedule = self.schedule.without_passes();
        (self.passes, self.contains, self.tally) = (0, PassSet::default(), FilmTally::default());
        (self.cut, self.lacks_samples) = (false, false);
        Ok(film)
    }

    fn radii(&self) -> Vec<f32> {
        self.maps.iter().map(|slot| slot.radius).collect()
    }

    fn set_radii(&mut self, radii: &[f32]) -> Result<()> {
        let invalid = |index: usize, why: String| Error::InvalidInput { what: "radius", index: index as u64, why };
        if radii.len() != self.maps.len() {
            return Err(invalid(radii.len(), format!("{} are needed, one for each map", self.maps.len())));
        }
        if let Some(index) = radii.iter().position(|radius| radius.is_nan() || *radius <= 0.0) {
            return Err(invalid(index, format!("{} must be above 0", radii[index])));
        }
        self.maps.iter_mut().zip(radii).for_each(|(slot, &radius)| (slot.radius, slot.derived) = (radius, None));
        Ok(())
    }

    fn model(&mut self, share: f64) -> Result<Option<ErrorModel>> {
        if !self.settings.errors {
            return Ok(None);
        }
        self.error_model(share)
    }

    fn rescale(&mut self, factor: f64) -> bool {
        let rescales = self.rescales();
        if rescales {
            for slot in &mut self.maps {
                slot.radius = radii::scaled(slot.radius, factor.sqrt() as f32);
            }
            self.schedule = self.schedule.scaled(factor);
        }
        rescales
    }

    fn rescales(&self) -> bool {
        // Radii of each pixel follow noise and bias anyway; with them the picture depends on the number of passes alone.
        radii::need_pilot(&self.settings) && self.bandwidth.is_none()
    }

    fn lower(&mut self, time: Duration) -> Result<Option<String>> {
        self.lowered(time)
    }

    fn facts(&self) -> Facts {
        Facts {
            backend: self.on.name(),
            device: self.on.device(),
            required: self.required,
            setup: self.setup,
            photons: self.settings.photons,
            aimed: self.aimed_paths(self.settings.photons),
            camera_samples: self.settings.camera_samples,
            shadow_rays: self.settings.shadow_rays,
            gather_rays: self.settings.gather_rays,
            memory: self.on.memory(&self.scene),
        }
    }
}

/// Bytes for a pixel of camera samples that are traced together, of so many queries and segments: these as they are found and one
/// after another, with their numbers; values; light and first surfaces.
fn place_bytes(queries: u64, segments: u64) -> u64 {
    2 * size_of::<Query>() as u64 * (queries + segments) + 12 * queries.max(segments) + 84
}
