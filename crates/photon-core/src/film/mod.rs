//! The film on the host: sums in f64, which can be merged.

pub(crate) mod confidence;
pub(crate) mod display;
pub(crate) mod film_tally;
pub(crate) mod forecast;
pub(crate) mod pass_set;
pub(crate) mod tone_map;

use crate::error::{Error, Result};
use crate::film::confidence::ErrorPixel;
use crate::film::film_tally::FilmTally;
use crate::film::pass_set::PassSet;
use crate::scene::units::Units;
use crate::{memory, parallel};
use bytemuck::Zeroable;

/// Version of the numerics, which stored films record: raised with each change that alters the bits of passes (*Numerics*
/// in the changelog), so that films of two versions are not merged.
pub const NUMERICS: u32 = 13;

/// The layers of a picture. Each light path belongs to exactly one; their sum is the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Layer {
    /// Light sources seen directly, or by way of mirrors and glass only.
    Emission,
    /// Light that reaches the first visible diffuse surface directly.
    Direct,
    /// Light that reaches that surface by way of mirrors and glass only.
    Caustic,
    /// Light that was scattered diffusely before.
    Indirect,
}

impl Layer {
    /// All layers, in the order in which they are summed.
    pub const ALL: [Self; 4] = [Self::Emission, Self::Direct, Self::Caustic, Self::Indirect];

    /// The name of the layer in a file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
        }
    }
}

/// Sums over passes for one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
// Exhaustive: a backend must fill in every sum.
pub struct FilmPixel {
    /// Radiance by [`Layer`], normalised units.
    pub layers: [[f64; 3]; 4],
    /// Sum over passes of the squared radiance, mean of RGB.
    pub square: f64,
    /// Unit normal of the first visible surface, on the visible side; as the following, a sum over camera paths.
    pub normal: [f64; 3],
    /// Albedo of the first visible surface.
    pub albedo: [f64; 3],
    /// Distance to the first visible surface, normalised length.
    pub depth: f64,
    /// Number of camera paths that hit a surface.
    pub hits: u64,
}

impl FilmPixel {
    /// Adds the sums of `other`.
    pub fn add(&mut self, other: &Self) {
        for (a, b) in self.layers.iter_mut().flatten().zip(other.layers.iter().flatten()) {
            *a += b;
        }
        for axis in 0..3 {
            self.normal[axis] += other.normal[axis];
            self.albedo[axis] += other.albedo[axis];
        }
        self.square += other.square;
        self.depth += other.depth;
        self.hits += other.hits;
    }

    /// Radiance with all layers, each rounded to f32 after multiplication by `factor`, in their order.
    fn radiance(&self, factor: f64, clamp: bool) -> [f32; 3] {
        let mut sum = [0.0_f32; 3];
        for layer in &self.layers {
            (0..3).for_each(|c| sum[c] += (layer[c] * factor) as f32);
        }
        if clamp { sum.map(|value| value.clamp(0.0, 1.0)) } else { sum }
    }
}

/// A film: sums over passes, top row first.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width × height` pixels.
    pub pixels: Vec<FilmPixel>,
    /// Error statistics of each pixel, if enabled.
    pub errors: Option<Vec<ErrorPixel>>,
    /// Number of passes in the sums.
    pub passes: u32,
    /// Camera paths of a pixel in each pass: [`crate::Settings::camera_samples`].
    pub camera_samples: u32,
    /// Which passes these are; empty if that is not known, as for a film that was filled by hand.
    pub contains: PassSet,
    /// Whether its only pass was cut short, with fewer photons or camera samples than the settings ask for. Such a film can be
    /// shown, but neither merged nor stored.
    pub cut: bool,
    /// What the photons of these passes did.
    pub tally: FilmTally,
    /// Conversion to user space and watts.
    pub units: Units,
    /// Whether colours are clamped to `[0, 1]` when read, as in Lin and Wang 2010.
    pub clamp: bool,
}

impl Film {
    /// An empty film.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for a picture without pixels, or with more than 2³¹ of them;
    /// [`Error::OutOfMemory`].
    pub fn new(width: u32, height: u32, units: Units) -> Result<Self> {
        check_size(width, height)?;
        let count = width as usize * height as usize;
        // Not written until it is used, which may be by many threads.
        let pixels = memory::zeroed(count, "film")?;
        Ok(Self {
            width,
            height,
            pixels,
            errors: None,
            passes: 0,
            camera_samples: 1,
            contains: PassSet::default(),
            cut: false,
            tally: FilmTally::default(),
            units,
            clamp: false,
        })
    }

    /// A copy.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn try_clone(&self) -> Result<Self> {
        let pixels = memory::copied(&self.pixels, "copy of the film")?;
        let errors = self.errors.as_deref().map(|errors| memory::copied(errors, "copy of the film: errors"));
        let Self { width, height, passes, camera_samples, cut, units, clamp, .. } = *self;
        let (contains, tally) = (self.contains.clone(), self.tally.clone());
        let errors = errors.transpose()?;
        Ok(Self { width, height, pixels, errors, passes, camera_samples, contains, cut, tally, units, clamp })
    }

    /// Adds the passes of another film. If [`Film::contains`] is empty for one of them, the caller has to make sure that
    /// they are different passes. The caller also makes sure that scene, view and settings are the same.
    ///
    /// # Errors
    /// The film is unchanged then. [`Error::InvalidSetting`] if size, units or camera samples differ, or only one of them has error
    /// statistics; [`Error::CutPass`] if the pass of one of them was cut short; [`Error::PassTwice`] if both contain a
    /// pass.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if self.cut || other.cut {
            return Err(Error::CutPass);
        }
        if (self.width, self.height, self.units) != (other.width, other.height, other.units) {
            return Err(Error::InvalidSetting {
                name: "merged film",
                value: format!("{}x{}, {:?}", other.width, other.height, other.units),
                hint: "must have the size and the units of the film that it is merged into",
            });
        }
        if self.errors.is_some() != other.errors.is_some() {
            return Err(Error::InvalidSetting {
                name: "merged film",
                value: (if self.errors.is_some() { "without errors" } else { "with errors" }).into(),
                hint: "must have error statistics if and only if the film that it is merged into has them",
            });
        }
        if self.passes > 0 && other.passes > 0 && self.camera_samples != other.camera_samples {
            return Err(Error::InvalidSetting {
                name: "merged film",
                value: format!("{} camera samples a pass", other.camera_samples),
                hint: "must have the camera samples of the film that it is merged into",
            });
        }
        self.contains.merge(&other.contains)?;
        if other.passes > 0 {
            self.camera_samples = other.camera_samples;
        }
        for (mine, theirs) in self.errors.iter_mut().flatten().zip(other.errors.iter().flatten()) {
            mine.add(theirs);
        }
        for (mine, theirs) in self.pixels.iter_mut().zip(&other.pixels) {
            mine.add(theirs);
        }
        self.passes += other.passes;
        self.tally.merge(&other.tally);
        Ok(())
    }

    /// One layer, W/(m²·sr), linear RGB.
    #[must_use]
    pub fn layer(&self, layer: Layer) -> Vec<[f32; 3]> {
        let factor = self.units.radiance_to_user() / f64::from(self.passes.max(1));
        self.each(|p| p.layers[layer as usize].map(|sum| (sum * factor) as f32))
    }

    /// The picture, W/(m²·sr), linear RGB: exactly the sum of the layers, in their order, in f32.
    #[must_use]
    pub fn beauty(&self) -> Vec<[f32; 3]> {
        let factor = self.units.radiance_to_user() / f64::from(self.passes.max(1));
        self.each(|p| p.radiance(factor, self.clamp))
    }

    /// Number of camera paths of a pixel, at least 1.
    pub(crate) fn camera_paths(&self) -> f64 {
        f64::from(self.passes.max(1)) * f64::from(self.camera_samples)
    }

    /// A value of each pixel, by all cores.
    fn each<T: Send>(&self, value: impl Fn(&FilmPixel) -> T + Sync) -> Vec<T> {
        parallel::collect(self.pixels.len(), |i| value(&self.pixels[i]))
    }

    /// Standard error of each pixel's mean over the passes so far, mean of RGB, W/(m²·sr);
    /// infinite before the second pass.
    #[must_use]
    pub fn standard_error(&self) -> Vec<f32> {
        let n = f64::from(self.passes);
        let factor = self.units.radiance_to_user();
        self.each(|p| {
            let mean = p.layers.iter().flatten().sum::<f64>() / 3.0 / n;
            let variance = ((p.square / n - mean * mean) / (n - 1.0)).max(0.0);
            if self.passes < 2 { f32::INFINITY } else { (variance.sqrt() * factor) as f32 }
        })
    }

    /// Share of the camera rays that hit a surface, in `[0, 1]`. With [`crate::Settings::transparent_background`], or
    /// without an environment, the picture is premultiplied with it: the rest of a pixel is black.
    #[must_use]
    pub fn alpha(&self) -> Vec<f32> {
        let paths = self.camera_paths();
        self.each(|p| (p.hits as f64 / paths) as f32)
    }

    /// Mean distance to the first surface, user space; infinite where no surface was hit.
    #[must_use]
    pub fn depth(&self) -> Vec<f32> {
        self.each(|p| if p.hits == 0 { f32::INFINITY } else { (p.depth / p.hits as f64 * self.units.scale) as f32 })
    }

    /// Mean normal of the first surface, normalised, or 0.
    #[must_use]
    pub fn normal(&self) -> Vec<[f32; 3]> {
        self.pixels
            .iter()
            .map(|p| {
                let length = p.normal.iter().map(|x| x * x).sum::<f64>().sqrt();
                p.normal.map(|x| if length > 0.0 { (x / length) as f32 } else { 0.0 })
            })
            .collect()
    }

    /// Mean albedo of the first surface; 0 where no surface was hit.
    #[must_use]
    pub fn albedo(&self) -> Vec<[f32; 3]> {
        let n = self.camera_paths();
        self.each(|p| p.albedo.map(|x| (x / n) as f32))
    }
}

/// Checks the size of a picture.
///
/// # Errors
/// [`Error::InvalidSetting`] if it has no pixels or more than 2³¹.
pub fn check_size(width: u32, height: u32) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > 1 << 31 {
        return Err(Error::InvalidSetting {
            name: "size",
            value: format!("{width}x{height}"),
            hint: "must be at least 1x1 and at most 2^31 pixels",
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_sum_to_the_picture_and_merging_is_addition() {
        let mut film = Film::new(2, 1, Units { power: 3.0, scale: 2.0, ..Units::default() }).unwrap();
        film.pixels[0].layers = [[1.0, 2.0, 3.0], [0.5; 3], [0.25; 3], [0.125; 3]];
        film.passes = 1;
        let once = film.beauty();
        assert_eq!(once[0], [1.875 * 0.75, 2.875 * 0.75, 3.875 * 0.75]);
        let other = film.clone();
        film.merge(&other).unwrap();
        assert_eq!(film.beauty(), once);
        assert_eq!(film.passes, 2);
        assert!(film.merge(&Film::new(1, 2, film.units).unwrap()).is_err());
        let eight = Film { camera_samples: 8, ..film.clone() };
        assert!(film.merge(&eight).unwrap_err().to_string().contains("8 camera samples"));
        let mut empty = Film::new(2, 1, film.units).unwrap();
        empty.merge(&eight).unwrap();
        assert_eq!((empty.camera_samples, film.passes), (8, 2));
    }

    #[test]
    fn a_pass_counts_once_and_a_cut_one_never() {
        let of = |passes: std::ops::Range<u32>| {
            let mut film = Film::new(1, 1, Units::default()).unwrap();
            film.pixels[0].hits = 1;
            (film.passes, film.contains) = (passes.end - passes.start, PassSet::of(7, passes));
            (film.tally.passes, film.tally.photons.emitted) = (film.passes, 10);
            film
        };
        let mut film = of(0..4);
        let before = film.clone();
        assert!(matches!(film.merge(&of(3..5)), Err(Error::PassTwice { seed: 7, .. })));
        let cut = Film { cut: true, ..of(4..5) };
        assert!(matches!(film.merge(&cut), Err(Error::CutPass)));
        assert!(matches!(cut.clone().merge(&film), Err(Error::CutPass)));
        assert_eq!(film, before);
        film.merge(&of(4..5)).unwrap();
        assert_eq!((film.passes, film.contains, film.pixels[0].hits), (5, PassSet::of(7, 0..5), 2));
        assert_eq!((film.tally.passes, film.tally.photons.emitted), (5, 20));
    }

    #[test]
    fn absurd_sizes_are_refused() {
        for (w, h) in [(0, 0), (0, 5), (5, 0), (1 << 20, 1 << 20)] {
            assert!(Film::new(w, h, Units::default()).is_err());
        }
    }
}
