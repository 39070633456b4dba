//! Projection maps: aim light paths at mirrors and glass, for the caustic map.
//!
//! After Jensen's projection maps (1996, section 3). The random numbers that determine origin and direction of an
//! emitted photon are a point in a unit cube, which is divided into cells of equal measure. Cells from which a
//! specular surface could be hit are marked; aimed photons are sampled uniformly from these cells only, and carry
//! correspondingly less power. Marking is conservative, so that the expectation is the same as with photons in all
//! directions. Occlusion is ignored.

use std::cell::LazyCell;
use std::ops::ControlFlow;

use bytemuck::{Pod, Zeroable};

use crate::requirements::{Requirements, reflects};
use crate::scene::light::Light;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::{SceneView, light_cdf, light_probability, pick_light};
use crate::settings::{CausticPhotons, Settings};
use crate::shading::light_cone::LightCone;

mod cells;
mod clusters;
mod environment;

pub use environment::ProjectionDisc;

/// Maximum number of cells of all lights together, without the words of discs; beyond it, a light has one cell per side.
const CELLS: usize = 1 << 20;

/// Maximum number of specular spheres times lights, which determines the time for marking.
const PAIRS: usize = 1 << 20;

/// Maximum number of spheres for an environment, whose cells are larger.
const ENVIRONMENT_SPHERES: usize = 256;

/// A light from which a specular surface could be hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[non_exhaustive]
pub struct ProjectionTarget {
    /// Power of each of its aimed photons, like [`crate::PhotonRay::power`]; of a spot light with a cone where it is brightest.
    pub carried: [f32; 3],
    /// Index of the light in the scene's table.
    pub light: u32,
    /// Index of its first cell in [`ProjectionMap::cells`]. If it is infinitely far away, the four words before are those
    /// of its [`ProjectionMap::disc`].
    pub first: u32,
    /// Number of its cells, ≥ 1.
    pub count: u32,
    /// Bits of a cell for each random number of the point on the light.
    pub point_bits: u32,
    /// Bits of a cell for each random number of the direction.
    pub direction_bits: u32,
}

/// The cells of all lights from which a specular surface could be hit.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectionMap {
    targets: Vec<ProjectionTarget>,
    starts: Vec<u32>,
    cells: Vec<u32>,
    share: f64,
}

/// A sample of an aimed photon: random words that replace those by which it would be emitted.
// Exhaustive: backends compare it with that of their own twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProjectionSample {
    /// Index in [`ProjectionMap::targets`].
    pub target: usize,
    /// Random words of the point on the light.
    pub point: [u32; 2],
    /// Random words of the direction.
    pub direction: [u32; 2],
    /// Its highest bit: the side of a two-sided light.
    pub side: u32,
}

/// Why photons are not aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoProjection {
    /// The settings fill the caustic map with the paths that fill the other maps.
    Shared,
    /// No light could reach a specular surface.
    Unlit,
    /// Too much of the light could, or mostly rough ones: aiming is not worthwhile in addition to the paths that other
    /// maps need.
    NotWorth,
    /// Too much of the light is that of an environment, whose caustics are smooth and faint beside its direct light: as for
    /// [`Self::NotWorth`].
    Environment,
}

/// Result of marking.
struct Marking {
    projection: ProjectionMap,
    /// Share of the light by which it is decided whether to aim: that of an environment counts as a whole, unless it is rare.
    counted: f64,
    /// Whether all cells were tested; if not, those marked so far hold more than the given share of the light.
    whole: bool,
    /// Number of blocks of cells that were tested, of any size: a measure of the work.
    #[cfg_attr(not(test), expect(dead_code, reason = "what tests count"))]
    blocks: u64,
}

impl ProjectionMap {
    /// Aiming is worthwhile in addition to other paths if at most this share of the light could reach a
    /// specular surface, and most of that light a smooth one: more photons make derived radii smaller, and the error
    /// of sharp caustics is mostly bias. The light of an environment counts as a whole, unless it is [`Self::RARE`].
    pub const WORTH: f64 = 0.5;

    /// Share of an environment's photons that could reach a specular surface below which it counts in proportion: other paths
    /// would hardly ever find a small glass on a wide plain.
    pub const RARE: f64 = 1e-3;

    /// The same where mirrors and smooth glass are not what most of that light could reach: caustics of rough surfaces are
    /// smooth, and have no bias that smaller radii would reduce.
    pub const WORTH_ROUGH: f64 = 0.05;

    /// Density of aimed photons over that of the photons of other paths, unless that takes less than a quarter or more
    /// than twice the number of these.
    const DENSITY: f64 = 10.0;

    /// Number of aimed paths beside `photons` others, with `share` of the light in marked cells.
    fn paths(photons: u32, share: f64) -> u32 {
        let factor = (Self::DENSITY * share).clamp(0.25, 2.0);
        // Rounded down; converted to u32, a number that is too large becomes the largest.
        ((f64::from(photons) * factor) as u32).max(1)
    }

    /// Marks the cells of all lights of `scene`.
    #[must_use]
    pub fn of(scene: &SceneView<'_>) -> Self {
        Self::mark(scene, f64::INFINITY).projection
    }

    /// The projection map for `scene`, and the number of aimed paths per pass. Marking ends as soon as it
    /// is known not to be worthwhile.
    ///
    /// # Errors
    /// The reason why no paths are aimed.
    pub fn chosen(
        scene: &SceneView<'_>,
        settings: &Settings,
        required: &Requirements,
    ) -> Result<(Self, u32), NoProjection> {
        let (most, is_certain) = match settings.caustic_photons {
            CausticPhotons::Shared => return Err(NoProjection::Shared),
            CausticPhotons::Auto if required.aims_alone() => (f64::INFINITY, true),
            CausticPhotons::Auto if scene.materials_in_use().any(is_smooth) => (Self::WORTH, false),
            CausticPhotons::Auto => (Self::WORTH_ROUGH, false),
            CausticPhotons::Aimed(_) => (f64::INFINITY, true),
        };
        if environment_share(scene) > most && !is_rare(scene) {
            return Err(NoProjection::Environment);
        }
        let Marking { projection, counted, whole, .. } = Self::mark(scene, most);
        match (whole, projection.is_empty()) {
            (false, _) => Err(NoProjection::NotWorth),
            (true, true) => Err(NoProjection::Unlit),
            (true, false) => {
                let rough = counted > Self::WORTH_ROUGH;
                if !is_certain && rough && !Self::is_sharp(scene, counted) {
                    return Err(NoProjection::NotWorth);
                }
                let paths = projection.aimed_paths(settings, required);
                Ok((projection, paths))
            }
        }
    }

    /// Number of aimed paths per pass. Nothing else that [`Self::chosen`] returns depends on [`Settings::photons`].
    pub(crate) fn aimed_paths(&self, settings: &Settings, required: &Requirements) -> u32 {
        match settings.caustic_photons {
            CausticPhotons::Aimed(paths) => paths,
            CausticPhotons::Auto if required.aims_alone() => settings.photons,
            CausticPhotons::Auto | CausticPhotons::Shared => Self::paths(settings.photons, self.share),
        }
    }

    /// Marks cells until it is known whether they hold more than a share of `most` of the light.
    fn mark(scene: &SceneView<'_>, most: f64) -> Marking {
        Self::mark_among(scene, &|material| reflects(material, scene), most)
    }

    /// Whether at least half of the light that could reach a specular surface, a share of `share` of all light, could
    /// reach a smooth one.
    fn is_sharp(scene: &SceneView<'_>, share: f64) -> bool {
        if scene.materials_in_use().all(|material| is_smooth(material) || !reflects(material, scene)) {
            return true;
        }
        !Self::mark_among(scene, &is_smooth, 0.5 * share).whole
    }

    fn mark_among(scene: &SceneView<'_>, among: &dyn Fn(&Material) -> bool, most: f64) -> Marking {
        let lights = scene.lights.len().max(1);
        let fine = LazyCell::new(|| clusters::of(scene, among, (PAIRS / lights).clamp(1, 4096)));
        let coarse = LazyCell::new(|| clusters::of(scene, among, ENVIRONMENT_SPHERES));
        let bits = (CELLS / lights).max(1).ilog2();
        let cones = LightCone::of_lights(scene);
        let cone_of = |index: usize| cones.get(index).copied().flatten();
        // Light that leaves outside of a cone meets nothing.
        let within = |index: usize| cone_of(index).map_or(1.0, |cone| cone.share(&scene.lights[index]));
        let all: f64 = scene.lights.iter().enumerate().map(|(index, light)| within(index) * power_of(light)).sum();
        let mut projection = Self { targets: Vec::new(), starts: Vec::new(), cells: Vec::new(), share: 0.0 };
        let (mut weights, mut shares, mut marked, mut counted, mut blocks) = (Vec::new(), Vec::new(), 0.0, 0.0, 0);
        for (index, light) in scene.lights.iter().enumerate() {
            let power = within(index) * power_of(light);
            if !(power > 0.0) {
                continue;
            }
            let (point_bits, direction_bits) = cells::bits(light, bits);
            let is_environment = light.kind == Light::ENVIRONMENT;
            let spheres: &[_] = if is_environment { &coarse } else { &fine };
            let is_infinite = is_environment || light.kind == Light::DIRECTIONAL;
            let disc = (is_infinite && !spheres.is_empty()).then(|| ProjectionDisc::around(spheres, light));
            // The share of its photons that start in the cells so far.
            let of_disc = disc.map_or(1.0, |disc| disc.share(light));
            let part = |target: &ProjectionTarget| of_disc * in_cells(light, target);
            let rare = if is_environment { Self::RARE } else { 1.0 };
            let counts = |target: &ProjectionTarget| power * (part(target) / rare).min(1.0);
            projection.cells.extend(disc.iter().flat_map(ProjectionDisc::words));
            let first = projection.cells.len() as u32;
            let mut target = ProjectionTarget {
                light: index as u32,
                first,
                point_bits,
                direction_bits,
                ..ProjectionTarget::default()
            };
            let end = cells::mark(
                scene,
                light,
                (point_bits, direction_bits),
                (disc, cone_of(index)),
                spheres,
                &mut blocks,
                &mut |cell| {
                    projection.cells.push(cell);
                    target.count += 1;
                    // The same sum as for whole lights, so that the last cell gives the same result as all of
                    // them.
                    let share = (counted + counts(&target)) / all;
                    if share > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                },
            );
            if end.is_break() {
                return Marking { projection, counted: f64::INFINITY, whole: false, blocks };
            }
            if target.count > 0 {
                shares.push(part(&target));
                weights.push(power * part(&target));
                marked += power * part(&target);
                counted += counts(&target);
                projection.targets.push(target);
            }
        }
        projection.share = if all > 0.0 { marked / all } else { 0.0 };
        projection.starts = light_cdf(&weights);
        for (index, target) in projection.targets.iter_mut().enumerate() {
            let light = &scene.lights[target.light as usize];
            let within = within(target.light as usize);
            let factor = within * shares[index] / light_probability(&projection.starts, index);
            target.carried = light.power.map(|power| (f64::from(power) * factor) as f32);
        }
        let counted = if all > 0.0 { counted / all } else { 0.0 };
        Marking { projection, counted, whole: true, blocks }
    }

    /// Whether no light could reach a specular surface, so that no photons have to be emitted for caustics.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// The share in marked cells of the power that leaves towards the scene: the rest causes no caustics.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The lights that have marked cells.
    #[must_use]
    pub fn targets(&self) -> &[ProjectionTarget] {
        &self.targets
    }

    /// Where each target's interval in the range of a random `u32` begins, like [`SceneView::light_cdf`].
    #[must_use]
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The disc through which the aimed photons of a light that is infinitely far away start.
    ///
    /// # Panics
    /// May panic if `target` is that of another light: before its cells are no words of a disc.
    #[inline]
    #[must_use]
    pub fn disc(&self, target: &ProjectionTarget) -> ProjectionDisc {
        let first = target.first as usize;
        ProjectionDisc::from_words(std::array::from_fn(|i| self.cells[first - 4 + i]))
    }

    /// The marked cells of all targets, and the words of discs. From the lowest bit of a cell: two numbers of
    /// [`ProjectionTarget::direction_bits`] each, the second first; two of [`ProjectionTarget::point_bits`]
    /// each, likewise; one bit for the side.
    #[must_use]
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Memory of the tables, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (self.targets.len() * (size_of::<ProjectionTarget>() + 4) + self.cells.len() * 4) as u64
    }

    /// Samples one aimed photon: `light` and `start` are its words of [`crate::random::BLOCK_LIGHT`] and
    /// [`crate::random::BLOCK_START`]. [`ProjectionMap::is_empty`] must be false.
    #[inline]
    #[must_use]
    pub fn sample(&self, light: [u32; 4], start: [u32; 4]) -> ProjectionSample {
        let [choice, a, b, side] = light;
        let [c, d, ..] = start;
        let index = pick_light(&self.starts, choice);
        let target = &self.targets[index];
        // The first number of the direction, which is the most evenly distributed in a sequence, selects
        // the cell and the position in it; consecutive cells are neighbours.
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

/// Power of a light, sum of RGB.
fn power_of(light: &Light) -> f64 {
    light.power.iter().map(|&power| f64::from(power)).sum()
}

/// The share of an environment in the power of all lights.
fn environment_share(scene: &SceneView<'_>) -> f64 {
    let arriving = LightCone::arriving(scene);
    let all: f64 = scene.lights.iter().zip(arriving).map(|(light, arriving)| arriving * power_of(light)).sum();
    let environments = scene.lights.iter().filter(|light| light.kind == Light::ENVIRONMENT);
    environments.map(power_of).sum::<f64>() / all.max(f64::MIN_POSITIVE)
}

/// Whether the disc of an environment's aimed photons is so small that it does not count as a whole.
fn is_rare(scene: &SceneView<'_>) -> bool {
    let Some(sphere) = clusters::whole(scene, &|material| reflects(material, scene)) else { return false };
    let mut environments = scene.lights.iter().filter(|light| light.kind == Light::ENVIRONMENT);
    environments.all(|light| ProjectionDisc::around(&[sphere], light).share(light) < ProjectionMap::RARE)
}

/// Whether a surface reflects or refracts like a mirror.
fn is_smooth(material: &Material) -> bool {
    match material.kind() {
        MaterialKind::Mirror => true,
        MaterialKind::Dielectric | MaterialKind::Thin => !material.is_rough_glass(),
        MaterialKind::Lambert | MaterialKind::Glossy => false,
    }
}

/// The word with `cell` in its upper `bits`, and the upper bits of `random` below.
#[inline]
fn within(cell: u32, bits: u32, random: u32) -> u32 {
    if bits == 0 { random } else { cell << (32 - bits) | random >> bits }
}

/// The share of a light's cells that is marked.
fn in_cells(light: &Light, target: &ProjectionTarget) -> f64 {
    let sides = if light.flags & Light::BOTH_SIDES == 0 { 0 } else { 1 };
    let bits = 2 * target.point_bits + 2 * target.direction_bits + sides;
    f64::from(target.count) / (1_u64 << bits) as f64
}

#[cfg(test)]
mod tests;
