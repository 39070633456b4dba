//! What was chosen for a time, a preset or an error, as fixed options, and what the other settings were expected to give.

use std::fmt::Write as _;
use std::time::Instant;

use photon_core::{
    Area, Bandwidth, Candidate, Choice, Indirect, Pipeline, Render as _, Settings, TransportBackend, View,
};
use photon_scene::Scene;
use serde_json::{Value, json};

use crate::args::{Purpose, SettingsArgs};
use crate::command::choice_error::ChoiceError;
use crate::command::{photon_share, timed};

/// A preset has no more passes.
const MOST_PASSES: f64 = 1e6;

/// Number of candidates that `photonmap explain` lists.
const SHOWN: usize = 16;

/// What may be chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    /// Anything: settings of blocks of passes are fixed.
    pub(super) choices: bool,
    /// Final gathering.
    pub(super) gathering: bool,
}

/// The settings of a render, and why they were chosen.
#[derive(Clone, Debug)]
pub struct ChosenSettings {
    /// All settings, given and chosen.
    pub settings: Settings,
    /// What they were chosen for; `None` if all were fixed.
    purpose: Option<Purpose>,
    /// The passes for a preset.
    passes: Option<u32>,
    /// [`SettingsArgs::is_timed`].
    is_timed: bool,
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

impl ChosenSettings {
    /// Makes the renderer, and chooses what the options leave to the program; the time of `--time` began at `begun`.
    ///
    /// # Errors
    /// Those of rendering.
    pub(super) fn pipeline<B: TransportBackend>(
        on: B,
        (args, begun): (&SettingsArgs, Instant),
        (scene, view): (&Scene, View),
        settings: Settings,
        Allowed { choices, gathering }: Allowed,
    ) -> Result<(Pipeline<B>, Self), ChoiceError> {
        let purpose = args.purpose().filter(|_| choices);
        let trying = Instant::now();
        let (on, settings) = photon_share::choose(on, args, scene, settings)?;
        let trials = trying.elapsed();
        let settings = timed::beginning(args, settings, purpose);
        let own = chosen_parts(&settings);
        let renderer = Pipeline::new(on, &scene.view(), view, settings.clone())?;
        let seconds = args.budget.time.map_or(0.0, |time| (time - begun.elapsed().as_secs_f64()).max(0.0));
        let trying = Instant::now();
        let (renderer, settings, choice) = match purpose {
            Some(purpose) => timed::choose(renderer, (args, purpose, begun), (scene, view), settings, gathering)?,
            None => (renderer, settings, None),
        };
        let trials = trials + trying.elapsed();
        let photons = renderer.facts().photons;
        let estimate = &args.estimate;
        let given = [
            args.photon.photons.is_some(),
            estimate.area.is_some(),
            estimate.radius_factor.is_some(),
            estimate.bandwidth.is_some(),
        ];
        let seconds = choice.as_ref().map_or(seconds, |choice| choice.seconds);
        let trials = trials.as_secs_f64();
        let passes = match (purpose, &choice) {
            // Forecasts of the time are rounded.
            (Some(Purpose::Preset(preset)), Some(_)) if chosen_parts(&settings) == own => Some(preset.passes()),
            (Some(Purpose::Preset(_)), Some(choice)) => choice.chosen().map(|chosen| passes_in(choice.seconds, chosen)),
            _ => None,
        };
        let is_timed = args.is_timed();
        Ok((renderer, Self { settings, purpose, passes, is_timed, photons, given, choice, seconds, trials }))
    }

    /// The passes for a preset: as many as are expected to take the time of its own ones.
    pub(super) fn passes(&self) -> Option<u32> {
        self.passes
    }

    /// Whether it belongs in reports: settings were chosen, or fixed for a time.
    pub(super) fn is_told(&self) -> bool {
        self.choice.is_some() || self.is_timed
    }

    /// The options that make the same passes in place of those that they were chosen for, besides those that were given.
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

    /// The same for a render of this many passes. With a target, radii that pixels share are adapted to it.
    #[must_use]
    pub fn with_passes(&self, passes: u32) -> String {
        let end = match self.purpose {
            Some(Purpose::Target(target)) if self.settings.bandwidth == Bandwidth::Shared => {
                format!("--target-error {target}")
            }
            _ => format!("--passes {passes}"),
        };
        format!("{} {end}", self.options()).trim_start().to_owned()
    }

    /// What they were chosen for, in words.
    fn aim(&self) -> &'static str {
        match self.purpose {
            Some(Purpose::Preset(_)) => "the preset",
            Some(Purpose::Target(_)) => "the target",
            Some(Purpose::Time(_)) | None => "the time",
        }
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
        let seconds = match self.purpose {
            // What error estimates take is not known.
            Some(Purpose::Preset(_)) if !self.settings.errors => format!(", about {} s", short(self.seconds)),
            _ => String::new(),
        };
        let options = match self.purpose {
            Some(Purpose::Time(_)) | None => self.options(),
            Some(_) => self.with_passes(self.passes.unwrap_or_default()),
        };
        let (aim, errors) = (self.aim(), errors.join(", "));
        Some(format!("chosen for {aim}{seconds}: {options} (forecast of the error: {errors})"))
    }

    /// For `photonmap explain`: the options with the number of passes that are expected, and all that was compared.
    pub(super) fn table(&self) -> String {
        let option = self.purpose.map_or("--time", Purpose::option);
        let Some(choice) = &self.choice else {
            return match self.purpose {
                Some(Purpose::Preset(_) | Purpose::Target(_)) => "\nnothing is chosen by trials\n".to_owned(),
                Some(Purpose::Time(_)) | None => {
                    let options = self.options();
                    format!("\nnothing is chosen by trials; in place of {option}, with a number of passes: {options}\n")
                }
            };
        };
        let fit = choice.chosen().map_or(1.0, |chosen| ((self.seconds - self.trials) / chosen.seconds).max(1.0));
        let passes = self.passes.unwrap_or(fit.round() as u32);
        let mut text = format!("\nchosen by trials of {:.1} s, in place of {option}:\n", self.trials);
        let _ = writeln!(text, "  {}", self.with_passes(passes));
        if self.passes.is_some() && !self.settings.errors {
            let _ = writeln!(text, "expected time: {} s", short(self.seconds));
        }
        if self.photons != choice.photons {
            let _ = writeln!(text, "more paths make passes longer: fewer of them may fit");
        }
        let is_preset = matches!(self.purpose, Some(Purpose::Preset(_)));
        if choice.bandwidth == Bandwidth::PerPixel && (self.given[3] || is_preset) {
            let _ = writeln!(text, "forecasts are those of shared radii: with radii per pixel, passes take longer");
        }
        let _ = writeln!(text, "\nforecasts of the relative error, and seconds of a pass:");
        let gathered = choice.candidates.iter().skip(SHOWN).find(|each| each.gather_rays.is_some());
        for candidate in choice.candidates.iter().take(SHOWN).chain(gathered) {
            let (area, factor, error) =
                (candidate.area.name(), candidate.radius_factor, 100.0 * candidate.error.sqrt());
            let other = match (candidate.gather_rays, candidate.bandwidth) {
                (Some(rays), _) => format!("  --indirect gather --gather-rays {rays}"),
                (None, Bandwidth::PerPixel) => "  --bandwidth per-pixel".to_owned(),
                (None, _) => String::new(),
            };
            let _ = writeln!(
                text,
                "  --photons {:<8} --area {area:<8} --radius-factor {factor:<4} {error:6.2} %  {:.4} s{other}",
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
            // In place of what they were chosen for, these make the same picture, unless memory is limited, or errors are estimated
            // with shared radii and a limit on time.
            "options": self.with_passes(passes),
            // Time for passes; with --time for trials too, without what came before.
            "seconds": self.seconds,
            // By increasing forecast of the relative error (root mean square) after that time; that of shared radii where radii per
            // pixel were given, or are those of the preset.
            "candidates": candidates.map(|candidate| json!({
                "photons": candidate.photons,
                "area": candidate.area.name(),
                "radius_factor": candidate.radius_factor,
                "bandwidth": candidate.bandwidth.name(),
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

/// What may be chosen.
fn chosen_parts(settings: &Settings) -> (u32, Area, f64, Bandwidth, Indirect, u32) {
    let Settings { photons, area, radius_factor, bandwidth, indirect, gather_rays, .. } = *settings;
    (photons, area, radius_factor, bandwidth, indirect, gather_rays)
}

/// The passes of a candidate in a time.
fn passes_in(seconds: f64, candidate: &Candidate) -> u32 {
    (seconds / candidate.seconds.max(1e-9)).round().clamp(1.0, MOST_PASSES) as u32
}

/// Seconds with two or three digits.
fn short(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds:.1}") } else { format!("{seconds:.0}") }
}

#[cfg(test)]
mod tests {
    use backend_cpu::Cpu;
    use clap::Parser as _;
    use photon_core::{Film, Preset};

    use super::*;
    use crate::args::RenderArgs;

    fn made(options: &[&str], in_blocks: bool) -> (ChosenSettings, Film) {
        let size = ["render", "--size", "20x20"];
        let args = RenderArgs::try_parse_from(size.iter().chain(options)).unwrap().settings;
        let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
        let view = args.picture.view(&scene).unwrap();
        let on = Cpu::with_threads(1).unwrap();
        let (settings, begun) = (args.settings().unwrap(), Instant::now());
        let allowed = Allowed { choices: !in_blocks, gathering: true };
        let (mut renderer, chosen) =
            ChosenSettings::pipeline(on, (&args, begun), (&scene, view), settings, allowed).unwrap();
        (0..2).for_each(|pass| {
            renderer.pass(pass, &mut ()).unwrap();
        });
        (chosen, renderer.film().unwrap())
    }

    /// In place of a preset, the options that were chosen make the same bits.
    #[test]
    fn the_options_make_the_same_passes() {
        for preset in [["--preset", "balanced"], ["--preset", "final"]] {
            let (chosen, film) = made(&preset, false);
            assert!(chosen.choice.is_some() && chosen.passes().is_some() && chosen.is_told());
            let line = chosen.line().unwrap();
            assert!(line.starts_with("chosen for the preset") && line.contains(" --passes "), "{line}");
            let own = Settings::preset(if preset[1] == "final" { Preset::Final } else { Preset::Balanced }, 400);
            if chosen_parts(&chosen.settings)
                == chosen_parts(&Settings { gather_rays: chosen.settings.gather_rays, ..own })
            {
                let passes = if preset[1] == "final" { Preset::Final.passes() } else { Preset::Balanced.passes() };
                assert_eq!(chosen.passes(), Some(passes), "the preset's own settings have its own passes");
            }
            // Radii per pixel of a preset are forecast as if they were shared.
            let per_pixel = chosen.settings.bandwidth == Bandwidth::PerPixel;
            assert_eq!(chosen.table().contains("those of shared radii"), per_pixel, "{}", chosen.table());
            let options = chosen.with_passes(2);
            let (fixed, again) = made(&options.split(' ').collect::<Vec<_>>(), false);
            assert!(fixed.choice.is_none() && !fixed.is_told() && fixed.passes().is_none());
            assert_eq!(film.pixels, again.pixels, "{options}");
            let (_, other) = made(&[&options.split(' ').collect::<Vec<_>>()[..], &["--alpha", "0.9"]].concat(), false);
            assert_ne!(film.pixels, other.pixels, "another setting goes unnoticed");
        }
    }

    /// With a target, areas and radii may be chosen, and the target remains; the time is not that of the forecast.
    #[test]
    fn targets_remain() {
        let (chosen, _) = made(&["--target-error", "0.2", "--share", "0.5", "--photons", "3000"], false);
        assert!(chosen.settings.errors && chosen.settings.bandwidth == Bandwidth::Shared);
        assert!(chosen.with_passes(9).ends_with("--target-error 0.2"), "{}", chosen.with_passes(9));
        assert!(chosen.choice.is_some() && chosen.passes().is_none());
        // A preset with a time has its radii adapted to the time: there are no options that make the same passes.
        let (adapted, _) = made(&["--preset", "preview", "--time", "1"], false);
        assert!(adapted.choice.is_none() && !adapted.is_told());
        assert!(chosen.table().contains("in place of --target-error:"), "{}", chosen.table());
    }

    /// Passes of blocks are rendered by several processes, which would choose differently.
    #[test]
    fn blocks_have_the_settings_of_the_preset() {
        let (chosen, _) = made(&["--preset", "balanced"], true);
        let preset = Settings::preset(Preset::Balanced, 400);
        assert!(chosen.choice.is_none() && !chosen.is_told());
        assert_eq!((chosen.settings.photons, chosen.settings.area), (preset.photons, preset.area));
    }
}
