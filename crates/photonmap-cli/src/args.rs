//! The options of `photonmap render` and `photonmap explain`.

use std::time::Duration;

use clap::Parser;
use clap::builder::TypedValueParser;
use photon_core::{Bandwidth, Budget, Estimator, IndexKind, Indirect, Paper, Plan, Preset, Settings};

use crate::exposure::Exposure;
use crate::fault::Fault;

mod environment;
mod film;
mod fixed;
mod groups;
pub mod set;
#[cfg(test)]
mod tests;
mod values;
mod watch;

pub use environment::EnvironmentArgs;
pub use film::FilmArgs;
pub use groups::{BudgetArgs, EstimateArgs, LightArgs, MachineArgs, OutputArgs, PhotonArgs, PictureArgs, SceneArgs};
pub use values::PassRange;
pub use watch::{ServeAddress, WatchArgs};

/// Parser of the names of photon map data structures.
pub(crate) fn index_names() -> impl TypedValueParser<Value = IndexKind> {
    values::choice(IndexKind::ALL.map(IndexKind::name))
}

/// Preset if none is given.
pub const PRESET: Preset = Preset::Balanced;

/// `--preset preview` has fewer passes on the CPU if they would end later than this after the start of the program.
const QUICK_LOOK: Duration = Duration::from_secs(2);

/// The options that determine the settings.
#[derive(Clone, Debug, clap::Args)]
pub struct SettingsArgs {
    /// Size and camera.
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Quality and stopping criteria.
    #[command(flatten)]
    pub budget: BudgetArgs,
    /// Photon tracing.
    #[command(flatten)]
    pub photon: PhotonArgs,
    /// Density estimation.
    #[command(flatten)]
    pub estimate: EstimateArgs,
    /// Direct and indirect light.
    #[command(flatten)]
    pub light: LightArgs,
    /// Any further option, such as --set max-bounces=8; may be repeated.
    ///
    /// `photonmap man render` describes them: light-units, aperture, focus, share, total-photons, caustic-photons,
    /// caustic-roughness, max-bounces, seed, rng, scheduling, estimator, k, radius, radius-factor, alpha, kernel,
    /// area, bandwidth, max-plane-distance, index, paper-threshold, paper-factor, direct, camera-samples,
    /// shadow-rays, no-terminator-offset, gather-rays, irradiance-every, environment-scale, portal, grain, preview,
    /// tev.
    // The program replaces it by that option before arguments are parsed: `set::expanded`.
    #[arg(long, value_name = "NAME[=VALUE]", hide_short_help = true, help_heading = "Further settings")]
    pub set: Vec<String>,
}

/// Render a scene and write the picture.
#[derive(Clone, Debug, Parser)]
#[command(name = "render")]
pub struct RenderArgs {
    /// The scene to render.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Output files.
    #[command(flatten)]
    pub files: OutputArgs,
    /// Film file.
    #[command(flatten)]
    pub film: FilmArgs,
    /// Render settings.
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Backend, threads and memory.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Where the picture is shown while it is rendered.
    #[command(flatten)]
    pub watch: WatchArgs,
    /// Same as `photonmap scenes`.
    #[arg(long, hide = true)]
    pub list: bool,
    /// Same as `photonmap devices`.
    #[arg(long, hide = true)]
    pub devices: bool,
    /// Same as `photonmap explain`.
    #[arg(long, hide = true)]
    pub explain: bool,
}

/// Show what a scene requires with these settings, what is left out and why, and, unless passes or paths are given, which
/// settings are decided. No picture is made.
#[derive(Clone, Debug, Parser)]
#[command(name = "explain")]
pub struct ExplainArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Render settings.
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Where the first pass is rendered, by which settings are decided.
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl SettingsArgs {
    /// Converts the options to the library's settings.
    ///
    /// # Errors
    /// [`Fault::Input`], which names the option with an invalid value.
    pub fn settings(&self) -> Result<Settings, Fault> {
        let Self { picture, budget, photon, estimate, light, set } = self;
        if let Some(first) = set.first() {
            return Err(Fault::input(format!("--set {first}: this program has no --set; give --{first}")));
        }
        let estimator = self.estimator()?;
        let paper = matches!(estimator, Estimator::Paper(_));
        let pixels = u64::from(picture.size.0) * u64::from(picture.size.1);
        let base = match budget.preset {
            Some(_) if paper => {
                return Err(Fault::input(
                    "--preset: --estimator paper has its own parameters; leave out one of the two",
                ));
            }
            None if paper => Settings::paper(),
            preset => Settings::preset(preset.unwrap_or(PRESET), pixels),
        };
        if budget.passes.is_some_and(|passes| passes.count == 0) {
            return Err(Fault::input("--passes is 0, but at least 1 is needed"));
        }
        if let Some(time) = budget.time.filter(|time| !(*time > 0.0 && time.is_finite())) {
            return Err(Fault::input(format!("--time is {time}, but must be above 0 and finite")));
        }
        let irradiance_every = light.irradiance_every.or(base.irradiance_every);
        let indirect = light.indirect.unwrap_or(base.indirect);
        let derived = matches!(estimator, Estimator::Radius { radius: None }) && irradiance_every.is_none();
        // With a preset and a time, radii are adapted to the time, which requires error estimates.
        let adapts = derived && budget.preset.is_some() && budget.passes.is_none() && budget.time.is_some();
        let bandwidth = match estimate.bandwidth {
            Some(bandwidth) => bandwidth,
            // Neither final gathering nor the k nearest photons have a radius per pixel.
            None if indirect == Indirect::Gather || !matches!(estimator, Estimator::Radius { .. }) => Bandwidth::Shared,
            None => base.bandwidth,
        };
        let settings = Settings {
            errors: budget.errors || budget.target_error.is_some() || adapts || bandwidth == Bandwidth::PerPixel,
            photons: photon.photons.unwrap_or(base.photons),
            estimator,
            radius_factor: estimate.radius_factor.unwrap_or(base.radius_factor),
            kernel: estimate.kernel.unwrap_or(base.kernel),
            index: estimate.index.unwrap_or(base.index),
            direct: light.direct,
            indirect,
            bandwidth,
            area: estimate.area.unwrap_or(base.area),
            max_plane_distance: estimate.max_plane_distance.or(base.max_plane_distance),
            caustic_photons: photon.caustic_photons.unwrap_or(base.caustic_photons),
            caustic_roughness: photon.caustic_roughness.or(base.caustic_roughness),
            max_bounces: photon.max_bounces.unwrap_or(base.max_bounces),
            seed: photon.seed,
            alpha: if paper { base.alpha } else { estimate.alpha.unwrap_or(base.alpha) },
            scheduling: photon.scheduling.unwrap_or(base.scheduling),
            random: photon.rng.unwrap_or(base.random),
            camera_samples: light.camera_samples.unwrap_or(base.camera_samples),
            shadow_rays: light.shadow_rays.unwrap_or(base.shadow_rays),
            gather_rays: light.gather_rays.unwrap_or(base.gather_rays),
            irradiance_every,
            terminator_offset: base.terminator_offset && !light.no_terminator_offset,
            ..base
        };
        settings.validate()?;
        self.plan(None).validate()?;
        Ok(settings)
    }

    /// The estimator with its parameters from the options.
    fn estimator(&self) -> Result<Estimator, Fault> {
        let given = &self.estimate;
        if given.k == Some(0) {
            return Err(Fault::input("--k is 0, but at least 1 is needed (2 for knn)"));
        }
        Ok(match given.estimator {
            Estimator::Radius { .. } => Estimator::Radius { radius: given.radius },
            Estimator::Knn { k, .. } => Estimator::Knn { k: given.k.unwrap_or(k), max_radius: given.radius },
            Estimator::Paper(paper) => Estimator::Paper(Paper {
                max: given.k.unwrap_or(paper.max),
                radius: given.radius,
                threshold: given.paper_threshold,
                factor: given.paper_factor,
                clamp: paper.clamp,
            }),
        })
    }

    /// Time limit of `--preset preview` on the CPU, from the start of the program; `None` with another preset or another end.
    #[must_use]
    pub fn quick_look(&self) -> Option<Duration> {
        let BudgetArgs { preset, target_error, time, passes, total_photons, .. } = self.budget;
        let alone = target_error.is_none() && time.is_none() && passes.is_none() && total_photons.is_none();
        (alone && preset == Some(Preset::Preview)).then_some(QUICK_LOOK)
    }

    /// The stopping criteria; `time` is what remains of `--time`.
    #[must_use]
    pub fn plan(&self, time: Option<Duration>) -> Plan {
        let budget = &self.budget;
        let passes = budget.passes.map(|passes| passes.count);
        let until = match (budget.target_error, budget.total_photons, time, passes) {
            (Some(target), ..) => Budget::Error { target, share_of_pixels: budget.share },
            (None, Some(photons), ..) => Budget::Photons(photons),
            (None, None, Some(time), _) => Budget::Time(time),
            (None, None, None, passes) => {
                Budget::Passes(passes.unwrap_or_else(|| budget.preset.unwrap_or(PRESET).passes()))
            }
        };
        let first = budget.passes.map_or(0, |passes| passes.first);
        let most_time = time.filter(|_| !matches!(until, Budget::Time(_)));
        Plan { first, until, most_passes: passes, most_time }
    }
}

impl OutputArgs {
    /// Checks what can be checked without access to the file system.
    ///
    /// # Errors
    /// [`Fault::Input`] for an exposure that is not finite.
    pub fn check(&self) -> Result<(), Fault> {
        match self.exposure {
            Exposure::Stops(stops) if !stops.is_finite() => {
                Err(Fault::input(format!("--exposure is {stops}, but must be finite")))
            }
            _ => Ok(()),
        }
    }
}
