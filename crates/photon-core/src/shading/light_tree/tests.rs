//! The tree against sums over all lights.

use glam::Vec3;

use super::{LEAF, LightNode, LightTree, MAX_DEPTH, NO_CHILD, TRAIL_BITS, TREE_WORDS, WIDTH, WORDS, extend_word};
use crate::scene::light::Light;
use crate::scene::material::Primitive;
use crate::scene::{SceneView, light_cdf, light_probability};
use crate::shading::light_sampler::weigh;
use crate::shading::random::{philox4x32, unit_f32};
use crate::shading::sampling;

/// Lights, with the triangles of area lights.
#[derive(Debug, Default)]
struct Lights {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    primitives: Vec<Primitive>,
    lights: Vec<Light>,
    starts: Vec<u32>,
}

impl Lights {
    /// Point lights of these positions and powers.
    fn points(lights: impl Iterator<Item = ([f32; 3], f32)>) -> Self {
        let point = |(position, power)| Light {
            kind: Light::POINT,
            primitive: u32::MAX,
            position,
            power: [power; 3],
            ..Light::default()
        };
        Self { lights: lights.map(point).collect(), ..Self::default() }.with_shares()
    }

    /// Lights of every kind at random places: 40 triangles, 40 points, 40 spots, 3 directional ones.
    fn mixed() -> Self {
        let mut all = Self::default();
        for index in 0..123_u32 {
            let mut draws = 0;
            let mut unit = || {
                draws += 1;
                unit_f32(philox4x32([index, draws, 0, 0], [7, 0])[0])
            };
            let direction = sampling::uniform_sphere(unit(), unit());
            let position = Vec3::new(unit(), unit(), unit()) - Vec3::splat(0.5);
            let power = [unit(), 0.1 * unit(), unit() * unit()];
            let (inner, outer) = (0.3 * unit(), 0.3 + 0.7 * unit());
            let light = Light {
                kind: [Light::TRIANGLE, Light::POINT, Light::SPOT, Light::DIRECTIONAL][index as usize / 40],
                position: position.to_array(),
                direction: direction.to_array(),
                primitive: u32::MAX,
                power,
                versine_inner: inner,
                versine_outer: outer,
                radius: 0.9,
                ..Light::default()
            };
            if light.kind != Light::TRIANGLE {
                all.lights.push(light);
                continue;
            }
            let (x, y) = sampling::basis(direction);
            let (x, y) = (x * 0.1 * unit(), y * 0.1 * unit());
            let first = all.positions.len() as u32;
            all.positions.extend([position, position + x, position + y].map(|corner| corner.to_array()));
            all.triangles.push([first, first + 1, first + 2]);
            all.primitives.push(Primitive { normal: direction.to_array(), material: 0 });
            let area = 0.5 * x.cross(y).length();
            all.lights.push(Light { primitive: index, area, flags: u32::from(index % 3 == 0), ..light });
        }
        all.with_shares()
    }

    fn with_shares(mut self) -> Self {
        let powers: Vec<f64> =
            self.lights.iter().map(|light| light.power.iter().map(|&part| f64::from(part)).sum()).collect();
        self.starts = light_cdf(&powers);
        self
    }

    fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            lights: &self.lights,
            light_cdf: &self.starts,
            ..SceneView::default()
        }
    }

    /// Irradiance from each light, as the light sampler estimates it.
    fn weights(&self, position: Vec3, normal: Vec3) -> Vec<f64> {
        let weight = |light: &Light| {
            let triangle = || {
                let index = light.primitive as usize;
                let corners = self.triangles[index].map(|vertex| Vec3::from(self.positions[vertex as usize]));
                (corners, self.primitives[index].normal.into())
            };
            f64::from(weigh(light, triangle, position, normal))
        };
        self.lights.iter().map(weight).collect()
    }
}

/// Surface points, by index.
fn place(index: u32) -> (Vec3, Vec3) {
    let [a, b, c, d] = philox4x32([index, 0, 1, 0], [7, 0]).map(unit_f32);
    let e = unit_f32(philox4x32([index, 1, 1, 0], [7, 0])[0]);
    (Vec3::new(a, b, c) - Vec3::splat(0.5), sampling::uniform_sphere(d, e))
}

fn probabilities(tree: &LightTree, of: &Lights, (position, normal): (Vec3, Vec3)) -> Vec<f64> {
    (0..of.lights.len()).map(|index| tree.probability(&of.starts, position, normal, index)).collect()
}

/// Asserts that the mean of `value / probability` over picks is the sum of the values: |z| ≤ 4.5, where the standard
/// error of the mean of n picks is √((Σ v²/p − (Σ v)²) / n), exact from all probabilities.
fn assert_unbiased(of: &Lights, tree: &LightTree, at: (Vec3, Vec3), picks: u32) {
    let (values, probabilities) = (of.weights(at.0, at.1), probabilities(tree, of, at));
    let sum: f64 = values.iter().sum();
    let second: f64 = values.iter().zip(&probabilities).map(|(value, probability)| value * value / probability).sum();
    let error = ((second - sum * sum).max(0.0) / f64::from(picks)).sqrt();
    let mut mean = 0.0;
    for pick in 0..picks {
        let [random, low, ..] = philox4x32([pick, 0, 2, 0], [7, 0]);
        let (index, probability) = tree.pick(&of.starts, at.0, at.1, [random, low]);
        assert_eq!(probability, probabilities[index], "light {index}");
        mean += values[index] / probability / f64::from(picks);
    }
    assert!((mean - sum).abs() <= 4.5 * error + 1e-12 * sum, "{mean} instead of {sum} ± {error}");
}

#[test]
fn probabilities_sum_to_one_and_are_those_of_picks() {
    let lights = Lights::mixed();
    let tree = LightTree::new(&lights.view());
    for index in 0..50 {
        let at = place(index);
        let sum: f64 = probabilities(&tree, &lights, at).iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        assert_unbiased(&lights, &tree, at, 20_000);
    }
}

/// The nodes from below the root to the leaf of a light.
fn way(tree: &LightTree, light: usize) -> Vec<LightNode> {
    let (mut at, mut trail, mut way) = (0, tree.trails()[light], Vec::new());
    loop {
        let node = tree.nodes()[at].node(trail as usize % WIDTH);
        way.push(node);
        trail >>= TRAIL_BITS;
        if node.next & LEAF != 0 {
            assert_eq!((node.next & !LEAF, trail), (light as u32, 0));
            return way;
        }
        at = node.next as usize;
    }
}

/// Every light is in one leaf, at the end of its trail; children come first, at least two for each node.
#[test]
fn trails_lead_to_their_lights() {
    let lights = Lights::mixed();
    let tree = LightTree::new(&lights.view());
    (0..lights.lights.len()).for_each(|light| assert!(way(&tree, light).len() <= 4));
    let children = tree.nodes().iter().map(|nodes| {
        let count = nodes.next.iter().filter(|&&next| next != NO_CHILD).count();
        assert!(count >= 2 && nodes.next[..count].iter().all(|&next| next != NO_CHILD), "{:?}", nodes.next);
        count
    });
    assert_eq!(children.sum::<usize>(), lights.lights.len() + tree.nodes().len() - 1);
}

/// Each child is selected in proportion to the importance of its node, which is what is computed for it alone; the largest
/// by all words that the others leave.
#[test]
fn words_are_in_proportion_to_the_importance() {
    let lights = Lights::mixed();
    let tree = LightTree::new(&lights.view());
    for index in 0..200 {
        let (position, normal) = place(index);
        for nodes in tree.nodes() {
            let words = nodes.words(position, normal);
            assert_eq!(words.iter().map(|&part| u64::from(part)).sum::<u64>(), 1 << 32);
            let weights: [f32; WIDTH] = std::array::from_fn(|child| nodes.node(child).importance(position, normal));
            assert_eq!(nodes.importances(position, normal), weights);
            let total: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
            for (child, (&words, weight)) in words.iter().zip(weights).enumerate() {
                if nodes.next[child] == NO_CHILD {
                    assert_eq!(words, 0);
                } else if total > 0.0 {
                    let expected = (f64::from(weight) / total * WORDS).max(1.0);
                    assert!((f64::from(words) - expected).abs() <= 9.0 + 4e-7 * expected, "{words}, {expected}");
                }
            }
        }
    }
}

/// No light that shines on a point has an importance of 0 at any node above it: only the shares of power would remain.
#[test]
fn what_shines_is_important() {
    let lights = Lights::mixed();
    let tree = LightTree::new(&lights.view());
    let mut lit = 0;
    for index in 0..200 {
        let (position, normal) = place(index);
        for (light, weight) in lights.weights(position, normal).into_iter().enumerate() {
            // Just above a horizon, the rounding of packed directions decides. The estimate of area lights leaves out
            // the cosine at the point.
            let primitive = lights.lights[light].primitive as usize;
            let above = |vertex: u32| normal.dot(Vec3::from(lights.positions[vertex as usize]) - position) > 1e-3;
            let hidden = lights.triangles.get(primitive).is_some_and(|triangle| !triangle.iter().any(|&v| above(v)));
            if weight < 1e-3 || hidden {
                continue;
            }
            lit += 1;
            for node in way(&tree, light) {
                assert!(node.importance(position, normal) > 0.0, "light {light} at point {index}");
            }
        }
    }
    assert!(lit > 3000, "{lit}");
}

/// Over a plane below 32² equal point lights, the variance is that by power alone divided by a factor of at least 10.
#[test]
fn variance_is_below_that_by_power() {
    let grid = (0..1024).map(|i| ([(i % 32) as f32 / 32.0 - 0.5, 0.02, (i / 32) as f32 / 32.0 - 0.5], 1.0 / 1024.0));
    let lights = Lights::points(grid);
    let tree = LightTree::new(&lights.view());
    for index in 0..100 {
        let at = (Vec3 { y: 0.0, ..place(index).0 }, Vec3::Y);
        let values = lights.weights(at.0, at.1);
        let sum: f64 = values.iter().sum();
        let variance = |probability: &dyn Fn(usize) -> f64| {
            values.iter().enumerate().map(|(i, value)| value * value / probability(i)).sum::<f64>() - sum * sum
        };
        let by_power = variance(&|i| light_probability(&lights.starts, i));
        let by_tree = variance(&|i| tree.probability(&lights.starts, at.0, at.1, i));
        assert!(by_tree < by_power / 10.0, "{by_tree} against {by_power}");
    }
}

/// 10⁵ lights, of powers from 1 to 10²⁰, a third of them in one place, a third at distances that halve.
#[test]
fn extreme_lights_end_and_stay_unbiased() {
    let light = |index: u32| {
        let [a, b, c, d] = philox4x32([index, 0, 3, 0], [7, 0]).map(unit_f32);
        let position = match index % 3 {
            0 => [0.25, 0.25, 0.25],
            1 => [0.4 * 0.5_f32.powi((index % 60) as i32), 0.1, 0.0],
            _ => [a - 0.5, 0.5 * b + 0.01, c - 0.5],
        };
        (position, 1e-20_f32.powf(d) / 1e5)
    };
    let lights = Lights::points((0..100_000).map(light));
    let tree = LightTree::new(&lights.view());
    let depth = (0..lights.lights.len()).map(|light| way(&tree, light).len()).max().unwrap();
    assert!((6..=MAX_DEPTH as usize).contains(&depth), "{depth}");
    let at = (Vec3::new(0.1, 0.0, 0.1), Vec3::Y);
    let sum: f64 = probabilities(&tree, &lights, at).iter().sum();
    assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    for index in 0..4 {
        assert_unbiased(&lights, &tree, (Vec3 { y: -0.1, ..place(index).0 }, Vec3::Y), 20_000);
    }
}

/// 20 point lights in each of 120 places at distances that halve: more levels than are split unevenly.
#[test]
fn deep_trees_are_halved() {
    let place = |index: u32| ([0.5_f32.powi((index / 20) as i32), 0.1, 0.0], 1.0 / 2400.0);
    let lights = Lights::points((0..2400).map(place));
    let tree = LightTree::new(&lights.view());
    let depth = (0..lights.lights.len()).map(|light| way(&tree, light).len()).max().unwrap();
    assert!((11..=MAX_DEPTH as usize).contains(&depth), "{depth}");
    assert_unbiased(&lights, &tree, (Vec3::new(0.1, 0.0, 0.1), Vec3::Y), 20_000);
}

/// Few lights, only lights at infinity, lights of both kinds, and lights without power: every choice has all random words, and
/// several picks at once are those of one after the other.
#[test]
fn small_trees_choose_as_large_ones_do() {
    let mixed = Lights::mixed();
    let of = |places: &[usize], power: f32| {
        let mut some =
            Lights { lights: places.iter().map(|&place| mixed.lights[place]).collect(), ..Lights::default() };
        some.lights.iter_mut().for_each(|light| light.power = light.power.map(|part| part * power));
        some.with_shares()
    };
    // Points from 40 on, spots from 80 on, directional lights from 120 on.
    for (places, power) in [
        (&[40, 41][..], 1.0),
        (&[40, 120], 1.0),
        (&[120, 121], 1.0),
        (&[120, 121, 122, 40, 81, 82, 83, 84, 85, 86, 87, 88], 1.0),
        (&[40, 41, 42], 0.0),
        (&[40, 41, 120], 0.0),
    ] {
        let lights = of(places, power);
        let tree = LightTree::new(&lights.view());
        for index in 0..50 {
            let (position, normal) = place(index);
            for nodes in tree.nodes() {
                let words = nodes.words(position, normal);
                assert_eq!(words.iter().map(|&part| u64::from(part)).sum::<u64>(), 1 << 32, "{places:?}");
                assert!((0..WIDTH).all(|child| (words[child] == 0) == (nodes.next[child] == NO_CHILD)), "{words:?}");
            }
            let words: [[u32; 2]; 3] = std::array::from_fn(|pick| {
                let [random, low, ..] = philox4x32([index, pick as u32, 4, 0], [7, 0]);
                [random, low]
            });
            let each = words.map(|words| tree.pick(&lights.starts, position, normal, words));
            assert_eq!(tree.pick_several(&lights.starts, position, normal, words), each);
            assert_eq!(tree.pick_several(&lights.starts, position, normal, [words[0], words[1]]), [each[0], each[1]]);
            for (light, probability) in each {
                assert_eq!(tree.probability(&lights.starts, position, normal, light), probability);
            }
        }
    }
}

#[test]
#[should_panic(expected = "from 2")]
fn one_light_has_no_tree() {
    let _ = LightTree::new(&Lights::points([([0.0; 3], 1.0)].into_iter()).view());
}

/// A lit point in the middle of coincident lights, and one that no light reaches, are picked with finite probabilities.
#[test]
fn degenerate_points_are_finite() {
    let lights = Lights::points((0..40).map(|index| ([0.1, 0.2, 0.3], 1e-38 * (1.0 + index as f32))));
    let tree = LightTree::new(&lights.view());
    assert_eq!(tree, LightTree::new(&lights.view()));
    for at in [(Vec3::new(0.1, 0.2, 0.3), Vec3::Y), (Vec3::new(0.1, 0.5, 0.3), Vec3::Y)] {
        let probabilities = probabilities(&tree, &lights, at);
        assert!(probabilities.iter().all(|&p| p > 0.0 && p < 1.0), "{probabilities:?}");
        assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

/// Extended words fill their range evenly: the part below the threshold and the part above it.
#[test]
fn words_are_extended_over_their_range() {
    for divisor in [1, 2, 3, 65_535, 65_536, 65_537, TREE_WORDS, u32::MAX] {
        assert_eq!(extend_word(0, 0, divisor), 0);
        assert_eq!(extend_word(divisor - 1, u32::MAX, divisor), u32::MAX);
        // The middle of the range of words below the divisor and their extensions.
        let middle = u64::from(divisor) << 31;
        assert_eq!(extend_word((middle >> 32) as u32, middle as u32, divisor), 1 << 31);
    }
    assert!((f64::from(TREE_WORDS) / WORDS - 0.9).abs() < 1e-9);
}
