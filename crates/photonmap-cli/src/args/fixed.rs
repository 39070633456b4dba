//! Options that fix settings, and those that leave them to the rule.

use std::fmt::Write as _;

use photon_core::{Fixed, Preset, Settings};

use super::{BudgetArgs, SettingsArgs};

impl SettingsArgs {
    /// Settings that are fixed by options, and `--time`, for [`Settings::for_time`]; `None` if nothing is left to the rule. Passes
    /// or paths that are given mean these.
    #[must_use]
    pub fn open(&self) -> Option<(Option<f64>, Fixed)> {
        let BudgetArgs { preset, target_error, time, passes, total_photons, .. } = self.budget;
        if passes.is_some() || total_photons.is_some() {
            return None;
        }
        let given = Fixed {
            photons: self.photon.photons.is_some(),
            area: self.estimate.area.is_some(),
            bandwidth: self.estimate.bandwidth.is_some(),
            indirect: self.light.indirect.is_some(),
            shadow_rays: self.light.shadow_rays.is_some(),
            camera_samples: self.light.camera_samples.is_some(),
        };
        match (preset, target_error, time) {
            // Radii that pixels share are adapted to the target.
            (None, Some(_), time) => Some((time, Fixed { bandwidth: true, indirect: true, ..given })),
            (None, None, Some(_)) => Some((time, given)),
            (None | Some(Preset::Balanced), None, None) => Some((None, Fixed { photons: true, ..given })),
            (Some(Preset::Final), None, None) => Some((None, Fixed { photons: true, bandwidth: true, ..given })),
            _ => None,
        }
        .filter(|(_, fixed)| *fixed != Fixed::ALL)
    }

    /// The settings that were decided, as options, besides those that were given.
    #[must_use]
    pub fn decided_options(&self, settings: &Settings) -> String {
        let mut text = String::new();
        let mut add = |is_given: bool, name: &str, value: &dyn std::fmt::Display| {
            if !is_given {
                let _ = write!(text, " --{name} {value}");
            }
        };
        add(self.photon.photons.is_some(), "photons", &settings.photons);
        add(self.estimate.area.is_some(), "area", &settings.area);
        add(self.estimate.bandwidth.is_some(), "bandwidth", &settings.bandwidth);
        add(self.light.indirect.is_some(), "indirect", &settings.indirect);
        add(self.light.shadow_rays.is_some(), "shadow-rays", &settings.shadow_rays);
        add(self.light.camera_samples.is_some(), "camera-samples", &settings.camera_samples);
        text.trim_start().to_owned()
    }
}
