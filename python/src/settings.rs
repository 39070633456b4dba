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
        for (name, value) in &given {
            // One by one, since an error does not name the field.
            let alone = read(&serde_json::json!({ name.as_str(): value }).to_string());
            alone.map_err(|why| Failure::input(named(name, value, &why)))?;
        }
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
    read(json).map_err(|why| Failure::input(format!("settings: {why}")))
}

/// The settings in a JSON text; errors lack the position, since it is that of text which the user has not seen.
fn read(json: &str) -> Result<Settings, String> {
    serde_json::from_str(json).map_err(|why| why.to_string().split(" at line ").next().unwrap_or_default().to_owned())
}

/// An error of a field with its name, unless it says more than what is expected.
fn named(name: &str, value: &serde_json::Value, why: &str) -> String {
    match why.split_once(", expected ") {
        Some((_, "f32" | "f64")) => format!("{name} is {value}, but must be a number"),
        Some((found, expected)) if found.starts_with("invalid") => format!("{name} is {value}, but must be {expected}"),
        _ => format!("settings: {why}"),
    }
}
