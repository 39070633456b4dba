//! The picture of a film as a screen shows it: eight bits per channel.

use crate::error::{Error, Result};
use crate::film::Film;
use crate::film::tone_map::{ToneMap, encode_srgb};
use crate::parallel;

/// How radiance is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops: radiance is multiplied by `2^exposure`. Finite.
    pub exposure: f32,
    /// The tone curve.
    pub tone_map: ToneMap,
    /// Whether pixels have an opacity, [`Film::alpha`], by which their colour is divided; otherwise they are opaque.
    pub transparent: bool,
}

impl Display {
    /// Checks the exposure.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] if it is not finite.
    pub fn validate(&self) -> Result<()> {
        if self.exposure.is_finite() {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "exposure",
            value: self.exposure.to_string(),
            hint: "must be a finite number of stops",
        })
    }

    /// One pixel: red, green, blue in sRGB and a linear opacity. `radiance` is in W/(m²·sr), linear RGB, premultiplied
    /// with `alpha`, which counts only if the display is transparent.
    #[must_use]
    pub fn pixel(&self, radiance: [f32; 3], alpha: f32) -> [u8; 4] {
        let straight = if self.transparent { Self::straight(radiance, alpha) } else { radiance };
        self.pixel_of_straight(straight, alpha)
    }

    /// As [`Display::pixel`], of a colour that was divided by its opacity already.
    #[must_use]
    pub fn pixel_of_straight(&self, straight: [f32; 3], alpha: f32) -> [u8; 4] {
        let [r, g, b] = self.tone_map.map(self.exposure, straight).map(encode_srgb);
        let opacity = if self.transparent { (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8 } else { 255 };
        [r, g, b, opacity]
    }

    /// A colour divided by the opacity that it was multiplied with; black where that is 0.
    #[must_use]
    pub fn straight(premultiplied: [f32; 3], alpha: f32) -> [f32; 3] {
        premultiplied.map(|part| if alpha > 0.0 { part / alpha } else { 0.0 })
    }
}

/// A film as it is shown, without its sums: four bytes per pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DisplayImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Number of passes.
    pub passes: u32,
    /// `width × height` pixels, top row first: red, green, blue in sRGB, and a linear opacity; not premultiplied.
    pub pixels: Vec<[u8; 4]>,
}

impl DisplayImage {
    /// An image of these pixels, `width × height` of them.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for another number of pixels.
    pub fn new(width: u32, height: u32, passes: u32, pixels: Vec<[u8; 4]>) -> Result<Self> {
        if pixels.len() as u64 == u64::from(width) * u64::from(height) {
            return Ok(Self { width, height, passes, pixels });
        }
        let why = format!("{} pixels for an image of {width}x{height}", pixels.len());
        Err(Error::InvalidInput { what: "display image", index: pixels.len() as u64, why })
    }
}

impl Film {
    /// The picture as it is shown.
    #[must_use]
    pub fn display(&self, display: &Display) -> DisplayImage {
        self.display_clamped(display, self.clamp)
    }

    /// The same with [`Film::clamp`] given, for backends whose films do not know it.
    #[must_use]
    pub fn display_clamped(&self, display: &Display, clamp: bool) -> DisplayImage {
        let factor = self.units.radiance_to_user() / f64::from(self.passes.max(1));
        let paths = self.camera_paths();
        let pixels = parallel::collect(self.pixels.len(), |i| {
            let pixel = &self.pixels[i];
            display.pixel(pixel.radiance(factor, clamp), (pixel.hits as f64 / paths) as f32)
        });
        DisplayImage { width: self.width, height: self.height, passes: self.passes, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::units::Units;

    fn film() -> Film {
        let mut film = Film::new(2, 1, Units { power: 2.0, ..Units::default() }).unwrap();
        film.passes = 4;
        film.pixels[0].layers = [[0.1, 0.4, 1.0], [0.3; 3], [0.0; 3], [0.2; 3]];
        (film.pixels[0].hits, film.pixels[1].hits) = (1, 0);
        film
    }

    #[test]
    fn the_picture_is_exposed_curved_and_encoded() {
        let film = film();
        for tone_map in ToneMap::ALL {
            let display = Display { exposure: -1.0, tone_map, transparent: false };
            let image = film.display(&display);
            let [r, g, b] = tone_map.map(-1.0, film.beauty()[0]).map(encode_srgb);
            assert_eq!(image.pixels, [[r, g, b, 255], [0, 0, 0, 255]], "{tone_map:?}");
            assert_eq!((image.width, image.height, image.passes), (2, 1, 4));
        }
    }

    #[test]
    fn transparent_colours_are_divided_by_their_opacity() {
        let film = film();
        let display = Display { exposure: 0.0, tone_map: ToneMap::None, transparent: true };
        let [r, g, b] = film.beauty()[0].map(|part| encode_srgb(part * 4.0));
        assert_eq!(film.display(&display).pixels, [[r, g, b, 64], [0; 4]]);
    }

    #[test]
    fn clamping_comes_before_the_exposure() {
        let mut film = film();
        film.pixels[0].layers[0] = [800.0; 3];
        film.clamp = true;
        let display = Display { exposure: -1.0, tone_map: ToneMap::None, ..Display::default() };
        let half = encode_srgb(0.5);
        assert_eq!(film.display(&display).pixels[0], [half, half, half, 255]);
    }

    #[test]
    fn nonsense_is_refused() {
        for exposure in [f32::NAN, f32::INFINITY] {
            assert!(Display { exposure, ..Display::default() }.validate().is_err());
        }
        assert!(DisplayImage::new(2, 2, 1, vec![[0; 4]; 3]).is_err());
    }
}
