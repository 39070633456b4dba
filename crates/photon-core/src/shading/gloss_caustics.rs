//! Which photons count in which glossy reflections, with [`crate::Settings::caustic_roughness`]; `gloss_caustics.glsl` is
//! the twin.
//!
//! Photons of lights without extent count in every reflection, since no camera path finds them; those of other lights only
//! where the reflection is at least that rough. Both sides of this rule have one bit: the lowest of the photon's packed
//! direction, and of the query's packed direction towards the viewer. That turns these directions by at most 8·10⁻⁵
//! radians; the narrowest reflections have a width of 10⁻³.

use glam::Vec3;

use crate::scene::light::Light;
use crate::scene::material::Material;
use crate::shading::layers::Layers;

/// The roughness of the narrowest part of a glossy reflection at one point: of the coat or metal, a clearcoat, a sheen.
/// Anisotropy only widens it.
#[inline]
#[must_use]
pub fn narrowest(material: &Material, layers: &Layers) -> f32 {
    let mut roughness = material.roughness;
    if layers.clearcoat > 0.0 {
        roughness = roughness.min(layers.clearcoat_roughness);
    }
    if layers.sheen_color != Vec3::ZERO {
        roughness = roughness.min(layers.sheen_roughness);
    }
    roughness
}

/// Whether camera paths find a light only by sampling it: whether it has no extent, or is the sun.
#[inline]
#[must_use]
pub fn is_sampled_only(light: &Light) -> bool {
    matches!(light.kind, Light::POINT | Light::SPOT | Light::DIRECTIONAL)
}

/// A packed direction ([`crate::octahedral::pack`]) with this mark: of a photon, that its light [`is_sampled_only`]; of a
/// query, that it counts all photons.
#[inline]
#[must_use]
pub const fn with_mark(packed: u32, marked: bool) -> u32 {
    packed & !1 | marked as u32
}

/// Whether the photon of one packed direction counts for the query of the other.
#[inline]
#[must_use]
pub const fn counts(photon: u32, query: u32) -> bool {
    (photon | query) & 1 != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octahedral;

    #[test]
    fn the_narrowest_part_decides() {
        let material = Material { roughness: 0.5, ..Material::default() };
        assert_eq!(narrowest(&material, &Layers::NONE), 0.5);
        let coated = Layers::NONE.with_clearcoat(0.1, 0.2);
        assert_eq!(narrowest(&material, &coated), 0.2);
        assert_eq!(narrowest(&Material { roughness: 0.1, ..material }, &coated), 0.1);
        assert_eq!(narrowest(&material, &Layers::NONE.with_clearcoat(0.0, 0.2)), 0.5);
        assert_eq!(narrowest(&material, &Layers::NONE.with_sheen(Vec3::X, 0.3)), 0.3);
        assert_eq!(narrowest(&material, &Layers::NONE.with_sheen(Vec3::ZERO, 0.3)), 0.5);
    }

    #[test]
    fn marks_turn_directions_by_little() {
        let mut worst = 0.0_f32;
        for i in 0..50_000_u32 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 50_000.0;
            let angle = (i % 4096) as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let packed = octahedral::pack(Vec3::new(r * angle.cos(), r * angle.sin(), z));
            for marked in [false, true] {
                let with = with_mark(packed, marked);
                assert_eq!(with & 1 != 0, marked);
                worst = worst.max(octahedral::unpack(with).cross(octahedral::unpack(packed)).length());
            }
        }
        // A step in one coordinate at the centre of a face of the octahedron, whose distance is 1/√3: √2 √3 steps.
        let bound = 6.0_f32.sqrt() / octahedral::STEPS;
        assert!(worst > 0.9 * bound && worst < 1.01 * bound, "{worst}");
        for (axis, marked) in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z].into_iter().zip([true, false]) {
            let turned = octahedral::unpack(with_mark(octahedral::pack(axis), marked));
            assert!(turned.is_finite() && turned.dot(axis) > 1.0 - 1e-6, "{axis} {turned}");
        }
    }

    #[test]
    fn every_pair_but_one_counts() {
        let [no, yes] = [false, true].map(|marked| with_mark(0x1234_5678, marked));
        assert_eq!([counts(no, no), counts(no, yes), counts(yes, no), counts(yes, yes)], [false, true, true, true]);
    }
}
