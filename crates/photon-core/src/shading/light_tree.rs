//! Selection of the light that a shadow ray samples, among many: a binary tree over the lights, whose nodes bound
//! positions and directions of emission (Conty Estevez and Kulla 2018).
//!
//! A shadow ray descends from the root: at each node it takes one of the two children with a probability
//! proportional to [`LightNode::importance`], an estimate of the irradiance from all lights below the child. A tenth of
//! the shadow rays choose by power instead: the importance ignores occlusion and textures, and without them a light that
//! it underestimates would give rare and very bright samples.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::scene::{SceneView, light_probability, pick_light};
use crate::shading::light_sampler::DEFENSIVE_SHARE;
use crate::shading::{octahedral, offset};

mod bounds;
mod build;
#[cfg(test)]
mod tests;

/// If the first random word is below this, a light is chosen by the tree, otherwise by power.
pub const TREE_WORDS: u32 = ((1.0 - DEFENSIVE_SHARE) * WORDS) as u32;
/// Bit of [`LightNode::next`] that marks a leaf.
pub const LEAF: u32 = 1 << 31;
/// Maximum number of levels below the root, which is the number of bits of a path to a leaf.
pub const MAX_DEPTH: u32 = 64;
/// Steps from 0 to 1 of the cosines in [`LightNode::cone`].
pub const COSINE_STEPS: f32 = 32_767.0;
/// Minimum of the squared distance to a node, relative to its squared half diagonal. With 1, as in Conty Estevez and
/// Kulla 2018, the variance under 10⁵ point lights is three times as large; below 0.5, the variance inside a luminous
/// sphere grows.
pub const MIN_DISTANCE_SHARE: f32 = 0.5;
/// Minimum of the squared distance to a light: shadow rays start this far off their surface.
pub const MIN_SQUARED: f32 = offset::STEP * offset::STEP;
/// Multiplier and increment of the linear congruential generator of further random words during a descent.
pub const NEXT_WORD: [u32; 2] = [1_664_525, 1_013_904_223];

const WORDS: f64 = 4_294_967_296.0;

/// A node: bounds of the lights below it. The first child follows its node.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[non_exhaustive]
pub struct LightNode {
    /// Centre of the bounding box, normalised space.
    pub center: [f32; 3],
    /// Half the diagonal of that box; −1 for directional lights and the environment.
    pub radius: f32,
    /// Sum of the lights' peak radiant intensities, mean of RGB; of directional lights and of the environment, their
    /// irradiance on a surface that faces them.
    pub intensity: f32,
    /// Axis of the cone that contains the normals of all lights, packed by [`octahedral::pack`]; of directional lights,
    /// the axis towards them.
    pub axis: u32,
    /// Low half: cosine of the half angle of that cone. High half: cosine of the angle about the normals within which
    /// the lights emit. Both in steps of 1/[`COSINE_STEPS`], signed, rounded down.
    pub cone: u32,
    /// Index of the second child; of a leaf, [`LEAF`] and the index of its light.
    pub next: u32,
}

impl LightNode {
    /// Estimated irradiance on a surface at `position` from all lights of the node: intensity times cosine at the
    /// surface times cosine at the lights, each for the most favourable direction that the bounds allow, divided by
    /// the squared distance of the centre, at least [`MIN_DISTANCE_SHARE`] of the squared half diagonal.
    #[inline(always)]
    #[must_use]
    pub fn importance(&self, position: Vec3, normal: Vec3) -> f32 {
        let [spread, emission] = [self.cone, self.cone >> 16].map(|half| f32::from(half as u16 as i16));
        // Normals in all directions, as of point lights, need no axis.
        let everywhere = spread <= -COSINE_STEPS;
        let off_axis = |direction: Vec3| {
            let axis = octahedral::unpack_unnormalized(self.axis);
            Angle::between(axis, direction).minus(Angle::with_cosine(spread))
        };
        if self.radius < 0.0 {
            return self.intensity * if everywhere { 1.0 } else { off_axis(normal).cosine().max(0.0) };
        }
        let gap = Vec3::from(self.center) - position;
        let squared = gap.length_squared();
        let reach = self.radius * self.radius;
        let divisor = squared.max(reach * MIN_DISTANCE_SHARE).max(MIN_SQUARED);
        if squared <= reach.max(MIN_SQUARED) {
            return self.intensity / divisor;
        }
        // Half angle under which the bounding sphere is seen.
        let seen = Angle { cos: (squared - reach).sqrt(), sin: self.radius };
        let cosine = Angle::between(normal, gap).minus(seen).cosine();
        let emitted = if everywhere { Angle::ZERO } else { off_axis(-gap).minus(seen) };
        if !(cosine > 0.0 && emitted.cos > 0.0 && emitted.is_within(emission)) {
            return 0.0;
        }
        self.intensity * cosine * emitted.cosine() / divisor
    }
}

/// An angle between 0 and π: its cosine and its sine, both times the same positive number.
///
/// Both are computed from vectors, not one from the other: 1 − cos² would turn the rounding error of a cosine near 1
/// into a relative error of the sine that is thousands of times as large.
#[derive(Clone, Copy)]
struct Angle {
    cos: f32,
    sin: f32,
}

impl Angle {
    const ZERO: Self = Self { cos: 1.0, sin: 0.0 };

    /// The angle between two vectors of any length.
    #[inline]
    fn between(a: Vec3, b: Vec3) -> Self {
        Self { cos: a.dot(b), sin: a.cross(b).length() }
    }

    /// The angle whose cosine is `steps` of 1/[`COSINE_STEPS`]; whole numbers, so that the product is exact to rounding.
    #[inline]
    fn with_cosine(steps: f32) -> Self {
        Self { cos: steps, sin: ((COSINE_STEPS - steps) * (COSINE_STEPS + steps)).sqrt() }
    }

    /// The difference, 0 if `other` is larger. `other` is below π.
    #[inline]
    fn minus(self, other: Self) -> Self {
        let sin = self.sin * other.cos - self.cos * other.sin;
        if sin < 0.0 {
            return Self::ZERO;
        }
        Self { cos: self.cos * other.cos + self.sin * other.sin, sin }
    }

    #[inline]
    fn cosine(self) -> f32 {
        self.cos / (self.cos * self.cos + self.sin * self.sin).sqrt()
    }

    /// For an angle below π/2, whether it is at most the one whose cosine is `steps` of 1/[`COSINE_STEPS`].
    #[inline]
    fn is_within(self, steps: f32) -> bool {
        let squares = (COSINE_STEPS - steps) * (COSINE_STEPS + steps);
        steps <= 0.0 || self.sin * self.sin * (steps * steps) <= self.cos * self.cos * squares
    }
}

/// Number of the 2³² random words that select the first of two children; each child is selected by at least one.
#[inline]
#[must_use]
pub fn threshold(children: [&LightNode; 2], position: Vec3, normal: Vec3) -> u32 {
    // Not by `map`, which would call a function for each of them.
    let (mut first, mut second) = (children[0].importance(position, normal), children[1].importance(position, normal));
    let usable = |sum: f32| (f32::MIN_POSITIVE..=f32::MAX).contains(&sum);
    if !usable(first + second) {
        (first, second) = (children[0].intensity, children[1].intensity);
    }
    if !usable(first + second) {
        (first, second) = (1.0, 1.0);
    }
    // The smaller part is divided: 1 minus a rounded quotient near 1 would have few correct digits.
    let words = |part: f32| (part / (first + second) * 4_294_967_296.0).max(1.0) as u32;
    if first <= second { words(first) } else { words(second).wrapping_neg() }
}

/// ⌊(high · 2³² + low) / divisor⌋, for high < divisor: extends a random word below `divisor` by a second one to a
/// word of the whole range.
#[inline]
#[must_use]
pub fn extend_word(high: u32, low: u32, divisor: u32) -> u32 {
    ((u64::from(high) << 32 | u64::from(low)) / u64::from(divisor)) as u32
}

/// A light tree, built once per scene; the same on every backend.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTree {
    nodes: Vec<LightNode>,
    trails: Vec<u64>,
}

impl LightTree {
    /// Builds the tree of the lights of a scene that [`SceneView::validate`] accepts. Deterministic; ties are broken by
    /// index. The number of lights must be above 0 and below 2³⁰.
    #[must_use]
    pub fn new(scene: &SceneView<'_>) -> Self {
        build::tree(scene)
    }

    /// The nodes, the root first.
    #[must_use]
    pub fn nodes(&self) -> &[LightNode] {
        &self.nodes
    }

    /// For each light, the path to its leaf: from the lowest bit, 1 for each second child.
    #[must_use]
    pub fn trails(&self) -> &[u64] {
        &self.trails
    }

    /// Picks a light by two random words, the second of which extends the first; returns its index and probability.
    /// `light_cdf` is [`SceneView::light_cdf`].
    #[must_use]
    pub fn pick(&self, light_cdf: &[u32], position: Vec3, normal: Vec3, random: [u32; 2]) -> (usize, f64) {
        let [mut word, low] = random;
        if word >= TREE_WORDS {
            let index = pick_light(light_cdf, extend_word(word - TREE_WORDS, low, TREE_WORDS.wrapping_neg()));
            return (index, self.probability(light_cdf, position, normal, index));
        }
        word = extend_word(word, low, TREE_WORDS);
        let mut low = low;
        let (index, by_tree) = self.descend(position, normal, |threshold| {
            low = low.wrapping_mul(NEXT_WORD[0]).wrapping_add(NEXT_WORD[1]);
            let second = word >= threshold;
            word = if second {
                extend_word(word - threshold, low, threshold.wrapping_neg())
            } else {
                extend_word(word, low, threshold)
            };
            second
        });
        (index, mixed(by_tree, light_probability(light_cdf, index)))
    }

    /// The probability with which [`LightTree::pick`] returns light `index`: equal to the one that it returns.
    #[must_use]
    pub fn probability(&self, light_cdf: &[u32], position: Vec3, normal: Vec3, index: usize) -> f64 {
        let mut trail = self.trails[index];
        let (_, by_tree) = self.descend(position, normal, |_| {
            let second = trail & 1 != 0;
            trail >>= 1;
            second
        });
        mixed(by_tree, light_probability(light_cdf, index))
    }

    /// Descends to a leaf; `second` decides for the second child, by the threshold. Returns the light and the product of
    /// the probabilities.
    #[inline]
    fn descend(&self, position: Vec3, normal: Vec3, mut second: impl FnMut(u32) -> bool) -> (usize, f64) {
        let mut at = 0;
        let mut probability = 1.0;
        loop {
            let next = self.nodes[at].next;
            if next & LEAF != 0 {
                return ((next & !LEAF) as usize, probability);
            }
            let children = [at + 1, next as usize];
            let threshold = threshold(children.map(|child| &self.nodes[child]), position, normal);
            let second = second(threshold);
            let words = if second { threshold.wrapping_neg() } else { threshold };
            probability *= f64::from(words) / WORDS;
            at = children[usize::from(second)];
        }
    }
}

/// Probability of a light, combined from those of the choice by tree and by power.
#[inline]
fn mixed(by_tree: f64, by_power: f64) -> f64 {
    let share = f64::from(TREE_WORDS) / WORDS;
    share * by_tree + (1.0 - share) * by_power
}
