//! Settings for a desired quality, chosen from measurements.

use crate::settings::{Area, Bandwidth, Settings};

/// Desired quality of a picture. The numbers come from the measurements in `docs/studies/accuracy.md`, and those of
/// [`Preset::Preview`] in `docs/studies/first-second.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Preset {
    /// A quick preview.
    Preview,
    /// A picture for work in progress.
    Balanced,
    /// A final picture.
    Final,
}

impl Preset {
    /// The number of passes that it is meant for. The program `photonmap` makes fewer of a preview if they take long.
    #[must_use]
    pub fn passes(self) -> u32 {
        match self {
            Self::Preview => 4,
            Self::Balanced => 32,
            Self::Final => 256,
        }
    }

    /// Photon paths per pass for each pixel. The other rays of a pixel cost as much as one or two paths,
    /// and their noise decreases only with the number of passes.
    #[must_use]
    pub fn photons_per_pixel(self) -> f64 {
        match self {
            Self::Preview => 0.25,
            Self::Balanced => 0.5,
            Self::Final => 2.0,
        }
    }
}

/// Minimum number of photons per pass: with fewer, a scene with long light paths stays dark.
const MIN_PHOTONS: f64 = 20_000.0;
/// Maximum number of photons per pass: the limit of a graphics card with 8 GiB.
const MAX_PHOTONS: f64 = 16e6;

impl Settings {
    /// The settings of a preset for a picture with this many pixels.
    ///
    /// Radii and kernel are the defaults. [`Preset::Balanced`] and [`Preset::Final`] correct the energy
    /// that is lost at the edges of surfaces: this removes nearly all of the bias in a box, in less time
    /// than the additional passes that would reduce the error as much. With few passes noise dominates, and
    /// the correction is not worth its time. With [`Preset::Final`] each pixel has a radius of its own,
    /// chosen from error estimates; that takes passes, and helps most where light is smooth or sharp.
    ///
    /// With radii per pixel, passes depend on those before them, so that the sum of separately rendered
    /// films differs from the film of a single run. They require
    /// [`Estimator::Radius`](crate::Estimator::Radius), and exclude
    /// [`Indirect::Gather`](crate::Indirect::Gather): with another estimator or final gathering, use
    /// [`Bandwidth::Shared`].
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
