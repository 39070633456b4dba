//! Samples of a projection map compared with photon-core's.

use std::sync::LazyLock;

use photon_core::{ProjectionMap, ProjectionSample};

use super::compare::Bound;
use super::draw::Draw;
use super::scene::SCENE;
use super::table::{Row, Twin, output, words};
use super::{Input, assert_twin, words_of};
use crate::stages::emit::VulkanAimedEmitter;
use crate::{Vulkan, shaders};

static PROJECTION: LazyLock<ProjectionMap> = LazyLock::new(|| ProjectionMap::of(&SCENE.view()));

/// The function, its twin and its bound; once for words and once for floats.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_PROJECTION;
    vec![
        Row {
            name: "projection_sample",
            module,
            function: 0,
            bound: Bound::Words,
            draw: random,
            twin: |i| {
                let ProjectionSample { target, point, direction, side } = sample(i);
                let light = PROJECTION.targets()[target].light;
                words([light, side, point[0], point[1], direction[0], direction[1]])
            },
        },
        Row {
            name: "projection_sample, power",
            module,
            function: 1,
            bound: Bound::Bits,
            draw: random,
            twin: |i| output(PROJECTION.targets()[sample(i).target].carried),
        },
    ]
}

/// Random words, among them 0, 1, the largest, and the first words of targets and those before.
fn random(d: &mut Draw) -> Input {
    let starts = PROJECTION.starts();
    let mut input = Input::default();
    for word in &mut input.0[..8] {
        let start = d.pick(starts);
        *word = if d.now_and_then() { d.pick(&[0, 1, u32::MAX, start, start.wrapping_sub(1)]) } else { d.word() };
    }
    input
}

fn sample(i: &Input) -> ProjectionSample {
    let [a, b, c, d, e, f, g, h, ..] = i.0;
    PROJECTION.sample([a, b, c, d], [e, f, g, h])
}

#[test]
fn aimed_photons_are_sampled_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    // Lights of several kinds, of which some cells are marked and some are not.
    assert!(PROJECTION.targets().len() >= 6 && PROJECTION.share() < 0.9, "{}", PROJECTION.share());
    let emitter = VulkanAimedEmitter::new(&mut on, &PROJECTION).unwrap();
    let address = words_of(emitter.address());
    for row in rows() {
        // The next cell, the power of the first target: both are detected.
        let wrong: Twin = match row.function {
            0 => |i| {
                let ProjectionSample { target, point, direction, side } = sample(i);
                let light = PROJECTION.targets()[target].light;
                words([light, side, point[1], point[0], direction[0], direction[1]])
            },
            _ => |_| output(PROJECTION.targets()[0].carried),
        };
        assert_twin(&mut on, &row, &address, wrong);
    }
}
