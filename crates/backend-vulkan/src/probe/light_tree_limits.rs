//! Simulation of a device whose divisions and square roots are as inaccurate as Vulkan allows: it is within the bounds of
//! the light tree, and one that is much more inaccurate is not.

use photon_core::glam::Vec3;
use photon_core::light_tree::{
    COSINE_STEPS, LEAF, LightNode, MIN_DISTANCE_SHARE, MIN_SQUARED, NEXT_WORD, TREE_WORDS, extend_word,
};
use photon_core::{light_probability, octahedral, pick_light};

use super::light_tree::{Place, SCENE, TREE, place, rows};
use super::rough::{Rough, assert_bounded};
use super::table::output;

type Angle = [f32; 2];

fn minus([cos, sin]: Angle, [other_cos, other_sin]: Angle) -> Angle {
    let difference = sin * other_cos - cos * other_sin;
    if difference < 0.0 { [1.0, 0.0] } else { [cos * other_cos + sin * other_sin, difference] }
}

impl Rough {
    fn between(self, a: Vec3, b: Vec3, operation: u32) -> Angle {
        [a.dot(b), self.root(a.cross(b).length_squared(), operation)]
    }

    fn cosine(self, [cos, sin]: Angle, operation: u32) -> f32 {
        self.divided(cos / self.root(cos * cos + sin * sin, operation), operation + 1)
    }

    fn importance(self, node: &LightNode, (position, normal): Place) -> f32 {
        let [spread, emission] = [node.cone, node.cone >> 16].map(|half| f32::from(half as u16 as i16));
        let square = |steps: f32| (COSINE_STEPS - steps) * (COSINE_STEPS + steps);
        let off_axis = |direction| {
            let axis = octahedral::unpack_unnormalized(node.axis);
            minus(self.between(axis, direction, 0), [spread, self.root(square(spread), 1)])
        };
        let everywhere = spread <= -COSINE_STEPS;
        if node.radius < 0.0 {
            return node.intensity * if everywhere { 1.0 } else { self.cosine(off_axis(normal), 2).max(0.0) };
        }
        let gap = Vec3::from(node.center) - position;
        let (squared, reach) = (gap.length_squared(), node.radius * node.radius);
        let divisor = squared.max(reach * MIN_DISTANCE_SHARE).max(MIN_SQUARED);
        if squared <= reach.max(MIN_SQUARED) {
            return self.divided(node.intensity / divisor, 4);
        }
        let seen = [self.root(squared - reach, 5), node.radius];
        let cosine = self.cosine(minus(self.between(normal, gap, 6), seen), 7);
        let [cos, sin] = if everywhere { [1.0, 0.0] } else { minus(off_axis(-gap), seen) };
        let within = emission <= 0.0 || sin * sin * (emission * emission) <= cos * cos * square(emission);
        if !(cosine > 0.0 && cos > 0.0 && within) {
            return 0.0;
        }
        self.divided(node.intensity * cosine * self.cosine([cos, sin], 2) / divisor, 4)
    }

    fn threshold(self, children: [&LightNode; 2], at: Place) -> u32 {
        let usable = |[first, second]: [f32; 2]| (f32::MIN_POSITIVE..=f32::MAX).contains(&(first + second));
        // Other signs for each node: equal errors would cancel.
        let of_node = |node: &LightNode| Self { signs: self.signs ^ node.next.wrapping_mul(0x9E37_79B9) >> 16, ..self };
        let mut parts = children.map(|node| of_node(node).importance(node, at));
        if !usable(parts) {
            parts = children.map(|node| node.intensity);
        }
        let [first, second] = if usable(parts) { parts } else { [1.0; 2] };
        let share = self.divided(first.min(second) / (first + second), 9);
        let words = (share * 4_294_967_296.0).max(1.0) as u32;
        if first <= second { words } else { words.wrapping_neg() }
    }

    /// The light, and its probability, multiplied in f32 as kernels do.
    fn descend(self, at: Place, mut second: impl FnMut(u32) -> bool) -> (usize, f32) {
        let nodes = TREE.nodes();
        let (mut index, mut probability) = (0, 1.0_f32);
        while nodes[index].next & LEAF == 0 {
            let children = [index + 1, nodes[index].next as usize];
            let threshold = self.threshold(children.map(|child| &nodes[child]), at);
            let second = second(threshold);
            let words = if second { threshold.wrapping_neg() } else { threshold };
            probability *= words as f32 * (1.0 / 4_294_967_296.0);
            index = children[usize::from(second)];
        }
        let light = (nodes[index].next & !LEAF) as usize;
        let share = TREE_WORDS as f32 * (1.0 / 4_294_967_296.0);
        let power = light_probability(SCENE.view().light_cdf, light) as f32;
        (light, share * probability + (1.0 - share) * power)
    }

    fn probability(self, light: usize, at: Place) -> f32 {
        let mut trail = TREE.trails()[light];
        let next = |_| {
            let second = trail & 1 != 0;
            trail >>= 1;
            second
        };
        self.descend(at, next).1
    }

    fn pick(self, at: Place, [first, mut low]: [u32; 2]) -> (usize, f32) {
        if first >= TREE_WORDS {
            let word = extend_word(first - TREE_WORDS, low, TREE_WORDS.wrapping_neg());
            let light = pick_light(SCENE.view().light_cdf, word);
            return (light, self.probability(light, at));
        }
        let mut word = extend_word(first, low, TREE_WORDS);
        self.descend(at, |threshold| {
            low = low.wrapping_mul(NEXT_WORD[0]).wrapping_add(NEXT_WORD[1]);
            let second = word >= threshold;
            let (part, whole) = if second { (word - threshold, threshold.wrapping_neg()) } else { (word, threshold) };
            word = extend_word(part, low, whole);
            second
        })
    }
}

#[test]
fn a_device_at_the_limits_of_vulkan_passes() {
    for row in rows().into_iter().filter(|row| [1, 2, 3].contains(&row.function)) {
        // Any two of the ten operations have each pair of signs in some of these.
        let signs = [0, 0x3FF, 0x155, 0x2AA, 0x0F3, 0x30C, 0x1C7, 0x238, 0x2D9, 0x126, 0x36A, 0x095];
        // The errors of the nodes on the way down to a light rarely add up.
        let too_rough = if row.function == 1 { 10.0 } else { 30.0 };
        assert_bounded(&row, signs.into_iter(), too_rough, |rough, i| match row.function {
            1 => output([rough.importance(&TREE.nodes()[i.0[3] as usize], place(i))]),
            2 => {
                let (light, share) = rough.pick(place(i), [i.0[8], i.0[9]]);
                output([light as f32, share])
            }
            _ => output([rough.probability(i.0[3] as usize, place(i))]),
        });
    }
}
