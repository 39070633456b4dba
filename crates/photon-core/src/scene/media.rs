//! Nested and overlapping solids: which media contain a point, and which of them applies.
//!
//! A path stores the solids that it has entered, up to four, as indices into the scene's table of media.
//! Where several overlap, the one with the highest priority applies, and of equals the one entered last
//! (Schmidt and Budge 2002).

use std::fmt;

use bitflags::bitflags;

use crate::scene::material::{Material, MaterialKind};
use crate::scene::medium::Medium;

/// The solids that contain a point, in the order in which they were entered: one byte each, the most
/// recently entered in the least significant byte.
///
/// Each byte is an index into the scene's table of media; 0 is the vacuum and means none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MediumStack(u32);

impl MediumStack {
    /// Outside of all solids.
    pub const VACUUM: Self = Self(0);
    /// Maximum number of solids.
    pub const DEPTH: u32 = 4;
    /// Maximum number of media of a scene, besides the vacuum.
    pub const MAX_MEDIA: usize = 255;

    /// The bits, as stored in buffers.
    #[inline]
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The stack with these bits.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// In a single solid.
    #[inline]
    #[must_use]
    pub const fn in_medium(medium: u32) -> Self {
        Self(medium & 0xFF)
    }

    /// Whether the stack has no space for another solid.
    #[inline]
    #[must_use]
    pub const fn is_full(self) -> bool {
        self.0 >> 24 != 0
    }

    /// Whether `medium` is in the stack.
    #[must_use]
    pub const fn contains(self, medium: u32) -> bool {
        let mut rest = self.0;
        while rest != 0 {
            if rest & 0xFF == medium {
                return true;
            }
            rest >>= 8;
        }
        false
    }

    /// The stack with another solid; unchanged if it is full. Leaving that solid again does not change it either,
    /// unless another one of the same medium is in the stack, which is then left early.
    #[inline]
    #[must_use]
    pub const fn enter(self, medium: u32) -> Self {
        if self.is_full() { self } else { Self(self.0 << 8 | medium & 0xFF) }
    }

    /// The stack without the last entered solid of that medium; unchanged if there is none.
    #[must_use]
    pub const fn leave(self, medium: u32) -> Self {
        let mut shift = 0;
        while shift < 32 && self.0 >> shift != 0 {
            if self.0 >> shift & 0xFF == medium {
                let below = self.0 & ((1_u32 << shift) - 1);
                // Two shifts, since a shift by 32 overflows.
                let above = (self.0 >> shift >> 8) << shift;
                return Self(above | below);
            }
            shift += 8;
        }
        self
    }

    /// Index of the medium that applies: the highest priority, of equals the last entered; 0 outside of all
    /// solids.
    #[must_use]
    pub fn current(self, media: &[Medium]) -> u32 {
        let mut found = self.0 & 0xFF;
        let mut rest = self.0 >> 8;
        while rest != 0 {
            let medium = rest & 0xFF;
            if media[medium as usize].priority > media[found as usize].priority {
                found = medium;
            }
            rest >>= 8;
        }
        found
    }
}

bitflags! {
    /// What kernels have to support for a scene's media; the rest is not compiled in.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct MediaFeatures: u32 {
        /// Solids may be nested or overlap: the bounding boxes of two of them do.
        const NESTED = 1;
    }
}

impl MediaFeatures {
    /// The bounding boxes of no two solids overlap.
    pub const NONE: Self = Self::empty();
    /// All features.
    pub const ALL: Self = Self::all();
}

impl fmt::Display for MediaFeatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.contains(Self::NESTED) { "nested" } else { "none" })
    }
}

/// The media on both sides of a boundary, as seen by a path that arrives there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Interface {
    /// Refractive index behind the boundary, divided by that before it. For a thin sheet its index against the
    /// vacuum, whatever surrounds it.
    pub eta: f32,
    /// The media before the boundary.
    pub before: MediumStack,
    /// The media behind the boundary.
    pub transmitted: MediumStack,
    /// Whether the medium changes. If not, light passes without reflection or refraction.
    pub is_active: bool,
    /// Whether a transmitted path would be in more solids than [`MediumStack::DEPTH`], so that this one is
    /// ignored.
    pub is_too_deep: bool,
}

/// The media on both sides of a boundary of `material`, for a path in `media_here` that arrives at its
/// front or its back.
///
/// A path that arrives at a back face is treated as inside of the solid, even if `media_here` lacks it. Without
/// `nested` only the side counts, and every solid is surrounded by vacuum.
#[inline(always)]
#[must_use]
pub fn interface(
    media: &[Medium],
    material: &Material,
    front: bool,
    media_here: MediumStack,
    nested: bool,
) -> Interface {
    match material.kind() {
        MaterialKind::Lambert | MaterialKind::Mirror | MaterialKind::Glossy => around(1.0, media_here),
        MaterialKind::Thin => around(material.ior, media_here),
        MaterialKind::Dielectric if nested => {
            let before = if front || media_here.contains(material.medium) {
                media_here
            } else {
                media_here.enter(material.medium)
            };
            let transmitted = if front { before.enter(material.medium) } else { before.leave(material.medium) };
            let (from, to) = (before.current(media), transmitted.current(media));
            let eta = media[to as usize].ior / media[from as usize].ior;
            Interface { eta, before, transmitted, is_active: from != to, is_too_deep: front && before.is_full() }
        }
        MaterialKind::Dielectric => {
            let solid = MediumStack::in_medium(material.medium);
            let (before, transmitted) = if front { (media_here, solid) } else { (solid, MediumStack::VACUUM) };
            let eta = if front { material.ior } else { 1.0 / material.ior };
            Interface { eta, before, transmitted, is_active: true, is_too_deep: false }
        }
    }
}

/// An interface with the same media on both sides.
#[inline(always)]
fn around(eta: f32, media: MediumStack) -> Interface {
    Interface { eta, before: media, transmitted: media, is_active: true, is_too_deep: false }
}

/// Radiance seen by a viewer in the media `from`, divided by the radiance that leaves a point in the media `at`,
/// without reflection or absorption in between: `(n_from/n_at)²`. Refraction leaves `L/n²` unchanged along a path
/// (Veach 1997, section 5.2), so this factor is applied once, where the path ends. Exactly 1 for equal stacks.
#[inline]
#[must_use]
pub fn radiance_scale(media: &[Medium], from: MediumStack, at: MediumStack) -> f32 {
    if from == at {
        return 1.0;
    }
    let ratio = media[from.current(media) as usize].ior / media[at.current(media) as usize].ior;
    ratio * ratio
}

#[cfg(test)]
mod tests {
    use super::*;

    fn media() -> Vec<Medium> {
        let of = |ior, priority| Medium { ior, priority, ..Medium::VACUUM };
        vec![Medium::VACUUM, of(1.33, 0), of(1.5, 0), of(1.1, 7), of(2.4, 7)]
    }

    fn solid(medium: u32) -> Material {
        let ior = media()[medium as usize].ior;
        Material { kind: MaterialKind::Dielectric as u32, medium, ior, ..Material::default() }
    }

    #[test]
    fn leaving_undoes_entering_in_any_order() {
        let water = MediumStack::VACUUM.enter(1);
        let both = water.enter(2);
        assert_eq!(both.leave(2), water);
        assert_eq!(both.leave(1), MediumStack::VACUUM.enter(2));
        assert_eq!(both.leave(1).leave(2), MediumStack::VACUUM);
        assert_eq!(water.leave(2), water);
        // Of two equal media the last is removed, and the order of the others is unchanged.
        let mixed = MediumStack::VACUUM.enter(3).enter(1).enter(3).enter(2);
        assert_eq!(mixed.leave(3), MediumStack::VACUUM.enter(3).enter(1).enter(2));
        assert_eq!(MediumStack::in_medium(255).leave(255), MediumStack::VACUUM);
    }

    #[test]
    fn a_fifth_solid_is_ignored_both_ways() {
        let four = MediumStack::VACUUM.enter(1).enter(2).enter(1).enter(2);
        assert!(four.is_full() && !MediumStack::VACUUM.enter(1).enter(1).enter(1).is_full());
        assert_eq!(four.enter(3), four);
        assert_eq!(four.enter(3).leave(3), four);
        // The highest byte is removed too.
        assert_eq!(four.leave(1).leave(1).leave(2).leave(2), MediumStack::VACUUM);
    }

    #[test]
    fn the_highest_priority_counts_and_of_equals_the_last() {
        let media = media();
        assert_eq!(MediumStack::VACUUM.current(&media), 0);
        assert_eq!(MediumStack::VACUUM.enter(1).enter(2).current(&media), 2);
        assert_eq!(MediumStack::VACUUM.enter(3).enter(2).current(&media), 3);
        assert_eq!(MediumStack::VACUUM.enter(3).enter(4).enter(1).current(&media), 4);
    }

    #[test]
    fn boundaries_are_taken_against_what_is_around_them() {
        let media = media();
        let water = MediumStack::VACUUM.enter(1);
        let into_glass = interface(&media, &solid(2), true, water, true);
        assert_eq!((into_glass.eta, into_glass.is_active), (1.5 / 1.33, true));
        assert_eq!(into_glass.transmitted, water.enter(2));
        // Inside a medium of higher priority, nothing changes.
        let hidden = interface(&media, &solid(2), true, MediumStack::VACUUM.enter(3), true);
        assert_eq!((hidden.eta, hidden.is_active), (1.0, false));
        // At the back of a solid that was never entered, the path counts as inside.
        let out = interface(&media, &solid(2), false, water, true);
        assert_eq!((out.before, out.transmitted, out.eta), (water.enter(2), water, 1.33 / 1.5));
    }

    /// For separate solids, both rules give bitwise equal results.
    #[test]
    fn nested_changes_nothing_for_solids_apart() {
        let media = media();
        for medium in 1..5 {
            for front in [false, true] {
                let here = if front { MediumStack::VACUUM } else { MediumStack::in_medium(medium) };
                let [plain, nested] =
                    [false, true].map(|nested| interface(&media, &solid(medium), front, here, nested));
                assert_eq!(plain, nested);
                assert_eq!(plain.eta.to_bits(), nested.eta.to_bits());
            }
        }
    }

    #[test]
    fn radiance_scales_by_the_squared_index() {
        let media = media();
        let glass = MediumStack::VACUUM.enter(2);
        assert_eq!(radiance_scale(&media, glass, glass), 1.0);
        assert!((radiance_scale(&media, MediumStack::VACUUM, glass) * 2.25 - 1.0).abs() < 1e-6);
        assert!((radiance_scale(&media, glass, MediumStack::VACUUM) / 2.25 - 1.0).abs() < 1e-6);
    }
}
