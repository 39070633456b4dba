//! Ranges of the numbers of material extensions, which the parser of glTF does not check.

use gltf::json::Value;
use gltf::json::extensions::material::Material as Extensions;

use super::fault::{AGAIN, Fault};
use crate::parameter::PARAMETERS;

/// Any number: the scene checks the range of what it becomes.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Extension, field, how many numbers it has, and their range, beside those of layers.
const RANGES: &[(&str, &str, usize, [f64; 2])] = &[
    // Without a positive factor there is no coat.
    ("KHR_materials_clearcoat", "clearcoatFactor", 1, [0.0, 1.0]),
    ("KHR_materials_specular", "specularFactor", 1, ANY),
    ("KHR_materials_dispersion", "dispersion", 1, [0.0, f64::MAX]),
    ("KHR_materials_volume_scatter", "multiscatterColor", 3, [0.0, 1.0]),
    ("KHR_materials_volume_scatter", "scatterAnisotropy", 1, [-1.0, 1.0]),
    ("KHR_materials_scatter", "scatterStrengthFactor", 1, [0.0, 1.0]),
    ("KHR_materials_scatter", "multiscatterColorFactor", 3, [0.0, 1.0]),
    ("KHR_materials_scatter", "scatterAnisotropy", 1, [-1.0, 1.0]),
];

/// Checks the factors of a material's extensions.
///
/// # Errors
/// Names `part`, the extension and the field of the first that is no number, or out of its range.
pub(super) fn check(extensions: &Extensions, part: &str) -> Result<(), Fault> {
    let layers = PARAMETERS.iter().filter_map(|parameter| {
        let layer = parameter.layer?;
        let (extension, factor) = layer.gltf?;
        Some((extension, factor, layer.default.numbers().len(), ANY))
    });
    for (extension, field, count, range) in RANGES.iter().copied().chain(layers) {
        let Some(of) = extensions.others.get(extension) else { continue };
        let Value::Object(fields) = of else {
            return Err(Fault::new(part, format!("{extension} is no object"), AGAIN));
        };
        let Some(value) = fields.get(field) else { continue };
        let is_number = |value: &Value| value.as_f64().is_some_and(|number| (range[0]..=range[1]).contains(&number));
        let is_valid = match value {
            Value::Array(values) => count > 1 && values.len() == count && values.iter().all(is_number),
            value => count == 1 && is_number(value),
        };
        if !is_valid {
            return Err(wrong(part, &format!("{extension}: {field}"), &value.to_string(), count, range));
        }
    }
    let transmission = extensions.transmission.as_ref().map(|glass| glass.transmission_factor.0);
    if let Some(factor) = transmission.filter(|factor| !(0.0..=1.0).contains(factor)) {
        let name = "KHR_materials_transmission: transmissionFactor";
        return Err(wrong(part, name, &factor.to_string(), 1, [0.0, 1.0]));
    }
    Ok(())
}

fn wrong(part: &str, name: &str, value: &str, count: usize, [low, high]: [f64; 2]) -> Fault {
    let kind = if count == 1 { "a number".to_owned() } else { format!("{count} numbers") };
    let range = match [low, high] {
        [f64::NEG_INFINITY, _] => String::new(),
        [_, f64::MAX] => format!(" of at least {low}"),
        _ => format!(" from {low} to {high}"),
    };
    Fault::new(part, format!("{name} is {value}; it must be {kind}{range}"), AGAIN)
}
