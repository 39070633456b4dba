//! Scattering inside of solids: `KHR_materials_volume_scatter` and `KHR_materials_scatter`, both drafts.

use gltf::json::Value;

use super::parameters::numbers;
use crate::describe::Surface;
use crate::report::LoadReport;

/// Drafts: <https://github.com/KhronosGroup/glTF/pull/2453>, and <https://github.com/KhronosGroup/glTF/pull/2579>, which is to
/// replace it.
pub(super) const NAMES: [&str; 2] = ["KHR_materials_volume_scatter", "KHR_materials_scatter"];
/// Greatest magnitude of the mean cosine: the drafts allow 1, where nothing is scattered aside.
const MAX_ANISOTROPY: f64 = 0.999;

/// The extension of a material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    name: &'static str,
    /// Albedo of a thick body of the medium.
    multiple: [f64; 3],
    /// Mean cosine of the phase function.
    anisotropy: f64,
    has_texture: bool,
}

impl Scatter {
    /// The extension of a material, if it has one that scatters light; of both, the newer one.
    pub(super) fn read<'a>(get: impl Fn(&str) -> Option<&'a Value>) -> Option<Self> {
        let [old, new] = NAMES.map(|name| get(name).map(|of| (name, of)));
        let (name, of) = new.or(old)?;
        let (multiple, strength) = if new.is_some() {
            let strength = numbers(of, "scatterStrengthFactor").map_or(0.0, |[strength]| strength);
            (numbers(of, "multiscatterColorFactor").unwrap_or([1.0; 3]), strength)
        } else {
            (numbers(of, "multiscatterColor").unwrap_or([0.0; 3]), 1.0)
        };
        let textures = ["multiscatterColorTexture", "scatterStrengthTexture"];
        let found = Self {
            name,
            multiple: multiple.map(|color: f64| color * strength),
            anisotropy: numbers(of, "scatterAnisotropy").map_or(0.0, |[g]| g),
            has_texture: textures.into_iter().any(|texture| of.get(texture).is_some()),
        };
        (found.multiple != [0.0; 3]).then_some(found)
    }

    /// Splits the extinction of a solid, which is its absorption so far, into absorption and scattering. Returns the
    /// coefficient of scattering and the mean cosine.
    pub(super) fn split(self, surface: &mut Surface, subject: &str, report: &mut LoadReport) -> ([f64; 3], f64) {
        let Self { name, multiple, anisotropy, has_texture } = self;
        let none = ([0.0; 3], 0.0);
        let Surface::Dielectric { absorption, .. } = surface else {
            let text = format!(
                "its {name}, since only solids that are all glass scatter light here; give it a transmissionFactor of 1 and a \
                 thicknessFactor above 0"
            );
            report.left_out(subject, text);
            return none;
        };
        if *absorption == [0.0; 3] {
            report.left_out(subject, format!("its {name}, which has no effect without an attenuationDistance"));
            return none;
        }
        report.note(subject, format!("scatters light by {name}, a draft of glTF that may change"));
        if has_texture {
            report.left_out(subject, format!("the textures of its {name}; only their factors are used"));
        }
        let g = anisotropy.clamp(-MAX_ANISOTROPY, MAX_ANISOTROPY);
        if g != anisotropy {
            report.approximated(subject, format!("its scatterAnisotropy {anisotropy} is replaced by {g}"));
        }
        let extinction = *absorption;
        let share: [f64; 3] = multiple.map(|color| single_scatter_albedo(color, g));
        *absorption = std::array::from_fn(|channel| extinction[channel] * (1.0 - share[channel]));
        (std::array::from_fn(|channel| extinction[channel] * share[channel]), g)
    }
}

/// Albedo of one scattering, for a thick body of this albedo (Kulla and Conty 2017, as in the drafts).
fn single_scatter_albedo(multiple: f64, g: f64) -> f64 {
    let root = (9.592_17 + 41.680_8 * multiple + 17.712_6 * multiple * multiple).sqrt();
    // White is −5e-6, which would absorb less than nothing.
    let s = (4.097_12 + 4.208_63 * multiple - root).clamp(0.0, 1.0);
    (1.0 - s * s) / (1.0 - g * s * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula of the drafts, evaluated by an independent program; black and white to the precision of its coefficients.
    #[test]
    fn albedos_of_known_bodies() {
        for (multiple, g, expected) in [
            (0.0, 0.0, 0.0),
            (0.2, 0.0, 0.613_357),
            (0.5, 0.0, 0.911_709),
            (0.8, 0.0, 0.990_589),
            (0.5, 0.5, 0.953_816),
            (1.0, 0.9, 1.0),
        ] {
            let found = single_scatter_albedo(multiple, g);
            assert!((found - expected).abs() < 6e-6, "{multiple} {g}: {found}");
            assert!((0.0..=1.0).contains(&found));
        }
    }
}
