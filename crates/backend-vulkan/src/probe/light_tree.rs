//! The light tree compared with photon-core's, which multiplies probabilities in f64.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::light_tree::{LightNode, LightTree, NO_CHILD, WIDTH, extend_word};
use photon_core::{EnvironmentMap, Features};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

use super::compare::Bound;
use super::draw::{Draw, inputs};
use super::light_tree_condition::{condition_of_importance, condition_of_pick, condition_of_probability};
use super::table::{Row, Twin, output, words};
use super::{Input, Output, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// 64 lights: 12 triangles, of which 6 emit from both sides, 25 point lights, 25 spotlights, a directional light and an
/// environment.
pub(super) static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = SceneBuilder::new();
    let floor = scene.material(MaterialDesc::lambert("floor", [0.5; 3]));
    scene.quad("floor", [[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]], floor);
    for index in 0..6_u32 {
        let both = index % 2 == 0;
        let emissive = MaterialDesc::emissive("area light", [0.0; 3], [3.0, 2.0, 1.0]).with_both_sides(both);
        let material = scene.material(emissive);
        let d = &mut Draw::of(index, 1);
        let (at, x, y) = (d.point(), d.direction() * 0.1, d.direction() * 0.1);
        let corners = [at, at + x, at + x + y, at + y].map(|corner| corner.as_dvec3().to_array());
        scene.quad("area light", corners, material);
    }
    for index in 0..25_u32 {
        let d = &mut Draw::of(index, 2);
        let (position, direction) = (d.point().as_dvec3().to_array(), d.direction().as_dvec3().to_array());
        let intensity = [f64::from(d.magnitude(-20, 0)); 3];
        scene.light("point", LightDesc::Point { position, intensity });
        let inner_angle = f64::from(d.between(0.0, 0.5));
        let outer_angle = inner_angle + f64::from(d.between(0.1, 0.9));
        scene.light("spot", LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle });
    }
    scene.light("sun", LightDesc::Directional { direction: [-0.3, -1.0, 0.2], irradiance: [0.5, 0.6, 0.7] });
    scene.environment(EnvironmentMap::new(4, &[[0.2; 3]; 8], 0.0).unwrap());
    scene.build().unwrap()
});

pub(super) static TREE: LazyLock<LightTree> = LazyLock::new(|| LightTree::new(&SCENE.view()));

/// The bound of an importance, times its condition. Two divisions and two roots change it by 1.7e-6 of itself, the
/// roundings of twenty products and sums by less than 1e-6, and four roots in angles by 1e-6 times its derivative.
pub(super) const ERROR: f64 = 4e-6;

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let row = |name, function, bound, twin| Row {
        name,
        module: &shaders::PROBE_LIGHT_TREE,
        function,
        bound,
        draw: if function == 0 { division } else { point },
        twin,
    };
    let conditioned = |condition| Bound::Conditioned(ERROR, "its condition", condition);
    vec![
        row("extend_word", 0, Bound::Words, |i| words([extend_word(i.0[0], i.0[1], i.0[2].max(1))])),
        row("light_node_importance", 1, conditioned(condition_of_importance), |i| output([importance(i, place(i))])),
        row("light_tree_pick", 2, conditioned(condition_of_pick), |i| picked(i, place(i))),
        row("light_tree_probability", 3, conditioned(condition_of_probability), |i| output([probability(i, place(i))])),
        row("light_tree_probability, sum", 4, Bound::Within(1e-5), |i| output([sum(i)])),
    ]
}

/// A numerator whose high word is below the divisor.
fn division(d: &mut Draw) -> Input {
    let edges = [1, 2, 3, 0xFFFF, 0x1_0000, 0x1_0001, 0x7FFF_FFFF, 0x8000_0000, u32::MAX - 1, u32::MAX];
    let divisor = if d.now_and_then() { d.pick(&edges) } else { (d.word() >> (d.word() % 32)).max(1) };
    let high = if d.now_and_then() { d.pick(&[0, divisor / 2, divisor - 1]) } else { d.word() % divisor };
    let low = if d.now_and_then() { d.pick(&[0, 0xFFFF, 0xFFFF_0000, u32::MAX]) } else { d.word() };
    let mut input = Input::default();
    input.0[..3].copy_from_slice(&[high, low, divisor]);
    input
}

/// A point with a normal, the indices of a light and of a node, and two random words.
fn point(d: &mut Draw) -> Input {
    let (position, normal) = (d.point(), d.direction());
    let mut input = Input::default();
    for axis in 0..3 {
        (input.0[axis], input.0[4 + axis]) = (position[axis].to_bits(), normal[axis].to_bits());
    }
    input.0[3] = d.word() % SCENE.view().lights.len() as u32;
    let exists = |&index: &usize| TREE.nodes()[index / WIDTH].next[index % WIDTH] != NO_CHILD;
    let nodes: Vec<usize> = (0..TREE.nodes().len() * WIDTH).filter(exists).collect();
    input.0[7] = nodes[d.word() as usize % nodes.len()] as u32;
    input.0[8] = if d.now_and_then() { d.pick(&[0, 1, u32::MAX]) } else { d.word() };
    input.0[9] = d.word();
    input
}

/// Position and normal.
pub(super) type Place = (Vec3, Vec3);

pub(super) fn place(i: &Input) -> Place {
    (i.vector(0), i.vector(4))
}

/// The node with the input's index.
pub(super) fn node(i: &Input) -> LightNode {
    let index = i.0[7] as usize;
    TREE.nodes()[index / WIDTH].node(index % WIDTH)
}

fn importance(i: &Input, (position, normal): Place) -> f32 {
    node(i).importance(position, normal)
}

fn probability(i: &Input, (position, normal): Place) -> f32 {
    TREE.probability(SCENE.view().light_cdf, position, normal, i.0[3] as usize) as f32
}

fn picked(i: &Input, (position, normal): Place) -> Output {
    let (index, share) = TREE.pick(SCENE.view().light_cdf, position, normal, [i.0[8], i.0[9]]);
    output([index as f32, share as f32])
}

fn sum(i: &Input) -> f32 {
    let mut input = *i;
    let of = |index: usize| {
        input.0[3] = index as u32;
        probability(&input, place(i))
    };
    (0..SCENE.view().lights.len()).map(of).sum()
}

#[test]
fn the_tree_is_descended_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let view = SCENE.view();
    assert_eq!(view.lights.len(), 64);
    assert!(Features::of(&view).contains(Features::LIGHT_TREE));
    let scene = whole_scene(&mut on, &view);
    let address = words_of(scene.address());
    // The table is meaningful: few inputs are undecided.
    for condition in [condition_of_importance, condition_of_probability, condition_of_pick] {
        let decided = inputs(point).iter().filter(|input| condition(input).is_finite()).count();
        assert!(decided > 19_500, "{decided}");
    }
    for row in rows() {
        let last: &[u32] = if row.function == 0 { &[] } else { &address };
        // Twins that round up, that see from the other side, or that leave the share by power out are detected.
        let wrong: Twin = match row.function {
            0 => |i| words([extend_word(i.0[0], i.0[1], i.0[2].max(1)).saturating_add(1)]),
            1 => |i| output([importance(i, (i.vector(0), -i.vector(4)))]),
            2 => |i| picked(i, (i.vector(0), -i.vector(4))),
            3 => |i| output([probability(i, (i.vector(0), -i.vector(4)))]),
            _ => |i| output([sum(i) * 0.9]),
        };
        assert_twin(&mut on, &row, last, wrong);
    }
}
