//! Paths of light that are aimed at mirrors and glass, for the map of caustics.
//!
//! After Jensen's projection maps (1996, section 3): where a photon starts and whither it leaves is a
//! point of a unit cube, that of the random numbers it is drawn by. The cube is parted into cells of
//! equal measure, of which those are marked from which something specular could be met; aimed photons are
//! drawn from these alone, evenly, and carry so much less. Marking errs on the side of too many, so that
//! the expectation is that of photons drawn from everywhere. What stands in between is not looked at.

use std::ops::ControlFlow;

use bytemuck::{Pod, Zeroable};

use crate::requirements::Requirements;
use crate::scene::layout::Light;
use crate::scene::{SceneView, light_cdf, light_probability, pick_light};
use crate::settings::{CausticPhotons, Settings};

mod cells;
mod clusters;

/// Cells of all lights together, at most but for one of each side of each.
const CELLS: usize = 1 << 20;

/// Spheres about specular surfaces times lights, at most: what marking takes time for.
const PAIRS: usize = 1 << 20;

/// A light from which something specular could be met.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ProjectionTarget {
    /// What each of its aimed photons carries, as [`crate::PhotonRay::power`].
    pub carried: [f32; 3],
    /// Index of the light in the scene's table.
    pub light: u32,
    /// Index of its first cell in [`ProjectionMap::cells`].
    pub first: u32,
    /// How many it has, ≥ 1.
    pub count: u32,
    /// Bits of a cell for each number that tells where on the light.
    pub point_bits: u32,
    /// Bits of a cell for each number that tells whither.
    pub direction_bits: u32,
}

/// From which cells of which lights something specular could be met.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectionMap {
    targets: Vec<ProjectionTarget>,
    starts: Vec<u32>,
    cells: Vec<u32>,
    share: f64,
}

/// What one aimed photon leaves by: random words in the places of those that it was drawn by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProjectionSample {
    /// Index in [`ProjectionMap::targets`].
    pub target: usize,
    /// Where on the light.
    pub point: [u32; 2],
    /// Whither.
    pub direction: [u32; 2],
    /// Its highest bit: the side of a light that has two.
    pub side: u32,
}

/// Why no photons are aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoProjection {
    /// The settings leave caustics to the paths that fill the other maps.
    Shared,
    /// No light could shine on anything specular.
    Unlit,
    /// More of the light could than aiming pays for beside the paths that other maps need.
    NotWorth,
}

/// What marking came to.
struct Marking {
    projection: ProjectionMap,
    /// Whether all was marked that there is: if not, more of the light than was asked for.
    whole: bool,
    /// Blocks of cells that were looked at, of any size: the work that it was.
    #[cfg_attr(not(test), expect(dead_code, reason = "what tests count"))]
    blocks: u64,
}

impl ProjectionMap {
    /// Aiming pays beside other paths where no more than this share of the light could meet something specular:
    /// where it is a seventh, they take more from the other layers than caustics gain (docs/studies/requirements.md).
    pub const WORTH: f64 = 0.05;

    /// Marks the cells of all lights of `scene`.
    #[must_use]
    pub fn of(scene: &SceneView<'_>) -> Self {
        Self::mark(scene, f64::INFINITY).projection
    }

    /// What is aimed in `scene`, and how many paths of a pass. Marking ends as soon as the answer is no.
    ///
    /// # Errors
    /// Why nothing is.
    pub fn chosen(
        scene: &SceneView<'_>,
        settings: &Settings,
        required: &Requirements,
    ) -> Result<(Self, u32), NoProjection> {
        let alone = required.maps.iter().all(|(kind, &filled)| kind.is_aimed() || !filled);
        let (most, paths) = match settings.caustic_photons {
            CausticPhotons::Shared => return Err(NoProjection::Shared),
            CausticPhotons::Auto if alone => (f64::INFINITY, settings.photons),
            CausticPhotons::Auto => (Self::WORTH, (settings.photons / 4).max(1)),
            CausticPhotons::Aimed(paths) => (f64::INFINITY, paths),
        };
        let Marking { projection, whole, .. } = Self::mark(scene, most);
        match (whole, projection.is_empty()) {
            (false, _) => Err(NoProjection::NotWorth),
            (true, true) => Err(NoProjection::Unlit),
            (true, false) => Ok((projection, paths)),
        }
    }

    /// Marks cells until it is known whether more than `most` of the light leaves by them.
    fn mark(scene: &SceneView<'_>, most: f64) -> Marking {
        let lights = scene.lights.len().max(1);
        let clusters = clusters::of(scene, (PAIRS / lights).clamp(1, 4096));
        let bits = (CELLS / lights).max(1).ilog2();
        let power_of = |light: &Light| light.power.iter().map(|&p| f64::from(p)).sum::<f64>();
        let all: f64 = scene.lights.iter().map(power_of).sum();
        let mut projection = Self { targets: Vec::new(), starts: Vec::new(), cells: Vec::new(), share: 0.0 };
        let (mut weights, mut marked, mut blocks) = (Vec::new(), 0.0, 0);
        for (index, light) in scene.lights.iter().enumerate() {
            let power = power_of(light);
            if !(power > 0.0) {
                continue;
            }
            let (point_bits, direction_bits) = cells::bits(light, bits);
            let first = projection.cells.len() as u32;
            let mut target = ProjectionTarget {
                light: index as u32,
                first,
                point_bits,
                direction_bits,
                ..ProjectionTarget::default()
            };
            let end = cells::mark(scene, light, (point_bits, direction_bits), &clusters, &mut blocks, &mut |cell| {
                projection.cells.push(cell);
                target.count += 1;
                // The same sum as that of whole lights, so that the last cell decides as all of them do.
                let share = (marked + power * part(light, &target)) / all;
                if share > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            if end.is_break() {
                return Marking { projection, whole: false, blocks };
            }
            if target.count > 0 {
                weights.push(power * part(light, &target));
                marked += power * part(light, &target);
                projection.targets.push(target);
            }
        }
        projection.share = if all > 0.0 { marked / all } else { 0.0 };
        projection.starts = light_cdf(&weights);
        for (index, target) in projection.targets.iter_mut().enumerate() {
            let light = &scene.lights[target.light as usize];
            let factor = part(light, target) / light_probability(&projection.starts, index);
            target.carried = light.power.map(|power| (f64::from(power) * factor) as f32);
        }
        Marking { projection, whole: true, blocks }
    }

    /// Whether no light could shine on anything specular: no photon need be sent out for caustics.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// The share of the scene's power that leaves by marked cells: the rest makes no caustics.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The lights that have marked cells.
    #[must_use]
    pub fn targets(&self) -> &[ProjectionTarget] {
        &self.targets
    }

    /// Where each target's share of the range of a random `u32` begins, as [`SceneView::light_cdf`].
    #[must_use]
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The marked cells of all targets. From the lowest bit: two numbers of
    /// [`ProjectionTarget::direction_bits`] each, the second first; two of [`ProjectionTarget::point_bits`] each, likewise;
    /// one bit for the side.
    #[must_use]
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// What the tables take in memory.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (self.targets.len() * (size_of::<ProjectionTarget>() + 4) + self.cells.len() * 4) as u64
    }

    /// How one photon leaves: `light` and `start` are its words of [`crate::random::BLOCK_LIGHT`] and
    /// [`crate::random::BLOCK_START`]. [`ProjectionMap::is_empty`] must be false.
    #[inline]
    #[must_use]
    pub fn sample(&self, light: [u32; 4], start: [u32; 4]) -> ProjectionSample {
        let [choice, a, b, side] = light;
        let [c, d, ..] = start;
        let index = pick_light(&self.starts, choice);
        let target = &self.targets[index];
        // The first number of the direction, the most even of those of a sequence, says which cell and
        // where in it; cells that follow each other are neighbours.
        let product = u64::from(c) * u64::from(target.count);
        let cell = self.cells[target.first as usize + (product >> 32) as usize];
        let (p, q) = (target.point_bits, target.direction_bits);
        let field = |at: u32, bits: u32| cell >> at & ((1 << bits) - 1);
        ProjectionSample {
            target: index,
            point: [within(field(2 * q + p, p), p, a), within(field(2 * q, p), p, b)],
            direction: [within(field(q, q), q, product as u32), within(field(0, q), q, d)],
            side: cell >> (2 * p + 2 * q) << 31 | side >> 1,
        }
    }
}

/// The word whose upper `bits` are `cell` and whose others are the upper ones of `random`.
#[inline]
fn within(cell: u32, bits: u32, random: u32) -> u32 {
    if bits == 0 { random } else { cell << (32 - bits) | random >> bits }
}

/// The part of a light's photons that leaves by its marked cells.
fn part(light: &Light, target: &ProjectionTarget) -> f64 {
    let sides = if light.flags & Light::BOTH_SIDES == 0 { 0 } else { 1 };
    let bits = 2 * target.point_bits + 2 * target.direction_bits + sides;
    f64::from(target.count) / (1_u64 << bits) as f64
}

#[cfg(test)]
mod tests;
