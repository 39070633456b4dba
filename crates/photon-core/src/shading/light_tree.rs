//! Selection of the light that a shadow ray samples, among many: a tree over the lights, whose nodes bound positions and
//! directions of emission (Conty Estevez and Kulla 2018), with up to eight children for each node.
//!
//! A shadow ray descends from the root: at each node it takes one of the children with a probability proportional to
//! [`LightNode::importance`], an estimate of the irradiance from all lights below the child. A tenth of the shadow rays
//! choose by power instead: the importance ignores occlusion and textures, and without them a light that it
//! underestimates would give rare and very bright samples.
//!
//! Eight children are weighed together by the vector instructions of a processor, and a descent waits for a third as many
//! reads of memory as with two.

use glam::Vec3;

use crate::scene::{SceneView, light_probability, pick_light};
use crate::shading::light_sampler::DEFENSIVE_SHARE;

mod bounds;
mod build;
mod children;
mod node;
#[cfg(test)]
mod tests;

pub use children::{LightNodes, MAX_WORDS, WIDTH};
pub use node::{COSINE_STEPS, LightNode, MIN_DISTANCE_SHARE, MIN_SQUARED};

/// If the first random word is below this, a light is chosen by the tree, otherwise by power.
pub const TREE_WORDS: u32 = ((1.0 - DEFENSIVE_SHARE) * WORDS) as u32;
/// Bit of [`LightNode::next`] that marks a leaf.
pub const LEAF: u32 = 1 << 31;
/// [`LightNode::next`] where there is no child.
pub const NO_CHILD: u32 = u32::MAX;
/// Maximum number of levels below the root.
pub const MAX_DEPTH: u32 = 20;
/// Bits of a trail for each level.
pub const TRAIL_BITS: u32 = WIDTH.trailing_zeros();
/// Multiplier and increment of the linear congruential generator of further random words during a descent.
pub const NEXT_WORD: [u32; 2] = [1_664_525, 1_013_904_223];

const WORDS: f64 = 4_294_967_296.0;

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
    nodes: Vec<LightNodes>,
    trails: Vec<u64>,
}

impl LightTree {
    /// Builds the tree of the lights of a scene that [`SceneView::validate`] accepts. Deterministic; ties are broken by
    /// index.
    ///
    /// # Panics
    /// With less than 2 lights, or with 2³⁰ or more.
    #[must_use]
    pub fn new(scene: &SceneView<'_>) -> Self {
        build::tree(scene)
    }

    /// The children of each node, those of the root first.
    #[must_use]
    pub fn nodes(&self) -> &[LightNodes] {
        &self.nodes
    }

    /// For each light, the path to its leaf: from the lowest bit, [`TRAIL_BITS`] with the number of a child for each level.
    #[must_use]
    pub fn trails(&self) -> &[u64] {
        &self.trails
    }

    /// Picks a light by two random words, the second of which extends the first; returns its index and probability.
    /// `light_cdf` is [`SceneView::light_cdf`].
    #[inline(always)]
    #[must_use]
    pub fn pick(&self, light_cdf: &[u32], position: Vec3, normal: Vec3, random: [u32; 2]) -> (usize, f64) {
        self.pick_several(light_cdf, position, normal, [random])[0]
    }

    /// [`Self::pick`] for several pairs of random words. The processor overlaps their descents, and nodes on the way of
    /// more than one are weighed once.
    #[inline(always)]
    #[must_use]
    pub fn pick_several<const N: usize>(
        &self,
        light_cdf: &[u32],
        position: Vec3,
        normal: Vec3,
        random: [[u32; 2]; N],
    ) -> [(usize, f64); N] {
        let descents = random.map(|[word, low]| {
            if word >= TREE_WORDS {
                let index = pick_light(light_cdf, extend_word(word - TREE_WORDS, low, TREE_WORDS.wrapping_neg()));
                return Descent::new(Choice::Trail(self.trails[index]));
            }
            Descent::new(Choice::Words { word: extend_word(word, low, TREE_WORDS), low })
        });
        self.descend(light_cdf, position, normal, descents)
    }

    /// The probability with which [`LightTree::pick`] returns light `index`: equal to the one that it returns.
    #[inline(always)]
    #[must_use]
    pub fn probability(&self, light_cdf: &[u32], position: Vec3, normal: Vec3, index: usize) -> f64 {
        self.descend(light_cdf, position, normal, [Descent::new(Choice::Trail(self.trails[index]))])[0].1
    }

    /// Descends to the leaves, level by level; returns lights and their probabilities.
    #[inline(always)]
    fn descend<const N: usize>(
        &self,
        light_cdf: &[u32],
        position: Vec3,
        normal: Vec3,
        mut descents: [Descent; N],
    ) -> [(usize, f64); N] {
        let (mut weighed, mut words) = (NO_CHILD, [0; WIDTH]);
        while descents.iter().any(Descent::goes_on) {
            for descent in descents.iter_mut().filter(|descent| descent.goes_on()) {
                let children = &self.nodes[descent.next as usize];
                if descent.next != weighed {
                    (weighed, words) = (descent.next, children.words(position, normal));
                }
                descent.step(children, &words);
            }
        }
        descents.map(|descent| {
            let index = (descent.next & !LEAF) as usize;
            (index, mixed(descent.probability, light_probability(light_cdf, index)))
        })
    }
}

/// What decides for a child.
#[derive(Clone, Copy)]
enum Choice {
    Words { word: u32, low: u32 },
    Trail(u64),
}

/// The state of a descent.
#[derive(Clone, Copy)]
struct Descent {
    /// Index of the next node, or a leaf.
    next: u32,
    /// The product of the probabilities.
    probability: f64,
    choice: Choice,
}

impl Descent {
    fn new(choice: Choice) -> Self {
        Self { next: 0, probability: 1.0, choice }
    }

    #[inline(always)]
    fn goes_on(&self) -> bool {
        self.next & LEAF == 0
    }

    /// Takes one of the children, which are selected by these numbers of random words.
    #[inline(always)]
    fn step(&mut self, children: &LightNodes, words: &[u32; WIDTH]) {
        let child = match &mut self.choice {
            Choice::Words { word, low } => {
                *low = low.wrapping_mul(NEXT_WORD[0]).wrapping_add(NEXT_WORD[1]);
                let (child, start) = child_of_word(words, *word);
                *word = extend_word(*word - start, *low, words[child]);
                child
            }
            Choice::Trail(trail) => {
                let child = *trail as usize % WIDTH;
                *trail >>= TRAIL_BITS;
                child
            }
        };
        self.probability *= f64::from(words[child]) / WORDS;
        self.next = children.next[child];
    }
}

/// The child that a random word selects, and the first word that selects it.
#[inline(always)]
fn child_of_word(words: &[u32; WIDTH], word: u32) -> (usize, u32) {
    // Sums of the words before each child, in three steps of vector instructions.
    let mut starts: [u32; WIDTH] = std::array::from_fn(|child| if child == 0 { 0 } else { words[child - 1] });
    for step in [1, 2, 4] {
        starts = std::array::from_fn(|child| {
            starts[child].wrapping_add(if child < step { 0 } else { starts[child - step] })
        });
    }
    // Below 2³² where there is a child.
    let not_after = (0..WIDTH).map(|child| usize::from((words[child] != 0) & (word >= starts[child])));
    let child = (not_after.sum::<usize>() - 1) % WIDTH;
    (child, starts[child])
}

/// Probability of a light, combined from those of the choice by tree and by power.
#[inline]
fn mixed(by_tree: f64, by_power: f64) -> f64 {
    let share = f64::from(TREE_WORDS) / WORDS;
    share * by_tree + (1.0 - share) * by_power
}
