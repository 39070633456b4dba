//! How much of a photon is stored in maps: the fields that are read, and no more.

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::scene::SceneView;
use crate::scene::environment::EnvironmentMap;
use crate::scene::layout::Photon;
use crate::scene::light::Light;
use crate::scene::material::Material;
use crate::scene::medium::Medium;
use crate::settings::{Estimator, Settings};

/// A number of leading bytes of [`Photon`], whose fields are ordered by how often they are needed: position
/// and normal decide which photons count, the power is what they add, and the direction is rarely needed.
///
/// Ordered by size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
// Exhaustive: backends must store each.
pub enum PhotonFormat {
    /// Position, normal, and one power for all three channels: 20 bytes.
    Mono,
    /// Position, normal and power: 28 bytes.
    NoDirection,
    /// All fields, including the direction: 32 bytes.
    #[default]
    Full,
}

impl PhotonFormat {
    /// All formats, from the smallest to the largest.
    pub const ALL: [Self; 3] = [Self::Mono, Self::NoDirection, Self::Full];

    /// The smallest format that renders `scene` with `settings` without a difference.
    ///
    /// Directions are needed by the paper's estimator, and where shading normals differ from geometric ones. One power is sufficient if no light and no surface in
    /// use treats channels differently, since equal numbers stay equal through the same operations.
    #[must_use]
    pub fn of(scene: &SceneView<'_>, settings: &Settings) -> Self {
        if matches!(settings.estimator, Estimator::Paper(_)) {
            return Self::Full;
        }
        if Features::of(scene).contains(Features::SHADING_NORMALS) {
            return Self::Full;
        }
        if is_grey(scene) { Self::Mono } else { Self::NoDirection }
    }

    /// Bytes of a photon.
    #[must_use]
    pub const fn bytes(self) -> u64 {
        Self::POSITION_NORMAL_BYTES + self.flux_bytes()
    }

    /// Bytes of position and normal.
    pub const POSITION_NORMAL_BYTES: u64 = 16;

    /// Bytes of the fields after position and normal: 4, 12 or 16.
    #[must_use]
    pub const fn flux_bytes(self) -> u64 {
        match self {
            Self::Mono => 4,
            Self::NoDirection => 12,
            Self::Full => size_of::<Photon>() as u64 - Self::POSITION_NORMAL_BYTES,
        }
    }

    /// The number by which kernels identify it: 0, 1, 2.
    #[must_use]
    pub const fn number(self) -> u32 {
        self as u32
    }

    /// Checks that this is the full format, where all fields of photons are needed.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] names `label` and its format.
    pub fn check_full(self, label: &'static str) -> Result<()> {
        if self == Self::Full {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: label,
            value: format!("stored as {}", self.name()),
            hint: "all fields of its photons are needed: use the full photon format",
        })
    }

    /// Description for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mono => "position, normal and one power",
            Self::NoDirection => "position, normal and power",
            Self::Full => "position, normal, power and direction",
        }
    }
}

/// Whether all light has three equal channels; materials that no surface uses are ignored.
fn is_grey(scene: &SceneView<'_>) -> bool {
    let equal = |[r, g, b]: [f32; 3]| r.to_bits() == g.to_bits() && g.to_bits() == b.to_bits();
    let even_medium = |medium: &Medium| equal(medium.absorption) && equal(medium.scattering);
    let surface = |material: &Material| {
        let features = crate::requirements::material_features(material, scene);
        let even = scene.media.get(material.medium as usize).is_none_or(even_medium);
        let colored = Features::TEXTURES.union(Features::VERTEX_COLORS).union(Features::SPECULAR_COLORS);
        equal(material.albedo)
            && scene.shading.layers(material).are_grey()
            && !features.intersects(colored)
            && (even || !features.contains(Features::ABSORPTION))
    };
    let light = |light: &Light| equal(light.power);
    let sky = |map: &EnvironmentMap| map.texels().iter().all(|&[r, g, b, _]| equal([r, g, b]));
    let is_even_around = scene.media.first().is_none_or(even_medium);
    is_even_around
        && scene.lights.iter().all(light)
        && scene.environment.is_none_or(sky)
        && scene.materials_in_use().all(surface)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn what_is_kept_is_the_front_of_the_record() {
        assert_eq!(PhotonFormat::ALL.map(PhotonFormat::bytes), [20, 28, 32]);
        assert_eq!(PhotonFormat::Full.bytes() as usize, size_of::<Photon>());
        assert_eq!(PhotonFormat::POSITION_NORMAL_BYTES as usize, offset_of!(Photon, power));
        assert_eq!(PhotonFormat::NoDirection.bytes() as usize, offset_of!(Photon, direction));
        assert!(PhotonFormat::ALL.is_sorted() && PhotonFormat::ALL.map(PhotonFormat::number) == [0, 1, 2]);
    }
}
