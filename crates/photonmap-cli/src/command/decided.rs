//! Renderers whose settings are decided by the rule, and what was decided, for people and reports.

use std::time::Instant;

use photon_core::{Decision, Outcome, Pipeline, Render, Settings, TransportBackend, View};
use photon_scene::Scene;
use serde_json::{Value, json};

use crate::args::SettingsArgs;
use crate::backend::Chosen;
use crate::fault::Fault;
use crate::memory;

/// Settings that the rule decided.
#[derive(Clone, Debug)]
pub struct Decided {
    decision: Decision,
    /// Options that make the same passes, besides those that were given.
    options: String,
    /// `--target-error`, which ends the render instead of a number of passes.
    target: Option<f64>,
    /// Seconds until they were decided, with those of preparing the renderer.
    seconds: f64,
}

/// A renderer on this backend, and what was decided; `memory` is what it may allocate.
///
/// # Errors
/// Those of rendering.
pub(super) fn open(
    on: Chosen,
    open: (&SettingsArgs, Instant, bool),
    (scene, view): (&Scene, View),
    (settings, memory): (&Settings, Option<u64>),
) -> Result<(Box<dyn Render>, Option<Decided>), Fault> {
    let within = |memory| Settings { memory, ..settings.clone() };
    match on {
        Chosen::Cpu(on) => {
            // It counts the texels, which it shares with the scene: they are resident already.
            let memory = memory.map(|bytes| bytes.saturating_add(memory::texels(scene)));
            Decided::pipeline(on, open, (scene, view), &within(memory))
        }
        Chosen::Vulkan(on) => Decided::pipeline(*on, open, (scene, view), &within(memory)),
    }
}

impl Decided {
    /// Makes the renderer, whose settings are decided if `may_decide` and the options leave any open. The time of `--time` began
    /// at `begun`.
    ///
    /// # Errors
    /// Those of rendering.
    fn pipeline<B: TransportBackend>(
        on: B,
        (args, begun, may_decide): (&SettingsArgs, Instant, bool),
        (scene, view): (&Scene, View),
        settings: &Settings,
    ) -> Result<(Box<dyn Render>, Option<Self>), Fault> {
        let Some((time, fixed)) = args.open().filter(|_| may_decide) else {
            return Ok((Box::new(Pipeline::new(on, &scene.view(), view, settings.clone())?), None));
        };
        let since = Instant::now();
        let left = time.map(|time| (time - begun.elapsed().as_secs_f64()).max(0.0));
        let (renderer, decision) = Pipeline::for_time(on, &scene.view(), view, settings, (left, fixed))?;
        let decided = decision.map(|decision| {
            // A limit on memory may allow fewer paths.
            let rendered = Settings { photons: renderer.facts().photons, ..decision.settings.clone() };
            let options = args.decided_options(&rendered);
            let (target, seconds) = (args.budget.target_error, since.elapsed().as_secs_f64());
            Self { decision, options, target, seconds }
        });
        Ok((Box::new(renderer), decided))
    }

    /// All settings, given and decided.
    pub(super) fn settings(&self) -> &Settings {
        &self.decision.settings
    }

    /// Three lines: the settings, the reasons, and options.
    pub(super) fn lines(&self) -> String {
        format!("{}\nas options: {}", self.decision, self.options)
    }

    /// Options that make the same picture without `--time` and `--preset`; `None` if passes had fewer paths or rays than was
    /// decided, or the first may be incomplete. With a target, radii that pixels share are adapted to it.
    #[must_use]
    pub fn options(&self, outcome: &Outcome) -> Option<String> {
        let end = self
            .target
            .map_or_else(|| format!("--passes {}", outcome.passes), |target| format!("--target-error {target}"));
        let is_whole = outcome.passes > 1 || !outcome.cancelled;
        (outcome.lowered.is_none() && is_whole).then(|| format!("{} {end}", self.options).trim_start().to_owned())
    }

    /// For the report of a render.
    #[must_use]
    pub fn json(&self, outcome: &Outcome) -> Value {
        let first = &self.decision.first;
        json!({
            "options": self.options(outcome),
            "seconds": self.seconds,
            // Shares of the pixels, and of the light, in the first pass.
            "caustic_pixels": first.caustic_pixels,
            "direct": first.direct,
            "indirect": first.indirect,
        })
    }
}
