//! Simulation of a device whose divisions and square roots are as inaccurate as Vulkan allows: it is within the bounds of
//! the light tree, and one that is much more inaccurate is not.

use photon_core::glam::Vec3;
use photon_core::light_tree::{
    COSINE_STEPS, LEAF, LightNode, LightNodes, MAX_WORDS, MIN_DISTANCE_SHARE, MIN_SQUARED, NEXT_WORD, NO_CHILD,
    TRAIL_BITS, TREE_WORDS, WIDTH, extend_word,
};
use photon_core::{light_probability, octahedral, pick_light};

use super::light_tree::{Place, SCENE, TREE, node, place, rows};
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

    fn length(self, [cos, sin]: Angle, operation: u32) -> f32 {
        self.root(cos * cos + sin * sin, operation)
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
            if everywhere {
                return node.intensity;
            }
            let angle = off_axis(normal);
            return node.intensity * self.divided(angle[0] / self.length(angle, 2), 3).max(0.0);
        }
        let gap = Vec3::from(node.center) - position;
        let (squared, reach) = (gap.length_squared(), node.radius * node.radius);
        let divisor = squared.max(reach * MIN_DISTANCE_SHARE).max(MIN_SQUARED);
        if squared <= reach.max(MIN_SQUARED) {
            return self.divided(node.intensity / divisor, 4);
        }
        let seen = [self.root(squared - reach, 5), node.radius];
        let received = minus(self.between(normal, gap, 6), seen);
        let mut lengths = self.length(received, 7);
        let [cos, sin] = if everywhere { [1.0, 0.0] } else { minus(off_axis(-gap), seen) };
        if !everywhere {
            lengths *= self.length([cos, sin], 2);
        }
        let within = emission <= 0.0 || sin * sin * (emission * emission) <= cos * cos * square(emission);
        if !(received[0] > 0.0 && cos > 0.0 && within) {
            return 0.0;
        }
        self.divided(node.intensity * self.divided(received[0] * cos / lengths, 8) / divisor, 4)
    }

    fn words(self, nodes: &LightNodes, at: Place) -> [u32; WIDTH] {
        let sum = |[a, b, c, d, e, f, g, h]: [f32; WIDTH]| ((a + e) + (c + g)) + ((b + f) + (d + h));
        let usable = |parts| (f32::MIN_POSITIVE..=f32::MAX).contains(&sum(parts));
        // Other signs for each node: equal errors would cancel.
        let of_node = |node: &LightNode| Self { signs: self.signs ^ node.next.wrapping_mul(0x9E37_79B9) >> 16, ..self };
        let exists = nodes.next.map(|next| next != NO_CHILD);
        let mut parts = std::array::from_fn(|child| {
            let node = nodes.node(child);
            if exists[child] { of_node(&node).importance(&node, at) } else { 0.0 }
        });
        if !usable(parts) {
            parts = nodes.intensity;
        }
        if !usable(parts) {
            parts = exists.map(|exists| f32::from(u8::from(exists)));
        }
        let share = |part: f32| self.divided(part / sum(parts), 9) * 4_294_967_296.0;
        let mut words: [u32; WIDTH] =
            std::array::from_fn(
                |child| {
                    if exists[child] { share(parts[child]).clamp(1.0, MAX_WORDS) as u32 } else { 0 }
                },
            );
        let largest = (0..WIDTH).fold(0, |best, child| if parts[child] > parts[best] { child } else { best });
        words[largest] = words[largest].wrapping_sub(words.iter().fold(0, |sum: u32, &part| sum.wrapping_add(part)));
        words
    }

    /// The light, and its probability, multiplied in f32 as kernels do.
    fn descend(self, at: Place, mut choose: impl FnMut(&[u32; WIDTH]) -> usize) -> (usize, f32) {
        let (mut next, mut probability) = (0, 1.0_f32);
        while next & LEAF == 0 {
            let nodes = &TREE.nodes()[next as usize];
            let words = self.words(nodes, at);
            let child = choose(&words);
            probability *= words[child] as f32 * (1.0 / 4_294_967_296.0);
            next = nodes.next[child];
        }
        let light = (next & !LEAF) as usize;
        let share = TREE_WORDS as f32 * (1.0 / 4_294_967_296.0);
        let power = light_probability(SCENE.view().light_cdf, light) as f32;
        (light, share * probability + (1.0 - share) * power)
    }

    fn probability(self, light: usize, at: Place) -> f32 {
        let mut trail = TREE.trails()[light];
        let next = |_: &_| {
            let child = trail as usize % WIDTH;
            trail >>= TRAIL_BITS;
            child
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
        self.descend(at, |words| {
            low = low.wrapping_mul(NEXT_WORD[0]).wrapping_add(NEXT_WORD[1]);
            let start = |child: usize| words[..child].iter().sum::<u32>();
            let child = (0..WIDTH).rev().find(|&child| words[child] != 0 && word >= start(child)).unwrap();
            word = extend_word(word - start(child), low, words[child]);
            child
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
            1 => output([rough.importance(&node(i), place(i))]),
            2 => {
                let (light, share) = rough.pick(place(i), [i.0[8], i.0[9]]);
                output([light as f32, share])
            }
            _ => output([rough.probability(i.0[3] as usize, place(i))]),
        });
    }
}
