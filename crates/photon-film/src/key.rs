//! What the passes of a film depend on. Films are continued and merged only if their keys agree.

use std::collections::BTreeMap;
use std::path::Path;

use photon_core::{ErrorTarget, NUMERICS, Render, SceneView, Settings, Units, View, check_size};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::camera;
use crate::error::{FilmFileError, shown};

/// Scene, view, settings and derived choices of a film. Seeds are not part of it: passes of several seeds can be merged.
///
/// Numbers that have to agree bit by bit are stored as hexadecimal bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmKey {
    /// [`SceneView::digest`].
    scene: String,
    width: u32,
    height: u32,
    /// Bytes of the camera's record.
    camera: String,
    settings: BTreeMap<String, String>,
    photons_per_pass: u32,
    aimed_per_pass: Option<u32>,
    /// Centre, scale and power of [`Units`], f64.
    units: [String; 5],
    /// Radii of the first pass, f32.
    radii: Vec<String>,
    grain: u32,
    numerics: u32,
}

impl FilmKey {
    /// The key of the passes that `renderer` renders of `scene` in blocks of `grain`. It contains the radii that the
    /// renderer has now: to continue a film, restore them first ([`FilmKey::radii`], [`Render::set_radii`]).
    #[must_use]
    pub fn new(scene: &SceneView<'_>, view: &View, settings: &Settings, renderer: &dyn Render, grain: u32) -> Self {
        let facts = renderer.facts();
        let Units { center: [x, y, z], scale, power } = scene.units;
        Self {
            scene: format!("{:032x}", scene.digest()),
            width: view.width,
            height: view.height,
            camera: camera::record(&view.camera),
            settings: entries(&Settings {
                // The renderer may have fewer.
                camera_samples: facts.camera_samples,
                shadow_rays: facts.shadow_rays,
                gather_rays: facts.gather_rays,
                ..settings.clone()
            }),
            photons_per_pass: facts.photons,
            aimed_per_pass: facts.aimed,
            units: [x, y, z, scale, power].map(|number| format!("{:016x}", number.to_bits())),
            radii: renderer.radii().iter().map(|radius| format!("{:08x}", radius.to_bits())).collect(),
            grain,
            numerics: NUMERICS,
        }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Passes in a block.
    #[must_use]
    pub fn grain(&self) -> u32 {
        self.grain
    }

    /// Paths of a pass that are not aimed.
    #[must_use]
    pub fn photons(&self) -> u32 {
        self.photons_per_pass
    }

    /// Camera paths of a pixel in each pass; 1 where films are from before there was such a setting.
    #[must_use]
    pub fn camera_samples(&self) -> u32 {
        self.settings.get(CAMERA_SAMPLES).map_or(Some(1), |count| count.parse().ok()).unwrap_or(0)
    }

    /// Digest of the scene, in hexadecimal.
    #[must_use]
    pub fn scene_digest(&self) -> &str {
        &self.scene
    }

    /// Names and values of the settings.
    pub fn settings(&self) -> impl Iterator<Item = (&str, &str)> {
        self.settings.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// A target for the error of this film, for [`ErrorTarget::forecast`].
    ///
    /// # Errors
    /// [`photon_core::Error::InvalidSetting`] if target or share is out of range, errors are not estimated, or the settings are
    /// not those of this version.
    pub fn error_target(&self, target: f64, share_of_pixels: f64) -> photon_core::Result<ErrorTarget> {
        let settings = parsed(&self.settings).ok_or_else(|| photon_core::Error::InvalidSetting {
            name: "film",
            value: "with settings of another version".into(),
            hint: "render it again with this one",
        })?;
        ErrorTarget::new(target, share_of_pixels, &settings)
    }

    /// Conversion to user space and watts.
    #[must_use]
    pub fn units(&self) -> Units {
        let bits = |text: &String| u64::from_str_radix(text, 16).map_or(f64::NAN, f64::from_bits);
        let [x, y, z, scale, power] = self.units.each_ref().map(bits);
        Units { center: [x, y, z], scale, power }
    }

    /// Radii of the first pass, for [`Render::set_radii`].
    #[must_use]
    pub fn radii(&self) -> Vec<f32> {
        self.radii.iter().map(|text| u32::from_str_radix(text, 16).map_or(f32::NAN, f32::from_bits)).collect()
    }

    /// Checks the numbers of a key that was read.
    pub(crate) fn validate(&self) -> Result<(), String> {
        check_size(self.width, self.height).map_err(|error| error.to_string())?;
        let units = self.units();
        if !(units.center.iter().all(|x| x.is_finite()) && units.scale > 0.0 && units.scale.is_finite()) {
            return Err("its units are no numbers".to_owned());
        }
        if !(units.power > 0.0 && units.power.is_finite()) {
            return Err("its power is no positive number".to_owned());
        }
        if !self.radii().iter().all(|radius| *radius >= 0.0 && radius.is_finite()) {
            return Err("its radii are not all numbers of at least 0".to_owned());
        }
        if self.camera_samples() == 0 {
            return Err("its number of camera samples is none".to_owned());
        }
        if self.grain == 0 {
            return Err("its grain is 0".to_owned());
        }
        Ok(())
    }

    /// Checks that the key of the film in `path` is `expected`.
    ///
    /// # Errors
    /// [`FilmFileError::OtherKey`] names the first part that differs.
    pub fn check(&self, expected: &Self, path: &Path) -> Result<(), FilmFileError> {
        let (found, other) = (self.parts(), expected.parts());
        let of = |parts: &[(String, String)], name: &str| {
            parts
                .iter()
                .find(|(known, _)| known == name)
                .map_or_else(|| "absent".to_owned(), |(_, value)| value.clone())
        };
        let names = found.iter().chain(&other).map(|(name, _)| name);
        let Some(name) = names.into_iter().find(|name| of(&found, name) != of(&other, name)) else { return Ok(()) };
        let [found, expected] = match name.as_str() {
            CAMERA => camera::difference([&self.camera, &expected.camera]),
            _ => [of(&found, name), of(&other, name)],
        };
        let [what, found, expected] = [name, &found, &expected].map(|text| shown(text));
        Err(FilmFileError::OtherKey { path: path.to_owned(), what, found, expected })
    }

    /// All parts by name, as text: those first on which others depend.
    fn parts(&self) -> Vec<(String, String)> {
        // Every member by name: a new one is an error here until it is compared.
        let Self {
            scene,
            width,
            height,
            camera,
            settings,
            photons_per_pass,
            aimed_per_pass,
            units,
            radii,
            grain,
            numerics,
        } = self;
        let aimed = aimed_per_pass.map_or("none".to_owned(), |aimed| aimed.to_string());
        let named = |name: &str, value: String| (name.to_owned(), value);
        let mut parts = vec![
            named(SCENE, format!("that of digest {scene}")),
            named("size", format!("{width}x{height}")),
            named(CAMERA, camera.clone()),
        ];
        parts.extend(settings.iter().map(|(name, value)| (format!("setting {name}"), value.clone())));
        parts.extend([
            named("number of photons per pass", photons_per_pass.to_string()),
            named("number of aimed photons per pass", aimed),
            named("units (bits of centre, scale and power)", units.join(" ")),
            named("list of radii (bits)", radii.join(" ")),
            named("grain", grain.to_string()),
            named("version of the numerics", numerics.to_string()),
        ]);
        parts
    }
}

/// Name of the setting of that name.
const CAMERA_SAMPLES: &str = "camera_samples";

/// Name of the scene among the parts.
pub(crate) const SCENE: &str = "scene";

/// Name of the camera among the parts.
const CAMERA: &str = "camera";

/// Settings on which no pass depends, or that the key has elsewhere: the renderer may have fewer paths, seeds are part of the
/// set of passes, scheduling changes no result, and a pass that exceeds memory or capacity is an error.
const OTHERS: [&str; 5] = ["photons", "seed", "scheduling", "photon_capacity", "memory"];

/// The settings that passes depend on, by name, as in a JSON file but for the quotes of texts. Numbers of up to 15 digits are
/// read back as the same bits.
fn entries(settings: &Settings) -> BTreeMap<String, String> {
    // By way of text, in which numbers of 32 bits are as short as they are.
    let json = serde_json::to_string(settings).and_then(|text| serde_json::from_str(&text));
    let Ok(Value::Object(all)) = json else { return BTreeMap::new() };
    let text = |value: Value| if let Value::String(text) = value { text } else { value.to_string() };
    let parts = all.into_iter().filter(|(name, _)| !OTHERS.contains(&name.as_str()));
    parts.map(|(name, value)| (name, text(value))).collect()
}

/// The settings of [`entries`]; others are the default.
fn parsed(entries: &BTreeMap<String, String>) -> Option<Settings> {
    let value = |text: &String| serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.clone()));
    let all = entries.iter().map(|(name, text)| (name.clone(), value(text))).collect();
    serde_json::from_value(Value::Object(all)).ok()
}

#[cfg(test)]
mod tests {
    use photon_core::{Estimator, Kernel};

    use super::*;

    #[test]
    fn settings_are_read_back() {
        let estimator = Estimator::Knn { k: 60, max_radius: None };
        let settings = Settings { estimator, alpha: 0.7, irradiance_every: Some(3), ..Settings::default() };
        let entries = entries(&settings);
        assert_eq!(parsed(&entries), Some(settings));
        assert_eq!(
            (entries["area"].as_str(), entries["estimator"].as_str()),
            ("disc", r#"{"knn":{"k":60,"max_radius":null}}"#)
        );
        let absent =
            OTHERS.into_iter().find(|name| serde_json::to_value(Settings::default()).unwrap().get(name).is_none());
        assert_eq!(absent, None);
    }

    #[test]
    fn targets_have_the_settings_of_the_film() {
        for (kernel, alpha) in Kernel::ALL.into_iter().zip([0.7, 1.0]) {
            let settings = Settings { kernel, alpha, errors: true, ..Settings::default() };
            let key = FilmKey { settings: entries(&settings), ..blank() };
            assert_eq!(key.error_target(0.1, 0.5).unwrap(), ErrorTarget::new(0.1, 0.5, &settings).unwrap());
        }
        let key = FilmKey { settings: entries(&Settings::default()), ..blank() };
        assert!(key.error_target(0.1, 0.5).unwrap_err().to_string().contains("errors"));
    }

    fn blank() -> FilmKey {
        FilmKey {
            scene: String::new(),
            width: 1,
            height: 1,
            camera: String::new(),
            settings: BTreeMap::new(),
            photons_per_pass: 1,
            aimed_per_pass: None,
            units: std::array::from_fn(|_| String::new()),
            radii: Vec::new(),
            grain: 1,
            numerics: NUMERICS,
        }
    }
}
