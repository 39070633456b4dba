//! Nested and overlapping solids: which media contain a point, and which of them applies.
//!
//! A path stores the solids that it has entered, up to four, as indices into the scene's table of media.
//! Where several overlap, the one with the highest priority applies, and of equals the one entered last
//! (Schmidt and Budge 2002).

use std::fmt;

use bitflags::bitflags;

use crate::scene::material::{Material, MaterialKind};
use crate::scene::medium::Medium;
use crate::shading::spectrum::Wavelength;

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
        /// Refractive indices are those of the table of media, by the solids around a point: the bounding boxes of two
        /// solids overlap, or [`Self::DISPERSION`].
        const NESTED = 1;
        /// Some refractive index depends on the wavelength. Needs [`Self::NESTED`].
        const DISPERSION = 2;
        /// Some medium scatters light: [`crate::Medium::scattering`].
        const SCATTERING = 4;
        /// Space outside of all solids absorbs or scatters light.
        const AMBIENT = 8;
        /// Some medium scatters light by another phase function than Henyey and Greenstein's.
        const PHASES = 16;
        /// Some medium has a grid of densities: [`crate::GridTables`].
        const GRIDS = 32;
        /// Some media have boundaries that light passes unchanged: [`crate::Boundaries`].
        const BOUNDARIES = 64;
    }
}

impl MediaFeatures {
    /// The bounding boxes of no two solids overlap, nothing disperses or scatters light, and around solids is a vacuum
    /// without boundaries.
    pub const NONE: Self = Self::empty();
    /// All features.
    pub const ALL: Self = Self::all();
}

impl fmt::Display for MediaFeatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = ["nested", "dispersion", "scattering", "ambient", "phases", "grids", "boundaries"];
        let present = names.into_iter().zip(Self::ALL).filter(|&(_, flag)| self.contains(flag));
        let listed: Vec<&str> = present.map(|(name, _)| name).collect();
        f.write_str(if listed.is_empty() { "none" } else { "" })?;
        f.write_str(&listed.join(", "))
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

impl Interface {
    /// Whether the refractive index of either side depends on the wavelength. Not at thin sheets.
    #[inline]
    #[must_use]
    pub fn is_dispersive(&self, media: &[Medium]) -> bool {
        let disperses = |stack: MediumStack| media[stack.current(media) as usize].is_dispersive();
        self.before != self.transmitted && self.is_active && (disperses(self.before) || disperses(self.transmitted))
    }

    /// This boundary of a solid for light of a wavelength.
    #[inline]
    #[must_use]
    pub fn at_wavelength(self, media: &[Medium], wavelength: Wavelength) -> Self {
        let index = |stack: MediumStack| media[stack.current(media) as usize].index(wavelength);
        Self { eta: index(self.transmitted) / index(self.before), ..self }
    }
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
pub fn radiance_scale(media: &[Medium], from: MediumStack, at: MediumStack, wavelength: Wavelength) -> f32 {
    if from == at {
        return 1.0;
    }
    let index = |stack: MediumStack| media[stack.current(media) as usize].index(wavelength);
    let ratio = index(from) / index(at);
    ratio * ratio
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::spectrum::Spectrum;

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
        let scale = |from, at| radiance_scale(&media, from, at, Wavelength::NONE);
        assert_eq!(scale(glass, glass), 1.0);
        assert!((scale(MediumStack::VACUUM, glass) * 2.25 - 1.0).abs() < 1e-6);
        assert!((scale(glass, MediumStack::VACUUM) / 2.25 - 1.0).abs() < 1e-6);
    }

    /// The index of BK7 at the lines F, d and C by its catalogue, and that of a medium of Cauchy's formula; f32 keeps them
    /// to 2⁻²³, and the cells of the spectrum miss the lines by up to 0.78 nm, which is worth 6e-5.
    #[test]
    fn indices_follow_the_wavelength() {
        let at = |nanometres: f32| {
            let cell = ((nanometres * 1e-3 - Spectrum::FIRST) / Spectrum::STEP) as u32;
            Wavelength::of_cell(cell)
        };
        let terms = [1.039_612, 0.231_792_34, 1.010_469_4, 0.006_000_698_7, 0.020_017_914, 103.560_65];
        let bk7 = Medium { ior: 1.5168, dispersion: Medium::SELLMEIER, terms, ..Medium::VACUUM };
        for (line, expected) in [(486.13, 1.522_38), (587.56, 1.5168), (656.27, 1.514_32)] {
            assert!((bk7.index(at(line)) - expected).abs() < 6e-5, "{line}: {}", bk7.index(at(line)));
        }
        let terms = [1.6, 0.02, 0.0, 0.0, 0.0, 0.0];
        let cauchy = Medium { ior: 1.66, dispersion: Medium::CAUCHY, terms, ..Medium::VACUUM };
        let length = at(500.0).micrometres();
        assert!((cauchy.index(at(500.0)) - (1.6 + 0.02 / length.powi(2))).abs() < 3e-7);
        assert_eq!(cauchy.index(Wavelength::NONE), 1.66);
        let low = Medium { terms: [0.9, 0.01, 0.0, 0.0, 0.0, 0.0], ..cauchy };
        assert_eq!((low.index(at(700.0)), low.index(at(390.0)) > 1.0 - 1e-6), (1.0, true));
    }

    #[test]
    fn only_boundaries_of_dispersive_solids_disperse() {
        let mut media = media();
        (media[2].dispersion, media[2].terms) = (Medium::CAUCHY, [1.5, 0.1, 0.0, 0.0, 0.0, 0.0]);
        let violet = Wavelength::of_cell(0);
        let water = MediumStack::VACUUM.enter(1);
        for (here, material, front, disperses) in [
            (water, solid(2), true, true),
            (water.enter(2), solid(2), false, true),
            (water, solid(1), false, false),
            // Within a solid of higher priority.
            (MediumStack::VACUUM.enter(3), solid(2), true, false),
            (
                water.enter(2),
                Material { kind: MaterialKind::Thin as u32, ior: 1.5, ..Material::default() },
                true,
                false,
            ),
        ] {
            let sides = interface(&media, &material, front, here, true);
            assert_eq!(sides.is_dispersive(&media), disperses, "{here:?} {front}");
            if disperses {
                let there = sides.at_wavelength(&media, violet);
                assert!(if front { there.eta > 1.1 * sides.eta } else { there.eta < sides.eta / 1.1 });
                assert_eq!(sides.at_wavelength(&media, Wavelength::NONE), sides);
            }
        }
    }
}
