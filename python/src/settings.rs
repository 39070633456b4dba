//! Settings as JSON.

use photonmap::{Preset, Settings};
use pyo3::prelude::*;

use crate::error::Failure;

/// The settings of JSON text with the defaults of the others, as JSON.
#[pyfunction]
#[pyo3(signature = (json, preset=None, pixels=0))]
pub(crate) fn settings_json(json: &str, preset: Option<&str>, pixels: u64) -> PyResult<String> {
    let base = match preset {
        Some(name) => Settings::preset(name.parse::<Preset>().map_err(Failure::from)?, pixels),
        None => Settings::default(),
    };
    let write = |settings: &Settings| serde_json::to_value(settings).map_err(|why| Failure::input(why.to_string()));
    let mut all = write(&base)?;
    let given: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(json).map_err(|why| Failure::input(format!("settings: {why}")))?;
    if let Some(all) = all.as_object_mut() {
        all.extend(given);
    }
    let settings = parse(&all.to_string())?;
    settings.validate().map_err(Failure::from)?;
    Ok(write(&settings)?.to_string())
}

/// The number of passes of a preset.
#[pyfunction]
pub(crate) fn preset_passes(name: &str) -> PyResult<u32> {
    Ok(name.parse::<Preset>().map_err(Failure::from)?.passes())
}

/// The settings of JSON text.
pub(crate) fn parse(json: &str) -> Result<Settings, Failure> {
    serde_json::from_str(json).map_err(|why| {
        // The position is that of text which the user has not seen.
        let text = why.to_string();
        let text = text.split(" at line ").next().unwrap_or_default();
        Failure::input(format!("settings: {text}"))
    })
}
