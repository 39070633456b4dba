//! Environments by name, as options of programs have them.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::EnvironmentDesc;
use crate::{LoadOptions, LoadReport, SceneError};

/// An environment by name: an image, `gradient`, `constant`, `constant:R,G,B` or `sky:ELEVATION,TURBIDITY`.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentName {
    /// An image.
    File(PathBuf),
    /// [`EnvironmentDesc::gradient`].
    Gradient,
    /// Even radiance from all directions.
    Constant([f64; 3]),
    /// Elevation of the sun in degrees, and turbidity.
    Sky(f64, f64),
}

impl FromStr for EnvironmentName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            |list: &str| -> Option<Vec<f64>> { list.split(',').map(|part| part.trim().parse().ok()).collect() };
        if text == "gradient" {
            return Ok(Self::Gradient);
        }
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
        let path = Path::new(text);
        if path.extension().is_none() && !path.exists() {
            return Err(format!("there is no file {text}; give an image, gradient, constant:R,G,B, or sky:30,3"));
        }
        Ok(Self::File(text.into()))
    }
}

impl EnvironmentName {
    /// The environment; an image is read.
    ///
    /// # Errors
    /// An image that cannot be read, or does not fit.
    pub fn desc(&self, report: &mut LoadReport, options: &LoadOptions) -> Result<EnvironmentDesc, SceneError> {
        Ok(match self {
            Self::File(path) => EnvironmentDesc::read_with(path, report, options)?,
            Self::Gradient => EnvironmentDesc::gradient(),
            Self::Constant(radiance) => EnvironmentDesc::constant(*radiance),
            Self::Sky(elevation, turbidity) => EnvironmentDesc::sky(*elevation, *turbidity),
        })
    }
}
