//! Partial transmission: surfaces that are glass for a share of all light and of all views, and opaque for the rest
//! (`KHR_materials_transmission` of glTF 2.0); `partial_transmission.glsl` is the twin.
//!
//! Which of its two materials a path meets is decided by the random word of its ray, so that the expectation is the
//! mixture of both, as of a checkerboard too fine to see. Photons are stored by paths that meet the opaque material, with
//! their power divided by its share: camera paths and gather rays that meet it see the whole irradiance.

use crate::random::unit_f32;
use crate::scene::caster::Hit;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::texture::{MaterialTextures, PartialTransmission};
use crate::shading::alpha;
use crate::shading::shade::{Corners, Shading};

/// The share of paths that meet the glass: `factor` times a `texel` of its texture, of what is not metal; rounded up to a
/// multiple of 2⁻²⁴, at most 1.
#[inline]
#[must_use]
pub fn share(factor: f32, texel: f32, metallic: f32) -> f32 {
    let transmitted = factor * texel;
    alpha::coverage((transmitted * (1.0 - metallic)).max(0.0), 0.0)
}

/// Whether a ray with the random word `word` meets the glass of a surface whose glass has this share: never for 0, always
/// for 1.
#[inline]
#[must_use]
pub fn is_glass(share: f32, word: u32) -> bool {
    unit_f32(word) < share
}

/// The share of metal in the opaque material, where `metallic` is that of the whole surface.
#[inline]
#[must_use]
pub fn opaque_metallic(metallic: f32, share: f32) -> f32 {
    if share > 0.0 && share < 1.0 { (metallic / (1.0 - share)).min(1.0) } else { metallic }
}

impl Shading<'_> {
    /// The material that a ray with the random word `word` meets at `hit`: the index of `material`, `index`, or that of
    /// its glass.
    #[inline]
    #[must_use]
    pub fn met_material(&self, hit: &Hit, index: u32, material: &Material, word: u32) -> u32 {
        match self.partial_transmission(material) {
            Some(entry) if is_glass(self.glass_share(hit, material), word) => entry.glass,
            _ => index,
        }
    }

    /// As [`Self::met_material`], but the glass only where rays never meet `material`.
    #[inline]
    #[must_use]
    pub fn extent_material(&self, hit: &Hit, index: u32, material: &Material) -> u32 {
        self.met_material(hit, index, material, u32::MAX)
    }

    /// The share of rays that meet the glass of `material` at `hit`; 0 without one.
    #[inline]
    #[must_use]
    pub fn glass_share(&self, hit: &Hit, material: &Material) -> f32 {
        self.glass_share_at(&Corners::of(hit), material)
    }

    #[inline]
    pub(super) fn glass_share_at(&self, corners: &Corners, material: &Material) -> f32 {
        let Some(entry) = self.partial_transmission(material) else { return 0.0 };
        let texel = self.sample(entry.factor_texture, corners).map_or(1.0, |texel| texel.x);
        let mut metallic = material.metallic;
        if material.kind() == MaterialKind::Glossy {
            let used = self.textures_of(material).map_or(MaterialTextures::NONE, |used| used.metallic_roughness);
            if let Some(texel) = self.sample(used, corners) {
                metallic *= texel.z;
            }
        }
        share(entry.factor, texel, metallic)
    }

    #[inline]
    fn partial_transmission(&self, material: &Material) -> Option<&PartialTransmission> {
        if !material.has_partial_transmission() {
            return None;
        }
        self.tables.partial_transmissions.get((material.textures as usize).wrapping_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Domain, Sampler};
    use crate::settings::RandomKind;

    /// The standard error of a count of probability p is √(N p (1 − p)).
    #[test]
    fn words_choose_by_the_share() {
        const COUNT: u32 = 1 << 16;
        let word = |path| Sampler::new(RandomKind::Counter, 7, 0, Domain::Eye, path).words(2)[3];
        let met = |share: f32| (0..COUNT).filter(|&path| is_glass(share, word(path))).count() as f64;
        for of in [0.01, 0.25, 0.5, 0.9] {
            let (expected, p) = (f64::from(COUNT) * f64::from(of), f64::from(of));
            let deviation = (expected * (1.0 - p)).sqrt();
            let z = (met(share(of, 1.0, 0.0)) - expected) / deviation;
            assert!(z.abs() <= 4.5, "{of}: z = {z}");
            // One part in ten less is detected, except for the smallest.
            let z = (met(share(of, 0.9, 0.0)) - expected) / deviation;
            assert!(z.abs() > 4.5 || of < 0.1, "{of}: z = {z}");
        }
        assert_eq!([0.0, 1.0].map(|of| is_glass(of, u32::MAX)), [false, true]);
        assert_eq!([0.0, 1.0].map(|of| is_glass(of, 0)), [false, true]);
    }

    /// glTF mixes what is not metal: of a surface with transmission T and metal m, T (1 − m) is glass, m metal.
    #[test]
    fn metal_does_not_transmit() {
        for (factor, metallic) in [(0.5_f32, 0.25_f32), (1.0, 0.5), (0.25, 0.0), (0.75, 1.0)] {
            let glass = share(factor, 1.0, metallic);
            assert!((glass - factor * (1.0 - metallic)).abs() < 1e-6);
            let metal = (1.0 - glass) * opaque_metallic(metallic, glass);
            assert!((metal - metallic).abs() < 1e-6, "{factor}, {metallic}: {metal}");
        }
        assert_eq!(opaque_metallic(0.0, 1.0), 0.0);
        assert_eq!([share(2.0, 1.0, 0.0), share(1.0, 1.0, 2.0)], [1.0, 0.0]);
    }
}
