//! Condition numbers of the light tree's functions: how much rounding errors of divisions and square roots change them.

use photon_core::glam::Vec3;
use photon_core::light_sampler::DEFENSIVE_SHARE;
use photon_core::light_tree::{LEAF, LightNode, NO_CHILD, TRAIL_BITS, TREE_WORDS, WIDTH};

use super::Input;
use super::light_tree::{ERROR, Place, SCENE, TREE, node, place};

/// Displacement for differences.
const CHANGE: f32 = 1e-6;
/// Displacement that changes any angle at a point by more than rounding does: by 1e-5 / (√3 · √3), for distances of at
/// most √3 and the best of three axes. Each of the four roots in an angle changes it by half of its relative error of
/// 5.4e-7 at most, and the roundings of the products after them by less than 1e-6 together.
const DECISIVE: f32 = 1e-5;
/// Relative error of a share of exact importances, a division and four roundings, as a part of [`ERROR`].
const SHARE: f64 = 0.125;
/// One random word, as a share of all.
const WORD: f64 = 1.0 / 4_294_967_296.0;

/// The place moved, and the normal turned, by `step` along each axis.
fn moved((position, normal): Place, step: f32) -> impl Iterator<Item = Place> {
    let steps = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * step);
    let all = steps.into_iter().chain(steps.map(|step| -step));
    all.flat_map(move |step| [(position + step, normal), (position, normal + step)])
}

/// Condition number of a node's importance: its change for a position or a normal changed by 1e-6, divided by 1e-6; at
/// least its value. Infinite where rounding may decide whether it is 0.
fn of_node(node: &LightNode, at: Place) -> f64 {
    let importance = |(position, normal)| f64::from(node.importance(position, normal));
    let before = importance(at);
    if moved(at, DECISIVE).any(|place| (importance(place) > 0.0) != (before > 0.0)) {
        return f64::INFINITY;
    }
    let change = moved(at, CHANGE).map(|place| (importance(place) - before).abs()).fold(0.0, f64::max);
    before.max(change / f64::from(CHANGE))
}

/// That of the node with the input's index.
pub(super) fn condition_of_importance(i: &Input) -> f64 {
    of_node(&node(i), place(i))
}

/// The descent to a leaf.
struct Descent {
    /// Random numbers in `[0, 1)` that lead to the leaf: the first of them, and how many there are.
    start: f64,
    probability: f64,
    /// Condition number of that probability, in its proportion.
    condition: f64,
    /// How far rounding may move `start` and the end.
    error: f64,
}

/// Descends to a light.
fn descent(light: usize, at: Place) -> Descent {
    let mut trail = TREE.trails()[light];
    let mut found = Descent { start: 0.0, probability: 1.0, condition: 0.0, error: 0.0 };
    let mut next = 0;
    while next & LEAF == 0 {
        let nodes = &TREE.nodes()[next as usize];
        let shares = nodes.words(at.0, at.1).map(|words| f64::from(words) * WORD);
        let relative: [f64; WIDTH] = std::array::from_fn(|child| {
            let node = nodes.node(child);
            match f64::from(node.importance(at.0, at.1)) {
                importance if importance > 0.0 => of_node(&node, at) / importance,
                _ if of_node(&node, at).is_finite() => 0.0,
                _ => f64::INFINITY,
            }
        });
        let largest = (0..WIDTH).fold(0, |best, child| if shares[child] > shares[best] { child } else { best });
        // A share is one importance divided by the sum of all: the derivative of a / (a + b + ...).
        let slope = |child: usize| -> f64 {
            let factor = |other: usize| if other == child { 1.0 - shares[child] } else { shares[other] };
            (0..WIDTH).map(|other| factor(other) * relative[other]).sum()
        };
        // What the others get wrong, the largest share gets wrong too.
        let others: f64 = (0..WIDTH)
            .filter(|&child| child != largest && nodes.next[child] != NO_CHILD)
            .map(|child| shares[child] * (SHARE + slope(child)) + WORD / ERROR)
            .sum();
        let child = trail as usize % WIDTH;
        found.error += found.probability * others * ERROR;
        let own = SHARE + slope(child) + WORD / shares[child] / ERROR;
        found.condition += if child == largest { own.max(others / shares[child]) } else { own };
        found.start += found.probability * shares[..child].iter().sum::<f64>();
        found.probability *= shares[child];
        (next, trail) = (nodes.next[child], trail >> TRAIL_BITS);
    }
    found
}

fn of_light(light: usize, at: Place) -> f64 {
    let descent = descent(light, at);
    let view = SCENE.view();
    let total = TREE.probability(view.light_cdf, at.0, at.1, light);
    total + (1.0 - DEFENSIVE_SHARE) * descent.probability * descent.condition
}

/// Condition number of a light's probability: the sum over the levels of the tree of the relative change of the
/// probability there.
pub(super) fn condition_of_probability(i: &Input) -> f64 {
    of_light(i.0[3] as usize, place(i))
}

/// The same for a picked light; infinite where rounding may decide which light it is.
pub(super) fn condition_of_pick(i: &Input) -> f64 {
    let at = place(i);
    let (light, _) = TREE.pick(SCENE.view().light_cdf, at.0, at.1, [i.0[8], i.0[9]]);
    if i.0[8] < TREE_WORDS {
        let descent = descent(light, at);
        let random = f64::from(i.0[8]) / f64::from(TREE_WORDS);
        // Further words extend the first one, which is known to one word, at each level.
        let margin = descent.error + 4.0 * WORD;
        let after_another = descent.start > 0.0;
        if after_another && random - descent.start <= margin || descent.start + descent.probability - random <= margin {
            return f64::INFINITY;
        }
    }
    of_light(light, at)
}
