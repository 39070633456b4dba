//! What was chosen for `--time`, as fixed options, and what the other settings were expected to give.

use std::fmt::Write as _;
use std::time::Instant;

use photon_core::{Area, Bandwidth, Candidate, Choice, Pipeline, Render as _, Settings, TransportBackend, View};
use photon_scene::Scene;
use serde_json::{Value, json};

use crate::args::SettingsArgs;
use crate::command::{photon_share, timed};
use crate::fault::Fault;

/// Number of candidates that `photonmap explain` lists.
const SHOWN: usize = 16;

/// The settings of a render with `--time`.
#[derive(Clone, Debug)]
pub struct TimedSettings {
    /// All settings, given and chosen.
    pub settings: Settings,
    /// Paths of a pass that are not aimed.
    photons: u32,
    /// Whether paths, areas, the factor on radii and the kind of radii were given as options.
    given: [bool; 4],
    /// What trials compared, if there was something to choose.
    choice: Option<Choice>,
    /// Seconds that were left for trials and passes.
    seconds: f64,
    /// Seconds that trials took.
    pub trials: f64,
}

impl TimedSettings {
    /// Makes the renderer, and chooses what the options leave to the program for the time that remains since `begun`.
    ///
    /// # Errors
    /// Those of rendering.
    pub(super) fn pipeline<B: TransportBackend>(
        on: B,
        (args, begun): (&SettingsArgs, Instant),
        (scene, view): (&Scene, View),
        settings: Settings,
    ) -> Result<(Pipeline<B>, Self), Fault> {
        let trying = Instant::now();
        let (on, settings) = photon_share::choose(on, args, scene, settings)?;
        let trials = trying.elapsed();
        let settings = timed::fewer_paths(args, settings);
        let renderer = Pipeline::new(on, &scene.view(), view, settings.clone())?;
        let seconds = args.budget.time.map_or(0.0, |time| (time - begun.elapsed().as_secs_f64()).max(0.0));
        let trying = Instant::now();
        let (renderer, settings, choice) = timed::choose(renderer, (args, begun), (scene, view), settings)?;
        let trials = trials + trying.elapsed();
        let photons = renderer.facts().photons;
        let estimate = &args.estimate;
        let given = [
            args.photon.photons.is_some(),
            estimate.area.is_some(),
            estimate.radius_factor.is_some(),
            estimate.bandwidth.is_some(),
        ];
        Ok((renderer, Self { settings, photons, given, choice, seconds, trials: trials.as_secs_f64() }))
    }

    /// The options that make the same passes when they are given in place of `--time`, besides those that were given.
    #[must_use]
    pub fn options(&self) -> String {
        let settings = &self.settings;
        let [photons, area, radius_factor, bandwidth] = self.given;
        let parts = [
            (photons, format!("--photons {}", self.photons)),
            (area, format!("--area {}", settings.area.name())),
            (radius_factor, format!("--radius-factor {}", settings.radius_factor)),
            (bandwidth, format!("--bandwidth {}", settings.bandwidth.name())),
            (
                !self.gathers(),
                format!("--indirect {} --gather-rays {}", settings.indirect.name(), settings.gather_rays),
            ),
        ];
        parts.into_iter().filter(|(given, _)| !given).map(|(_, text)| text).collect::<Vec<_>>().join(" ")
    }

    /// Whether final gathering was chosen.
    fn gathers(&self) -> bool {
        self.choice.as_ref().is_some_and(|choice| choice.gather_rays.is_some())
    }

    /// The same for a render of this many passes.
    #[must_use]
    pub fn with_passes(&self, passes: u32) -> String {
        format!("{} --passes {passes}", self.options()).trim_start().to_owned()
    }

    /// A line for standard error, if something was chosen by trials.
    pub(super) fn line(&self) -> Option<String> {
        let choice = self.choice.as_ref()?;
        let forecast = |text: String, is_meant: &dyn Fn(&Candidate) -> bool| {
            let best = choice.candidates.iter().find(|candidate| is_meant(candidate))?;
            Some(format!("{:.1} % with {text}", 100.0 * best.error.sqrt()))
        };
        let by_area = |area: Area| {
            forecast(format!("--area {}", area.name()), &|each| each.area == area && each.gather_rays.is_none())
        };
        let gathered = forecast("--indirect gather".to_owned(), &|each| each.gather_rays.is_some());
        let errors: Vec<String> = Area::ALL.into_iter().filter_map(by_area).chain(gathered).collect();
        Some(format!("chosen for the time: {} (forecast of the error: {})", self.options(), errors.join(", ")))
    }

    /// For `photonmap explain`: the options with the number of passes that are expected, and all that was compared.
    pub(super) fn table(&self) -> String {
        let Some(choice) = &self.choice else {
            return format!(
                "\nnothing is chosen by trials; in place of --time, with a number of passes: {}\n",
                self.options()
            );
        };
        let passes = choice.chosen().map_or(1.0, |chosen| ((self.seconds - self.trials) / chosen.seconds).max(1.0));
        let mut text = format!("\nchosen by trials of {:.1} s, in place of --time:\n", self.trials);
        let _ = writeln!(text, "  {} --passes {passes:.0}", self.options());
        if choice.bandwidth == Bandwidth::PerPixel {
            let _ = writeln!(text, "error estimates, and more paths, make passes longer: fewer of them may fit");
        }
        let _ =
            writeln!(text, "\nforecasts of the relative error with one radius for each map, and seconds of a pass:");
        let gathered = choice.candidates.iter().skip(SHOWN).find(|each| each.gather_rays.is_some());
        for candidate in choice.candidates.iter().take(SHOWN).chain(gathered) {
            let (area, factor, error) =
                (candidate.area.name(), candidate.radius_factor, 100.0 * candidate.error.sqrt());
            let gathered =
                candidate.gather_rays.map_or(String::new(), |rays| format!("  --indirect gather --gather-rays {rays}"));
            let _ = writeln!(
                text,
                "  --photons {:<8} --area {area:<8} --radius-factor {factor:<4} {error:6.2} %  {:.4} s{gathered}",
                candidate.photons, candidate.seconds
            );
        }
        text
    }

    /// For the report of a render of this many passes.
    #[must_use]
    pub fn json(&self, passes: u32) -> Value {
        let candidates = self.choice.iter().flat_map(|choice| &choice.candidates);
        json!({
            // In place of --time, these make the same picture, unless memory is limited or --errors is given with shared radii.
            "options": self.with_passes(passes),
            // Time for trials and passes, without what came before.
            "seconds": self.seconds,
            // By increasing forecast of the relative error (root mean square) after that time, with one radius for each map.
            "candidates": candidates.map(|candidate| json!({
                "photons": candidate.photons,
                "area": candidate.area.name(),
                "radius_factor": candidate.radius_factor,
                // Rays of final gathering; null where indirect light is read from a map.
                "gather_rays": candidate.gather_rays,
                "error": candidate.error.sqrt(),
                // What of it is not by photons at visible points: noise of direct light, camera paths and gather rays.
                "direct_error": candidate.direct_error.sqrt(),
                "seconds_per_pass": candidate.seconds,
            })).collect::<Vec<_>>(),
        })
    }
}
