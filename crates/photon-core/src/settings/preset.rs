//! Settings for a need, from what was measured.

use crate::settings::{Area, Bandwidth, Settings};

/// How good a picture is to be. The numbers come from `docs/studies/accuracy.md`, which has the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Preset {
    /// A first look.
    Preview,
    /// A picture to work with.
    Balanced,
    /// A picture to keep.
    Final,
}

impl Preset {
    /// How many passes it is meant for.
    #[must_use]
    pub fn passes(self) -> u32 {
        match self {
            Self::Preview => 4,
            Self::Balanced => 64,
            Self::Final => 256,
        }
    }

    /// Paths per pass for each pixel. Its other rays cost as much as one or two paths, and their noise falls with
    /// the passes alone.
    #[must_use]
    pub fn photons_per_pixel(self) -> f64 {
        match self {
            Self::Preview => 1.0,
            Self::Balanced | Self::Final => 2.0,
        }
    }
}

/// Photons of a pass, at least: fewer leave a scene of any depth unlit.
const MIN_PHOTONS: f64 = 20_000.0;
/// And at most, as far as a graphics card with 8 GiB goes.
const MAX_PHOTONS: f64 = 16e6;

impl Settings {
    /// The settings of a preset for a picture of so many pixels.
    ///
    /// Radii and kernel are the default ones. From [`Preset::Balanced`] on what is lost at the ends of surfaces is
    /// given back: nearly all of the bias in a box, for less time than the passes that would come to as little error. Few passes are
    /// noise above all, and are better off without. For [`Preset::Final`] each pixel finds a radius of its own, for which
    /// errors are told; that takes passes, and is worth most where light is smooth or sharp.
    ///
    /// With radii of pixels passes depend on those before them, so that films of parts are not what one run gives.
    /// They are for [`Estimator::Radius`](crate::Estimator::Radius), and do not go with
    /// [`Indirect::Gather`](crate::Indirect::Gather): who asks for either of these takes [`Bandwidth::Shared`].
    ///
    /// ```
    /// use photon_core::{Budget, Preset, Settings};
    /// let settings = Settings::preset(Preset::Preview, 640 * 480);
    /// let budget = Budget::passes(Preset::Preview.passes());
    /// assert!(settings.validate().is_ok() && budget == Budget::Passes(4));
    /// ```
    #[must_use]
    pub fn preset(preset: Preset, pixels: u64) -> Self {
        let photons = (preset.photons_per_pixel() * pixels as f64).clamp(MIN_PHOTONS, MAX_PHOTONS) as u32;
        let base = Self { photons, ..Self::default() };
        match preset {
            Preset::Preview => base,
            Preset::Balanced => Self { area: Area::Surface, ..base },
            Preset::Final => Self { area: Area::Surface, bandwidth: Bandwidth::PerPixel, errors: true, ..base },
        }
    }
}
