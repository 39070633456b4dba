//! The clear sky of Hosek and Wilkie, "An Analytic Model for Full Spectral Sky-Dome Radiance" (SIGGRAPH 2012), in its
//! version for linear RGB.
//!
//! The crate hw-skymodel has the fitted coefficients. The formula is evaluated here in f64, with functions whose results
//! are the same on every platform.

use std::f64::consts::PI;

use hw_skymodel::rgb::{Error, SkyParams, SkyState};

/// Texels in a row.
pub(super) const WIDTH: usize = 1024;
/// Rows.
const HEIGHT: usize = 512;
/// Albedo of the ground, which brightens the sky too.
pub(super) const GROUND: f64 = 0.2;

/// The sky for one elevation of the sun and turbidity.
pub(super) struct Sky {
    /// The nine coefficients of each channel, in the order of the crate.
    coefficients: [[f64; 9]; 3],
    /// Mean radiance of each channel.
    means: [f64; 3],
    /// Sine and cosine of the elevation.
    elevation: (f64, f64),
}

impl Sky {
    /// `elevation` in radians.
    pub(super) fn new(elevation: f64, turbidity: f64) -> Result<Self, Error> {
        let quarter = std::f32::consts::FRAC_PI_2;
        let albedo = [GROUND as f32; 3];
        let params = SkyParams { elevation: (elevation as f32).min(quarter), turbidity: turbidity as f32, albedo };
        let (coefficients, means) = SkyState::new(&params)?.raw();
        Ok(Self {
            coefficients: std::array::from_fn(|channel| {
                std::array::from_fn(|index| f64::from(coefficients[9 * channel + index]))
            }),
            means: means.map(f64::from),
            elevation: (libm::sin(elevation), libm::cos(elevation)),
        })
    }

    /// Radiance from above the horizon; `height` is the cosine of the angle to the zenith, > 0, and `to_sun` of that to
    /// the sun.
    pub(super) fn radiance(&self, height: f64, to_sun: f64) -> [f64; 3] {
        let to_sun = to_sun.clamp(-1.0, 1.0);
        let angle = libm::acos(to_sun);
        let root = libm::sqrt(height);
        std::array::from_fn(|channel| {
            let [a, b, c, d, e, f, g, i, h] = self.coefficients[channel];
            // χ of the paper: the forward scattering of aerosols.
            let spread = 1.0 + h * h - 2.0 * h * to_sun;
            let aureole = (1.0 + to_sun * to_sun) / (spread * libm::sqrt(spread));
            let horizon = 1.0 + a * libm::exp(b / (height + 0.01));
            let around = c + d * libm::exp(e * angle) + f * to_sun * to_sun + g * aureole + i * root;
            // Saturated colours around a low sun are outside of sRGB.
            (self.means[channel] * horizon * around).max(0.0)
        })
    }

    /// The image of the sky and of the ground, without the sun; `sun` is its irradiance on a plane facing it.
    pub(super) fn texels(&self, sun: [f64; 3]) -> Vec<[f32; 3]> {
        let (sine, cosine) = self.elevation;
        let step = PI / HEIGHT as f64;
        let mut texels = Vec::with_capacity(WIDTH * HEIGHT);
        let mut irradiance = [0.0; 3];
        let mut half = [[0.0; 3]; WIDTH / 2];
        for row in 0..HEIGHT / 2 {
            let theta = (row as f64 + 0.5) * step;
            let (height, beside) = (libm::cos(theta), libm::sin(theta));
            // φ = 2π (u − ½), and the sky is symmetric about φ = 0.
            for (column, texel) in half.iter_mut().enumerate() {
                let phi = 2.0 * PI * ((column as f64 + 0.5) / WIDTH as f64 - 0.5);
                *texel = self.radiance(height, height * sine + libm::cos(phi) * beside * cosine);
                let weight = 2.0 * height * beside * step * (2.0 * PI / WIDTH as f64);
                irradiance = std::array::from_fn(|c| irradiance[c] + texel[c] * weight);
            }
            texels.extend(half.iter().chain(half.iter().rev()).map(|texel| texel.map(|c| c as f32)));
        }
        let ground: [f64; 3] = std::array::from_fn(|c| GROUND / PI * (irradiance[c] + sine * sun[c]));
        texels.resize(WIDTH * HEIGHT, ground.map(|c| c as f32));
        texels
    }
}
