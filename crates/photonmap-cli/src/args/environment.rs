//! The options of the environment: light from infinitely far away.

use clap::Args;
use photon_scene::{EnvironmentDesc, EnvironmentName, LoadOptions, LoadReport, SceneError};

/// Light from infinitely far away.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Scene")]
pub struct EnvironmentArgs {
    /// Light from all around: an .exr or .hdr image in latitude and longitude, `gradient`, `constant`, `constant:R,G,B`,
    /// or a clear sky with its sun, `sky:ELEVATION,TURBIDITY`.
    ///
    /// It is added to the lights of the scene, and replaces the environment of the override file. The centre of an image
    /// is seen along -z; its values are radiance in W/(m²·sr). ELEVATION of the sun is 0 to 90 degrees, TURBIDITY 1 to 10
    /// (3: a clear day); the sun stands above -z. `gradient`, which a scene without any light has, is radiance 1 + 0.9 d·ω from
    /// direction ω, with the unit vector d along (-2, 4, 3).
    #[arg(long, value_name = "FILE|gradient|constant[:R,G,B]|sky:E,T")]
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
        hide_short_help = true,
        hide_long_help = true
    )]
    pub environment_scale: f64,
    /// Name of a material or mesh whose triangles fill openings, such as windows, through which the light of the environment
    /// enters: its photons start there more often. May be repeated.
    ///
    /// Wherever portals are, the same light enters on average; in a room with small windows there is much less noise. Radii
    /// of estimates follow the photons, so that their bias changes: where photons are few, the mean by 1.7 % in one room.
    #[arg(long = "portal", value_name = "NAME", hide_short_help = true, hide_long_help = true)]
    pub portals: Vec<String>,
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
        let desc = name.desc(report, options)?;
        Ok(Some(desc.rotated(self.environment_rotate).scaled(self.environment_scale)))
    }
}
