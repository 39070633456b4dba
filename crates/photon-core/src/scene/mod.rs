//! The scene as a backend sees it: borrowed slices.

pub(crate) mod boundaries;
pub(crate) mod camera;
pub(crate) mod caster;
mod digest;
pub(crate) mod environment;
pub mod grid;
pub(crate) mod guide;
pub(crate) mod layout;
pub(crate) mod light;
pub(crate) mod light_groups;
pub(crate) mod light_shares;
pub(crate) mod material;
pub(crate) mod material_layers;
pub(crate) mod media;
pub(crate) mod medium;
pub(crate) mod portal;
pub(crate) mod portal_shares;
pub(crate) mod solids;
pub(crate) mod texture;
pub(crate) mod units;

use crate::scene::boundaries::Boundaries;
use crate::scene::environment::EnvironmentMap;
use crate::scene::grid::GridTables;
use crate::scene::light::Light;
use crate::scene::material::{Material, Primitive};
use crate::scene::medium::Medium;
use crate::scene::portal::Portal;
use crate::scene::texture::ShadingTables;
use crate::scene::units::Units;

mod validate;

/// A scene in normalised space, borrowed.
///
/// `photon_scene::Scene::view` returns one; a renderer can also fill it from its own tables. Pipeline and
/// backends call [`SceneView::validate`], which checks what they rely on.
// Exhaustive: written as a literal with `..SceneView::default()`.
#[derive(Clone, Copy, Debug)]
pub struct SceneView<'a> {
    /// Vertices, within a box of unit size centred at the origin.
    pub positions: &'a [[f32; 3]],
    /// Three vertex indices each.
    pub triangles: &'a [[u32; 3]],
    /// One per triangle.
    pub primitives: &'a [Primitive],
    /// Indexed by [`Primitive::material`].
    pub materials: &'a [Material],
    /// Boundaries of media that light passes unchanged.
    pub boundaries: Boundaries<'a>,
    /// Indexed by [`Material::medium`]; the first is [`Medium::VACUUM`], and at most 255 others follow.
    pub media: &'a [Medium],
    /// Densities of media that differ from place to place.
    pub grids: GridTables<'a>,
    /// All lights that emit photons: first those of kind [`Light::TRIANGLE`] by increasing [`Light::primitive`], at most
    /// one per triangle, then all others.
    pub lights: &'a [Light],
    /// Where each light's interval in the range of a random `u32` begins; the first is 0, strictly
    /// increasing.
    pub light_cdf: &'a [u32],
    /// Light from infinitely far away; it needs an entry of [`Light::ENVIRONMENT`] in `lights`. Radiance in units of
    /// total power per steradian and squared normalised length.
    pub environment: Option<&'a EnvironmentMap>,
    /// Openings through which light from infinitely far away enters, at most [`Portal::MAX`]: where its photons start more
    /// often. They change no expectation.
    pub portals: &'a [Portal],
    /// Vertex attributes and textures.
    pub shading: ShadingTables<'a>,
    /// Radius of a sphere about the origin that contains the scene: vertices, point lights and spot lights.
    pub radius: f32,
    /// Conversion to user space and watts.
    pub units: Units,
}

/// An empty scene, in vacuum.
impl Default for SceneView<'_> {
    fn default() -> Self {
        Self {
            positions: &[],
            triangles: &[],
            primitives: &[],
            materials: &[],
            boundaries: Boundaries::default(),
            media: &[Medium::VACUUM],
            grids: GridTables::default(),
            lights: &[],
            light_cdf: &[],
            environment: None,
            portals: &[],
            shading: ShadingTables::default(),
            radius: 1.0,
            units: Units::default(),
        }
    }
}

impl<'a> SceneView<'a> {
    /// The materials that are used by a triangle, in order, with the glass of those that are partly glass. Indices out of
    /// range are skipped.
    pub(crate) fn materials_in_use(&self) -> impl Iterator<Item = &'a Material> + use<'a> {
        let mut used = vec![false; self.materials.len()];
        for primitive in self.primitives {
            if let Some(used) = used.get_mut(primitive.material as usize) {
                *used = true;
            }
        }
        for index in 0..self.materials.len() {
            if used[index]
                && let Some(glass) = self.glass_of(&self.materials[index])
                && let Some(used) = used.get_mut(glass as usize)
            {
                *used = true;
            }
        }
        self.materials.iter().zip(used).filter_map(|(material, used)| used.then_some(material))
    }

    /// Index of the glass that a share of `material` is, if it has [`Material::PARTIAL_TRANSMISSION`].
    fn glass_of(&self, material: &Material) -> Option<u32> {
        let index = (material.textures as usize).checked_sub(1).filter(|_| material.has_partial_transmission())?;
        self.shading.partial_transmissions.get(index).map(|entry| entry.glass)
    }

    /// The materials that paths may meet at a triangle: that of its primitive, and the glass that a share of it is.
    /// Indices out of range are skipped.
    pub(crate) fn materials_of(&self, primitive: &Primitive) -> impl Iterator<Item = &'a Material> + use<'a> {
        let material = self.materials.get(primitive.material as usize);
        let glass = material.and_then(|material| self.glass_of(material));
        material.into_iter().chain(glass.and_then(|glass| self.materials.get(glass as usize)))
    }
}

/// Share of the emitted photons that is distributed evenly over all lights; the rest is by power.
const DEFENSIVE_SHARE_PHOTONS: f64 = 1.0 / 64.0;

/// Divides the range of a random `u32` among lights: nearly all of it in proportion to their power, and a
/// sixty-fourth evenly, so that a light next to one that is 10²⁰ times as strong still gets photons.
///
/// The flux of a path is divided by the *quantised* probability ([`light_probability`]), so that the sum is
/// exact. Lights of equal power have equal shares, and their paths equal power.
#[must_use]
pub fn light_cdf(powers: &[f64]) -> Vec<u32> {
    let total: f64 = powers.iter().sum();
    let spare = (1_u64 << 32).saturating_sub(powers.len() as u64);
    let count = powers.len().max(1) as f64;
    let mut before = 0.0;
    powers
        .iter()
        .enumerate()
        .map(|(index, power)| {
            let by_power = if total > 0.0 { (before / total).min(1.0) } else { index as f64 / count };
            let fraction =
                (1.0 - DEFENSIVE_SHARE_PHOTONS) * by_power + DEFENSIVE_SHARE_PHOTONS * (index as f64 / count);
            before += power;
            ((fraction * spare as f64) as u64 + index as u64).min(u64::from(u32::MAX)) as u32
        })
        .collect()
}

/// The light whose interval contains `random`.
#[must_use]
pub fn pick_light(starts: &[u32], random: u32) -> usize {
    starts.partition_point(|&start| start <= random).saturating_sub(1)
}

/// The probability with which [`pick_light`] returns `index` for a uniform `random`.
#[must_use]
pub fn light_probability(starts: &[u32], index: usize) -> f64 {
    let end = starts.get(index + 1).map_or(1_u64 << 32, |&start| u64::from(start));
    (end - u64::from(starts[index])) as f64 / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_by_power_and_leave_nobody_out() {
        let starts = light_cdf(&[1.0, 3.0, 0.0, 1e-30]);
        assert_eq!(starts[0], 0);
        let shares: Vec<f64> = (0..4).map(|i| light_probability(&starts, i)).collect();
        for (share, by_power) in shares.iter().zip([0.25, 0.75, 0.0, 0.0]) {
            assert!((share - (by_power * 63.0 / 64.0 + 1.0 / 256.0)).abs() < 1e-8, "{shares:?}");
        }
        assert_eq!(shares.iter().sum::<f64>(), 1.0);
    }

    #[test]
    fn equal_lights_get_equal_shares() {
        for count in [1_usize, 2, 16, 64] {
            let starts = light_cdf(&vec![0.1; count]);
            for index in 0..count {
                assert!((light_probability(&starts, index) * count as f64 - 1.0).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn picking_inverts_the_shares() {
        let starts = light_cdf(&[1.0, 1.0, 2.0]);
        for (index, &start) in starts.iter().enumerate() {
            assert_eq!(pick_light(&starts, start), index);
            if start > 0 {
                assert_eq!(pick_light(&starts, start - 1), index - 1);
            }
        }
        assert_eq!(pick_light(&starts, u32::MAX), 2);
    }
}
