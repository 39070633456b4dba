//! Which photons count in which reflections: the functions of gloss_caustics.glsl.

use photon_core::glam::Vec3;
use photon_core::{Layers, Light, Material, gloss_caustics};

use super::Input;
use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, words};
use crate::shaders;

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_GLOSS_CAUSTICS;
    vec![
        Row {
            name: "gloss_caustics_narrowest",
            module,
            function: 0,
            bound: Bound::Words,
            draw: |d| {
                let mut often_zero = || if d.now_and_then() { 0.0 } else { d.unit() };
                let (clearcoat, sheen) = (often_zero(), often_zero());
                input([d.unit(), clearcoat, d.unit(), sheen], [d.unit(), 0.0, 0.0, 0.0], [0.0; 4])
            },
            twin: |i| {
                let material = Material { roughness: i.float(0), ..Material::default() };
                let layers = Layers::NONE
                    .with_clearcoat(i.float(1), i.float(2))
                    .with_sheen(Vec3::new(0.0, i.float(3), 0.0), i.float(4));
                words([gloss_caustics::narrowest(&material, &layers).to_bits()])
            },
        },
        Row {
            name: "gloss_caustics_with_mark, _counts",
            module,
            function: 1,
            bound: Bound::Words,
            draw: two_words,
            twin: |i| {
                let [a, b, ..] = i.0;
                words([gloss_caustics::with_mark(a, b & 1 != 0), u32::from(gloss_caustics::counts(a, b))])
            },
        },
        Row {
            name: "gloss_caustics_is_sampled_only",
            module,
            function: 2,
            bound: Bound::Words,
            draw: |d| {
                let mut input = Input::default();
                input.0[0] = d.word() % (Light::ENVIRONMENT + 2);
                input
            },
            twin: |i| {
                let light = Light { kind: i.0[0], ..Light::default() };
                words([u32::from(gloss_caustics::is_sampled_only(&light))])
            },
        },
    ]
}

fn two_words(d: &mut Draw) -> Input {
    let mut input = Input::default();
    (input.0[0], input.0[1]) = (d.word(), d.word());
    input
}
