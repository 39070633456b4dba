//! How much of a photon is kept in maps: what somebody reads, and no more.

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::scene::SceneView;
use crate::scene::layout::{Light, Material, Photon};
use crate::settings::{Estimator, Settings};

/// So many bytes from the front of [`Photon`] on: its members stand in the order in which they are read.
/// Position and normal decide which photons count, the power is what they add, and directions few ask for.
///
/// In that order too: what is less is compared as less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PhotonFormat {
    /// Position, normal, and one power that stands for three equal ones: 20 bytes.
    Mono,
    /// Position, normal and power: 28 bytes.
    NoDirection,
    /// All of it, the direction too: 32 bytes.
    #[default]
    Full,
}

impl PhotonFormat {
    /// From the least to the most.
    pub const ALL: [Self; 3] = [Self::Mono, Self::NoDirection, Self::Full];

    /// The least that pictures of `scene` by `settings` are made of.
    ///
    /// Directions are read by the paper's estimator alone. One power is enough where no light and no surface
    /// in use treats channels differently, since equal numbers stay equal through the same operations.
    #[must_use]
    pub fn of(scene: &SceneView<'_>, settings: &Settings) -> Self {
        if matches!(settings.estimator, Estimator::Paper(_)) {
            return Self::Full;
        }
        if is_grey(scene) { Self::Mono } else { Self::NoDirection }
    }

    /// Bytes of a photon.
    #[must_use]
    pub const fn bytes(self) -> u64 {
        Self::POSITION_NORMAL_BYTES + self.flux_bytes()
    }

    /// Of those, position and normal.
    pub const POSITION_NORMAL_BYTES: u64 = 16;

    /// Of those, what follows them: 4, 12 or 16.
    #[must_use]
    pub const fn flux_bytes(self) -> u64 {
        match self {
            Self::Mono => 4,
            Self::NoDirection => 12,
            Self::Full => size_of::<Photon>() as u64 - Self::POSITION_NORMAL_BYTES,
        }
    }

    /// For kernels: 0, 1, 2.
    #[must_use]
    pub const fn number(self) -> u32 {
        self as u32
    }

    /// Checks that whole photons, which are asked for, are what `label` keeps.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] names it and what it keeps.
    pub fn check_full(self, label: &'static str) -> Result<()> {
        if self == Self::Full {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: label,
            value: format!("kept as {}", self.name()),
            hint: "whole photons were asked for: keep them whole",
        })
    }

    /// In words, for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mono => "position, normal and one power",
            Self::NoDirection => "position, normal and power",
            Self::Full => "position, normal, power and direction",
        }
    }
}

/// Whether light of three equal channels is all that there ever is: what no surface has is not looked at.
fn is_grey(scene: &SceneView<'_>) -> bool {
    let equal = |[r, g, b]: [f32; 3]| r.to_bits() == g.to_bits() && g.to_bits() == b.to_bits();
    let surface = |material: &Material| {
        let features = crate::requirements::material_features(material, scene.media);
        let even = scene.media.get(material.medium as usize).is_none_or(|medium| equal(medium.absorption));
        equal(material.albedo) && (even || !features.contains(Features::ABSORPTION))
    };
    let light = |light: &Light| equal(light.power);
    scene.lights.iter().all(light) && scene.materials_in_use().all(surface)
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
