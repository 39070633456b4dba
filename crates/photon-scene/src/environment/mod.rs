//! Descriptions of light from infinitely far away: an image, a gradient, a constant radiance, or a clear sky with its sun.

#[cfg(feature = "files")]
mod image;
#[cfg(feature = "files")]
mod name;
#[cfg(feature = "sky")]
mod sky;
#[cfg(feature = "sky")]
mod sun;
#[cfg(all(test, feature = "sky"))]
mod tests;

#[cfg(feature = "files")]
pub use name::EnvironmentName;

use std::fmt;
use std::sync::Arc;

use photon_core::EnvironmentMap;
use photon_core::glam::DVec3;

use crate::error::SceneError;

/// Source of the light of an environment. Radiances are in W/(m²·sr), finite and ≥ 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EnvironmentSource {
    /// Equal radiance from all directions.
    Constant {
        /// The radiance.
        radiance: [f64; 3],
    },
    /// An image in latitude and longitude, in the layout of [`EnvironmentMap`].
    Image {
        /// Texels in a row, about twice the number of rows.
        width: usize,
        /// Radiance, row by row from the top.
        radiance: Arc<[[f32; 3]]>,
    },
    /// A clear sky (Hosek and Wilkie 2012) with its sun, which stands above −z before the rotation. Below the horizon is
    /// a diffuse ground of albedo 0.2, lit by both. Radiance is the sky's spectral radiance integrated over wavelength
    /// with the CIE 1931 colour matching functions (ȳ has the maximum 1), converted from XYZ to linear sRGB: luminance
    /// times 683 lm/W is in cd/m².
    #[cfg(feature = "sky")]
    Sky {
        /// Angle of the sun above the horizon, degrees, in `[0, 90]`.
        elevation_degrees: f64,
        /// Turbidity, in `[1, 10]`: 2 is very clear air, 3 a clear day, 10 haze.
        turbidity: f64,
    },
}

/// An environment: its light, turned and scaled.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EnvironmentDesc {
    /// Name in messages: the file of an image.
    pub name: String,
    /// The light.
    pub source: EnvironmentSource,
    /// Rotation in degrees, counter-clockwise as seen from +y.
    pub rotate_degrees: f64,
    /// Factor on all radiances and on the sun, finite and ≥ 0.
    pub scale: f64,
}

/// Content of an [`EnvironmentDesc`]: a map, and the sun.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Environment {
    /// Radiance by direction, without the sun.
    pub map: EnvironmentMap,
    /// The sun.
    pub sun: Option<Sun>,
}

/// A disc of constant radiance, infinitely far away: the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sun {
    /// Direction in which its light travels; not zero, need not be unit.
    pub direction: [f64; 3],
    /// Irradiance of a plane facing it, W/m², finite and ≥ 0: its radiance times `π sin² δ`.
    pub irradiance: [f64; 3],
    /// Angular radius δ of the disc in degrees, in `[0.001, 60]`.
    pub radius_degrees: f64,
}

impl Sun {
    /// Angular radius of the sun as seen from the earth, in degrees.
    pub const RADIUS_DEGREES: f64 = 0.2669;

    /// The sun with its [`Self::RADIUS_DEGREES`].
    #[must_use]
    pub fn new(direction: [f64; 3], irradiance: [f64; 3]) -> Self {
        Self { direction, irradiance, radius_degrees: Self::RADIUS_DEGREES }
    }

    /// The sun with another [`Self::radius_degrees`].
    #[must_use]
    pub fn with_radius_degrees(self, radius_degrees: f64) -> Self {
        Self { radius_degrees, ..self }
    }
}

impl EnvironmentDesc {
    fn new(name: impl Into<String>, source: EnvironmentSource) -> Self {
        Self { name: name.into(), source, rotate_degrees: 0.0, scale: 1.0 }
    }

    /// Equal radiance from all directions, W/(m²·sr).
    #[must_use]
    pub fn constant(radiance: [f64; 3]) -> Self {
        let [r, g, b] = radiance;
        Self::new(format!("constant:{r},{g},{b}"), EnvironmentSource::Constant { radiance })
    }

    /// Radiance 1 + 0.9 d·ω from direction ω, W/(m²·sr), with the unit vector d along (−2, 4, 3): brightest from above, from the
    /// left as seen along −z, and from +z, so that a model without light of its own shows its shape. The mean is 1.
    #[must_use]
    pub fn gradient() -> Self {
        const WIDTH: usize = 64;
        let towards = DVec3::new(-2.0, 4.0, 3.0).normalize_or_zero();
        let texel = |index: usize| {
            let [across, down] = [index % WIDTH, index / WIDTH].map(|at| (at as f64 + 0.5) / WIDTH as f64);
            let [(sin, cos), (sine, cosine)] =
                [across - 0.5, down].map(|turns| libm::sincos(std::f64::consts::TAU * turns));
            [(1.0 + 0.9 * towards.dot(DVec3::new(sin * sine, cosine, -cos * sine))) as f32; 3]
        };
        Self::image("gradient", WIDTH, (0..WIDTH * WIDTH / 2).map(texel).collect::<Vec<_>>())
    }

    /// Radiance from an image in latitude and longitude, `width` texels in a row.
    #[must_use]
    pub fn image(name: impl Into<String>, width: usize, radiance: impl Into<Arc<[[f32; 3]]>>) -> Self {
        Self::new(name, EnvironmentSource::Image { width, radiance: radiance.into() })
    }

    /// A clear sky, see [`EnvironmentSource::Sky`].
    #[cfg(feature = "sky")]
    #[must_use]
    pub fn sky(elevation_degrees: f64, turbidity: f64) -> Self {
        let name = format!("sky:{elevation_degrees},{turbidity}");
        Self::new(name, EnvironmentSource::Sky { elevation_degrees, turbidity })
    }

    /// The environment with this [`Self::rotate_degrees`].
    #[must_use]
    pub fn rotated(self, rotate_degrees: f64) -> Self {
        Self { rotate_degrees, ..self }
    }

    /// The environment with this [`Self::scale`].
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Checks the description and computes the map and the sun.
    ///
    /// # Errors
    /// [`SceneError::Environment`], with the name: numbers out of range, an image that is not about twice as wide as it
    /// is high, that has a texel which is negative or not finite, or more than 32,768 texels in a row; radiances beyond
    /// the range of f32.
    pub fn bake(&self) -> Result<Environment, SceneError> {
        if !self.rotate_degrees.is_finite() {
            let what = format!("its rotation is {} degrees", self.rotate_degrees);
            return Err(self.fault(what, "it must be a finite number"));
        }
        if !(self.scale >= 0.0 && self.scale.is_finite()) {
            return Err(self.fault(format!("its scale is {}", self.scale), "it must be finite and at least 0"));
        }
        match &self.source {
            EnvironmentSource::Constant { radiance } => {
                if !radiance.iter().all(|c| (0.0..=f64::from(f32::MAX)).contains(c)) {
                    let what = format!("its radiance is {radiance:?}");
                    return Err(self.fault(what, "each channel must be at least 0, and finite in 32 bits"));
                }
                let map = self.map(1, &[radiance.map(|c| c as f32)])?;
                Ok(Environment { map, sun: None })
            }
            EnvironmentSource::Image { width, radiance } => {
                Self::check_shape(&self.name, [*width, radiance.len().checked_div(*width).unwrap_or(0)])?;
                Ok(Environment { map: self.map(*width, radiance)?, sun: None })
            }
            #[cfg(feature = "sky")]
            EnvironmentSource::Sky { elevation_degrees, turbidity } => self.sky_and_sun(*elevation_degrees, *turbidity),
        }
    }

    /// Checks that an image can be one in latitude and longitude.
    fn check_shape(name: &str, [width, height]: [usize; 2]) -> Result<(), SceneError> {
        // Other projections, such as cube maps and light probes, have other shapes.
        if height > 0 && (1.9 * height as f64..=2.1 * height as f64).contains(&(width as f64)) {
            return Ok(());
        }
        Err(SceneError::Environment {
            environment: name.to_owned(),
            what: format!("it has {width} × {height} texels"),
            hint: "an image in latitude and longitude is twice as wide as it is high; convert cube maps and light probes to \
                   that projection",
        })
    }

    #[cfg(feature = "sky")]
    fn sky_and_sun(&self, elevation_degrees: f64, turbidity: f64) -> Result<Environment, SceneError> {
        if !(0.0..=90.0).contains(&elevation_degrees) {
            let what = format!("the elevation of its sun is {elevation_degrees} degrees");
            return Err(self.fault(what, "it must be between 0, at the horizon, and 90, at the zenith"));
        }
        if !(1.0..=10.0).contains(&turbidity) {
            let what = format!("its turbidity is {turbidity}");
            return Err(self.fault(what, "it must be between 1 and 10; about 3 is a clear day"));
        }
        let elevation = elevation_degrees.to_radians();
        let sky = sky::Sky::new(elevation, turbidity)
            .map_err(|why| self.fault(format!("its sky cannot be computed: {why}"), "use other parameters"))?;
        let irradiance = sun::irradiance(elevation, turbidity);
        let map = self.map(sky::WIDTH, &sky.texels(irradiance))?;
        let irradiance = irradiance.map(|c| c * self.scale);
        let turn = std::f64::consts::TAU * f64::from(map.rotation());
        let (height, beside) = (libm::sin(elevation), libm::cos(elevation));
        let direction = [beside * libm::sin(turn), -height, beside * libm::cos(turn)];
        let sun = (irradiance != [0.0; 3]).then_some(Sun::new(direction, irradiance));
        Ok(Environment { map, sun })
    }

    /// The map of these texels, scaled and rotated.
    fn map(&self, width: usize, radiance: &[[f32; 3]]) -> Result<EnvironmentMap, SceneError> {
        let invalid = |why: photon_core::Error| {
            let what = match why {
                photon_core::Error::InvalidInput { index, why, .. } => {
                    let (column, row) = (index % width.max(1) as u64, index / width.max(1) as u64);
                    format!("column {column}, row {row}: {why}")
                }
                other => other.to_string(),
            };
            self.fault(what, "correct the image, or use another")
        };
        let turns = self.rotate_degrees / 360.0;
        if self.scale == 1.0 {
            return EnvironmentMap::new(width, radiance, turns).map_err(invalid);
        }
        let greatest = radiance.iter().flatten().copied().fold(0.0, f32::max);
        if f64::from(greatest) * self.scale > f64::from(f32::MAX) && greatest.is_finite() {
            let what =
                format!("its radiance of up to {greatest:e}, times its scale of {}, exceeds 32 bits", self.scale);
            return Err(self.fault(what, "use a smaller scale"));
        }
        let scaled: Vec<[f32; 3]> =
            radiance.iter().map(|texel| texel.map(|c| (f64::from(c) * self.scale) as f32)).collect();
        EnvironmentMap::new(width, &scaled, turns).map_err(invalid)
    }

    fn fault(&self, what: String, hint: &'static str) -> SceneError {
        SceneError::Environment { environment: self.name.clone(), what, hint }
    }
}

/// The name, and rotation and scale where they differ from 0 and 1.
impl fmt::Display for EnvironmentDesc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.rotate_degrees != 0.0 {
            write!(f, ", rotated by {} degrees", self.rotate_degrees)?;
        }
        if self.scale != 1.0 {
            write!(f, ", scaled by {}", self.scale)?;
        }
        Ok(())
    }
}
