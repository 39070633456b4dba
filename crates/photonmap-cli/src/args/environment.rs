//! The options of the environment: light from infinitely far away.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use photon_scene::{EnvironmentDesc, LoadOptions, LoadReport, SceneError};

/// Light from infinitely far away.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Scene")]
pub struct EnvironmentArgs {
    /// Light from all around: an .exr or .hdr image in latitude and longitude, `constant`, `constant:R,G,B`, or a clear
    /// sky with its sun, `sky:ELEVATION,TURBIDITY`.
    ///
    /// It is added to the lights of the scene, and replaces the environment of the override file. The centre of an image
    /// is seen along -z; its values are radiance in W/(m²·sr). ELEVATION of the sun is 0 to 90 degrees, TURBIDITY 1 to 10
    /// (3: a clear day); the sun stands above -z.
    #[arg(long, value_name = "FILE|constant[:R,G,B]|sky:E,T")]
    pub environment: Option<EnvironmentName>,
    /// Rotate the environment, in degrees, counter-clockwise as seen from +y.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        requires = "environment",
        hide_short_help = true
    )]
    pub environment_rotate: f64,
    /// Factor on the light of the environment.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        requires = "environment",
        hide_short_help = true
    )]
    pub environment_scale: f64,
    /// Name of a material or mesh whose triangles fill openings, such as windows, through which the light of the environment
    /// enters: its photons start there more often. May be repeated.
    ///
    /// Wherever portals are, the same light enters on average; in a room with small windows there is much less noise. Radii
    /// of estimates follow the photons, so that their bias changes: where photons are few, the mean by 1.7 % in one room.
    #[arg(long = "portal", value_name = "NAME", hide_short_help = true)]
    pub portals: Vec<String>,
}

/// The value of `--environment`.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentName {
    /// An image.
    File(PathBuf),
    /// The same radiance from all directions.
    Constant([f64; 3]),
    /// Elevation of the sun in degrees, and turbidity.
    Sky(f64, f64),
}

impl FromStr for EnvironmentName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            |list: &str| -> Option<Vec<f64>> { list.split(',').map(|part| part.trim().parse().ok()).collect() };
        if text == "constant" {
            return Ok(Self::Constant([1.0; 3]));
        }
        if let Some(list) = text.strip_prefix("constant:") {
            return match numbers(list).as_deref() {
                Some(&[r, g, b]) => Ok(Self::Constant([r, g, b])),
                Some(&[grey]) => Ok(Self::Constant([grey; 3])),
                _ => Err("give three numbers, such as constant:1,1,0.9, or one for all channels".to_owned()),
            };
        }
        if text == "sky" || text.starts_with("sky:") {
            return match text.strip_prefix("sky:").and_then(numbers).as_deref() {
                Some(&[elevation, turbidity]) => Ok(Self::Sky(elevation, turbidity)),
                _ => Err("give the elevation of the sun in degrees and the turbidity, such as sky:30,3".to_owned()),
            };
        }
        Ok(Self::File(text.into()))
    }
}

impl EnvironmentArgs {
    /// The environment, or `None` without the option.
    ///
    /// # Errors
    /// An image that cannot be read.
    pub fn desc(&self, report: &mut LoadReport) -> Result<Option<EnvironmentDesc>, SceneError> {
        self.desc_with(report, &LoadOptions::default())
    }

    /// As [`Self::desc`], with options: a limit on memory.
    ///
    /// # Errors
    /// An image that cannot be read, or does not fit.
    pub fn desc_with(
        &self,
        report: &mut LoadReport,
        options: &LoadOptions,
    ) -> Result<Option<EnvironmentDesc>, SceneError> {
        let Some(name) = &self.environment else { return Ok(None) };
        let desc = match name {
            EnvironmentName::File(path) => EnvironmentDesc::read_with(path, report, options)?,
            EnvironmentName::Constant(radiance) => EnvironmentDesc::constant(*radiance),
            EnvironmentName::Sky(elevation, turbidity) => EnvironmentDesc::sky(*elevation, *turbidity),
        };
        Ok(Some(desc.rotated(self.environment_rotate).scaled(self.environment_scale)))
    }
}
