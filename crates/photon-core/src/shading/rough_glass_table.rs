//! What single scattering at rough glass loses, by cosine and roughness.
//!
//! Unlike those of reflection ([`AlbedoTable`]), the albedos of a boundary that transmits depend on the ratio of the
//! refractive indices, so that there is a table for each ratio in the scene.

use crate::error::{Error, Result};
use crate::scene::SceneView;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::medium::Medium;
use crate::scene::solids::Solids;
use crate::shading::albedo_table::{AlbedoTable, directional_of, mean_of, tabulate};
use crate::shading::fresnel::fresnel;
use crate::shading::ggx;
use crate::shading::rough_glass::MIN_CONTRAST;
use crate::shading::spectrum::Wavelength;

use glam::Vec3;

/// Which losses apply: the index of a ratio, and from which of its sides the path comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Losses {
    ratio: u32,
    is_turned: bool,
}

impl Losses {
    /// Those of a thin sheet, which are those of a perfect reflector.
    pub(crate) const SHEET: Self = Self { ratio: u32::MAX, is_turned: false };
}

/// The share of light that single scattering at rough boundaries reflects and transmits, E, for each ratio of refractive
/// indices.
#[derive(Clone, Debug, Default)]
pub struct RoughGlassTable {
    /// For each ratio the index behind the boundary over that before it, and the inverse.
    ratios: Vec<[f32; 2]>,
    /// For each ratio, E from its first side and from its second, in the order of [`AlbedoTable::entries`].
    entries: Vec<[f32; 2]>,
}

impl RoughGlassTable {
    /// Maximum number of ratios of a scene.
    pub const MAX_RATIOS: usize = 64;
    /// Entries of each ratio.
    pub const STRIDE: usize = AlbedoTable::SIZE * (AlbedoTable::SIZE + 1);

    /// The tables for the rough solids of `scene`: some 0.1 seconds of processor time for each ratio, by all cores. If any
    /// solids overlap, every two media may meet.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidScene`] if there are more than [`Self::MAX_RATIOS`].
    pub fn new(scene: &SceneView<'_>) -> Result<Self> {
        let mut ratios: Vec<[f32; 2]> = Vec::new();
        let is_rough = |material: &Material| material.is_rough_glass() && material.kind() == MaterialKind::Dielectric;
        if !scene.materials_in_use().any(is_rough) {
            return Ok(Self::default());
        }
        let nested = Solids::of(scene).overlap();
        for material in scene.materials_in_use() {
            if !is_rough(material) {
                continue;
            }
            let around: &[_] = if nested { scene.media } else { &scene.media[..1] };
            let Some(inside) = scene.media.get(material.medium as usize) else { continue };
            for other in around {
                for wavelength in wavelengths(inside, other) {
                    let [ior, there] = [inside, other].map(|medium| medium.index(wavelength));
                    let pair = [ior / there, there / ior];
                    let is_new = !ratios.iter().any(|ratio| ratio.contains(&pair[0]));
                    if is_new && (pair[0] - 1.0).abs() >= MIN_CONTRAST {
                        ratios.push(pair);
                    }
                }
            }
        }
        if ratios.len() > Self::MAX_RATIOS {
            return Err(Error::InvalidScene {
                what: "the refractive indices of rough glass",
                value: format!("{} pairs of different ratios", ratios.len()),
                hint: "at most 64 are supported, and if any solids overlap, each rough one counts with every other medium; use fewer \
                       different indices",
            });
        }
        let entries =
            ratios.iter().flat_map(|&pair| tabulate(|alpha, cosine| pair.map(|eta| kept(alpha, cosine, eta))));
        Ok(Self { entries: entries.collect(), ratios })
    }

    /// Number of ratios.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ratios.len()
    }

    /// Whether no table is needed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ratios.is_empty()
    }

    /// The ratios, then the tables of each, [`Self::STRIDE`] entries.
    pub fn all(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        self.ratios.iter().chain(&self.entries).copied()
    }

    /// The losses at a boundary with this ratio of the index behind it to that before it; of the most similar ratio, if
    /// rounding has changed it.
    #[inline]
    pub(crate) fn losses(&self, eta: f32) -> Losses {
        let mut found = Losses { ratio: 0, is_turned: false };
        let mut least = f32::INFINITY;
        for (ratio, pair) in self.ratios.iter().enumerate() {
            for (side, value) in pair.iter().enumerate() {
                let apart = (value - eta).abs();
                if apart < least {
                    least = apart;
                    found = Losses { ratio: ratio as u32, is_turned: side == 1 };
                }
            }
        }
        found
    }

    #[inline]
    fn of(&self, losses: Losses) -> &[[f32; 2]] {
        let first = losses.ratio as usize * Self::STRIDE;
        self.entries.get(first..first + Self::STRIDE).unwrap_or(AlbedoTable::get().entries())
    }

    /// `1 − E` on side 0, where the path comes from, or 1.
    #[inline]
    pub(crate) fn lost(&self, losses: Losses, side: usize, cosine: f32, roughness: f32) -> f32 {
        if losses == Losses::SHEET {
            let pair = AlbedoTable::get().directional(cosine, roughness);
            return (1.0 - (pair.x + pair.y)).max(0.0);
        }
        let pair = directional_of(self.of(losses), cosine, roughness);
        (1.0 - pair[usize::from(losses.is_turned) ^ side]).max(0.0)
    }

    /// The mean of [`Self::lost`] over the hemisphere.
    #[inline]
    pub(crate) fn mean_lost(&self, losses: Losses, side: usize, roughness: f32) -> f32 {
        if losses == Losses::SHEET {
            let pair = AlbedoTable::get().mean(roughness);
            return (1.0 - (pair.x + pair.y)).max(0.0);
        }
        let pair = mean_of(self.of(losses), roughness);
        (1.0 - pair[usize::from(losses.is_turned) ^ side]).max(0.0)
    }
}

/// The wavelengths whose ratios have tables of their own: those between have that of the most similar ratio, an eighth of the
/// dispersion away at most.
fn wavelengths(inside: &Medium, other: &Medium) -> Vec<Wavelength> {
    if !inside.is_dispersive() && !other.is_dispersive() {
        return vec![Wavelength::NONE];
    }
    [0, 27, 65, 128, 255].map(Wavelength::of_cell).to_vec()
}

/// Points of the quadrature over microfacet normals, and the step between them around the surface normal: neighbouring
/// Fibonacci numbers. No two points are at the same distance from the pole, so that total reflection, which begins at one
/// distance, is resolved: with a grid of 48 by 16 entries are off by up to 0.01, with these points by 0.0025.
const POINTS: usize = 987;
const STEP: usize = 610;

/// E by a quadrature over the visible microfacet normals.
fn kept(alpha: f32, cosine: f32, eta: f32) -> f64 {
    let o = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let mut sum = 0.0_f64;
    for k in 0..POINTS {
        let u = (k as f32 + 0.5) / POINTS as f32;
        // Half a turn is enough, by symmetry.
        let v = 0.5 * ((k * STEP % POINTS) as f32 + 0.5) / POINTS as f32;
        let h = ggx::visible_normal(alpha, o, u, v);
        let across = o.dot(h);
        let split = fresnel(across, eta);
        let reflected = 2.0 * across * h.z - o.z;
        let transmitted = h.z * (across / eta - split.cos_transmitted) - o.z / eta;
        // G2/G1 for a direction of this height.
        let weight = |height: f32| {
            let both = 2.0 * height * ggx::visibility(alpha, o.z, height) * (o.z + ggx::spread(alpha, o.z));
            f64::from(both)
        };
        if reflected > 0.0 {
            sum += f64::from(split.reflectance) * weight(reflected);
        }
        if transmitted < 0.0 {
            sum += f64::from(1.0 - split.reflectance) * weight(-transmitted);
        }
    }
    sum / POINTS as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E where light leaves a medium whose index is hardly larger, and where it is totally reflected: as an independent program
    /// integrates them in double precision, by 1.6 million points.
    #[test]
    fn shares_at_total_reflection() {
        for (alpha, cosine, eta, expected) in [
            (0.25_f32, 1.0_f32, 1.0_f32 / 1.05, 0.992_57),
            (0.6, 1.0, 1.0 / 1.05, 0.958_72),
            (0.04, 0.6, 1.0 / 1.5, 0.995_63),
            (1.0, 0.15, 1.0 / 1.5, 0.499_47),
            (0.04, 0.6, 1.0 / 2.4, 0.996_41),
            (1.0, 0.15, 1.0 / 2.4, 0.636_17),
        ] {
            let found = kept(alpha, cosine, eta);
            assert!((found - expected).abs() < 2e-3, "{alpha} {cosine} {eta}: {found} for {expected}");
        }
    }

    /// Mean losses at an index of 1.5 from outside and from inside, as computed by an independent program.
    #[test]
    fn mean_losses() {
        let pair = [1.5_f32, 1.0 / 1.5];
        let table = RoughGlassTable {
            ratios: vec![pair],
            entries: tabulate(|alpha, cosine| pair.map(|eta| kept(alpha, cosine, eta))),
        };
        for (alpha, outside, inside) in
            [(0.1_f32, 0.009, 0.034), (0.25, 0.029, 0.135), (0.5, 0.079, 0.306), (1.0, 0.20, 0.52)]
        {
            for (eta, expected) in [(1.5, outside), (1.0 / 1.5, inside)] {
                let losses = table.losses(eta);
                let found = table.mean_lost(losses, 0, alpha.sqrt());
                assert!((found - expected).abs() < 3e-3 + 0.01 * expected, "{alpha} {eta}: {found} for {expected}");
                let beyond = table.mean_lost(losses, 1, alpha.sqrt());
                assert_eq!(beyond, table.mean_lost(table.losses(1.0 / eta), 0, alpha.sqrt()));
            }
        }
    }
}
