//! V2, V3: whole glossy surfaces and rough glass near the peaks of their narrowest reflections, compared with photon-core's.
//!
//! Both sides find the microfacet normal again from two directions, so that bounds grow with the reciprocal of the width.

use photon_core::glam::{DVec3, Vec3};
use photon_core::sampling;

use super::compare::Bound;
use super::draw::{Draw, input};
use super::glossy::{self, NORMAL};
use super::narrow::STEP;
use super::table::{Row, Twin};
use super::{Input, assert_twin, rough_glass, run_row, words_of};
use crate::{Vulkan, shaders};

/// Errors of a direction in the frame of the surface and of a sum of two, in steps, with those of a square root and a
/// division.
const STEPS: f64 = 24.0;

/// Squares of roughnesses from the least width on; slightly above it, so that rough glass is rough.
const WIDTHS: [f32; 4] = [1.001e-3, 3e-3, 0.01, 0.1];
const COSINES: [f32; 6] = [1e-4, 1e-3, 0.02, 0.3, 0.9, 1.0];

/// What is allowed where rounding is not amplified: ten times the bound of the probes at wider lobes. Chosen, not derived.
const ALONE: f64 = 1e-3;

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let (gloss, glass) = (&shaders::PROBE_GLOSSY, &shaders::PROBE_ROUGH_GLASS);
    let row = |name, module, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row("glossy_evaluate, narrow", gloss, 4, Bound::Scaled(ALONE, CONDITION, of_reflection), reflected, |i| {
            glossy::evaluated(i, &glossy::layers(i), i.vector(0), i.vector(4))
        }),
        row("rough_glass_evaluate, narrow", glass, 1, Bound::Scaled(ALONE, CONDITION, of_glass), refracted, |i| {
            rough_glass::evaluated(i, i.vector(0), i.vector(4))
        }),
        row("rough_glass_sample, narrow", glass, 2, Bound::Conditioned(ALONE, CONDITION, of_sample), refracted, |i| {
            rough_glass::sampled(i, i.float(8))
        }),
    ]
}

const CONDITION: &str = "its condition";

fn world(local: DVec3) -> DVec3 {
    let (tangent, bitangent) = sampling::basis(NORMAL);
    (tangent.as_dvec3() * local.x + bitangent.as_dvec3() * local.y + NORMAL.as_dvec3() * local.z).normalize_or_zero()
}

/// A roughness, a direction, and a microfacet normal up to three widths from that of the surface, both in its frame.
fn meeting(d: &mut Draw) -> (f32, DVec3, DVec3) {
    let width = d.pick(&WIDTHS);
    let about = |versine: f32, turns: f32| sampling::about(Vec3::Z, versine, turns).as_dvec3().normalize_or_zero();
    let tangent = f64::from(width * d.pick(&[0.0, 0.3, 1.0, 3.0]));
    let (sin, cos) = (f64::from(d.unit()) * std::f64::consts::TAU).sin_cos();
    let h = DVec3::new(tangent * cos, tangent * sin, 1.0).normalize_or_zero();
    (width.sqrt(), about(1.0 - d.pick(&COSINES), d.unit()), h)
}

fn reflected(d: &mut Draw) -> Input {
    let (roughness, o, h) = meeting(d);
    let i = h * (2.0 * o.dot(h)) - o;
    let metallic = d.pick(&[0.0, 1.0, 0.3]);
    let [a, b] = [o, i].map(|local| world(local).as_vec3());
    input(a.extend(roughness).to_array(), b.extend(metallic).to_array(), [d.unit(), d.unit(), 0.0, 0.0])
}

/// Both directions of one event at a boundary of the index 1.5, or at a sheet.
fn refracted(d: &mut Draw) -> Input {
    let (roughness, o, h) = meeting(d);
    let kind = d.pick(&[0.0_f32, 1.0, 2.0]);
    let (mirrored, across) = (h * (2.0 * o.dot(h)) - o, o.dot(h));
    let eta = f64::from(if kind == 0.0 { 1.5_f32 } else { 1.0 / 1.5_f32 });
    let beyond = 1.0 - (1.0 - across * across) / (eta * eta);
    let i = if d.word().is_multiple_of(16) {
        // V4: straight on.
        -o
    } else if d.now_and_then() || (kind < 2.0 && beyond < 0.0) {
        mirrored
    } else if kind == 2.0 {
        DVec3::new(mirrored.x, mirrored.y, -mirrored.z)
    } else {
        h * (across / eta - beyond.sqrt()) - o / eta
    };
    let [a, b] = [o, i].map(|local| world(local).as_vec3());
    let kind = kind + d.between(0.0, 0.999);
    input(a.extend(roughness).to_array(), b.extend(kind).to_array(), [d.unit(), d.unit(), 0.0, 0.0])
}

/// How much errors of both directions change a value, relatively: D by at most 2 δ/α, where δ is that of the microfacet
/// normal; and the visibility by those of the cosines.
fn errors(i: &Input, wi: DVec3, sum: DVec3) -> f64 {
    let alpha = f64::from(i.float(3) * i.float(3));
    let normal = NORMAL.as_dvec3();
    let cosines = [i.vector(0).as_dvec3(), wi].map(|w| w.dot(normal).abs().max(1e-9));
    STEPS * STEP * (2.0 / (alpha * sum.length().max(1e-9)) + 1.0 / cosines[0] + 1.0 / cosines[1])
}

fn of_reflection(i: &Input) -> f64 {
    let wi = i.vector(4).as_dvec3();
    1.0 + errors(i, wi, i.vector(0).as_dvec3() + wi) / ALONE
}

/// Where light leaves glass near the critical angle, the refracted cosine is the root of a difference.
fn of_glass(i: &Input) -> f64 {
    of_glass_towards(i, i.vector(4))
}

/// The condition of a sample, whose weight may be far above 1 where a direction at a grazing angle stands for what single
/// scattering loses. If the direction is sampled evenly, it is that of the evaluation and that of the loss, which is 1 minus what
/// three interpolations of a table give; else that of its cosine, the difference of two numbers with the errors of
/// the visible normal.
fn of_sample(i: &Input) -> f64 {
    let (direction, weight, is_lost) = rough_glass::drawn(i);
    let weight = f64::from(weight.max(1.0));
    if is_lost {
        // One rounding for each interpolation, and one for the difference.
        let of_loss = 4.0 * STEP / rough_glass::lost_from(i, direction).max(STEP);
        return 1.0 + (of_glass_towards(i, direction) - 1.0 + of_loss / ALONE) * weight;
    }
    let cancellation = rough_glass::cancellation(i);
    // The reciprocal of the length of the sum that gives the normal, and of the sine.
    let magnified = (cancellation - 1.0) / rough_glass::MAGNIFIED;
    let cosine = f64::from(direction.dot(NORMAL)).abs().max(1e-9);
    cancellation + weight * STEPS * STEP * magnified / cosine / ALONE
}

fn of_glass_towards(i: &Input, wi: Vec3) -> f64 {
    let (o, wi) = (i.vector(0).as_dvec3(), wi.as_dvec3());
    let kind = i.float(7).floor();
    let stays = wi.dot(NORMAL.as_dvec3()) >= 0.0;
    let eta = if kind == 0.0 { 1.5 } else { 1.0 / 1.5 };
    let sum = if stays {
        o + wi
    } else if kind == 2.0 {
        o + wi - NORMAL.as_dvec3() * (2.0 * wi.dot(NORMAL.as_dvec3()))
    } else {
        o + wi * eta
    };
    let across = o.dot(sum.normalize_or_zero());
    let steepness = if kind == 1.0 { STEPS * STEP / (eta * eta - 1.0 + across * across).abs() } else { 0.0 };
    1.0 + (errors(i, wi, sum) + steepness) / ALONE
}

#[test]
fn narrow_lobes_are_those_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let (plate, block) = (glossy::scene(&mut on), rough_glass::scene(&mut on));
    for row in rows() {
        let is_gloss = row.function == 4;
        let wrong: Twin = match row.function {
            4 => |i| glossy::evaluated(i, &glossy::layers(i), i.vector(4), i.vector(0)),
            1 => |i| rough_glass::evaluated(i, i.vector(4), i.vector(0)),
            _ => |i| rough_glass::sampled(i, i.float(8) * 0.99),
        };
        assert_twin(&mut on, &row, &words_of(if is_gloss { plate.address() } else { block.address() }), wrong);
    }
}

/// V3: weights of sampled directions are at least 0 and finite, also where cosines are 10⁻⁴, and directions are unit vectors.
/// Those of gloss may be above 1: what single scattering of a narrow width loses is mostly at grazing angles, and is sampled as
/// if it were even; the layers of a clearcoat share their samples.
#[test]
fn weights_of_narrow_samples_are_bounded() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let (plate, block) = (glossy::scene(&mut on), rough_glass::scene(&mut on));
    let sample = rows().remove(2);
    let gloss = Row { module: &shaders::PROBE_GLOSSY, function: 5, draw: reflected, ..sample };
    for (row, address) in [(gloss, plate.address()), (sample, block.address())] {
        let (inputs, outputs) = run_row(&mut on, &row, &words_of(address));
        let mut black = 0;
        for (input, output) in inputs.iter().zip(&outputs) {
            let [x, y, z, _, weight @ ..] = output.map(f32::from_bits);
            let is_bounded = weight[..3].iter().all(|weight| (0.0..1e4).contains(weight));
            let length = Vec3::new(x, y, z).length();
            assert!(is_bounded && (length - 1.0).abs() < 1e-4, "{}: {input:x?} {weight:?} {length}", row.module.name);
            black += usize::from(weight[..3] == [0.0; 3]);
        }
        assert!(2 * black < outputs.len(), "{black}");
    }
}
