//! The selection of lights compared with photon-core's, which sums and divides in f64.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::light_sampler::{LightSampler, light_of_triangle, weigh};
use photon_core::{Light, LightGroups, SceneView, light_cdf};

use super::compare::Bound;
use super::draw::{Draw, inputs};
use super::scene::SCENE;
use super::table::{Row, Twin, output, words};
use super::{Input, Output, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// The lights of the scene, and a sun with a disc of 26 degrees.
static LIGHTS: LazyLock<(Vec<Light>, Vec<u32>)> = LazyLock::new(|| {
    let mut lights = SCENE.view().lights.to_vec();
    let parallel = *lights.last().unwrap();
    assert_eq!(parallel.kind, Light::DIRECTIONAL);
    lights.push(Light { direction: [0.6, -0.8, 0.0], versine_outer: 0.1, ..parallel });
    let powers: Vec<f64> = lights.iter().map(|light| light.power.iter().copied().map(f64::from).sum()).collect();
    let starts = light_cdf(&powers);
    (lights, starts)
});

fn view() -> SceneView<'static> {
    let (lights, light_cdf) = &*LIGHTS;
    SceneView { lights, light_cdf, ..SCENE.view() }
}

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let row = |name, function, condition, twin| Row {
        name,
        module: &shaders::PROBE_LIGHT_SAMPLER,
        function,
        bound: Bound::Conditioned(8e-6, "its condition", condition),
        draw: point,
        twin,
    };
    vec![
        row("weigh", 0, |i| condition_of_weight(i, i.0[3]), |i| output([weight(place(i), i.0[3])])),
        row("light_sampler_at", 1, condition, cumulative),
        row("light_sampler_pick", 2, condition_of_pick, picked),
        row("light_sampler_probability", 3, |i| 2.0 * condition(i), probability),
        row("light_sampler_for_rays", 5, condition_of_groups, |i| cumulative_sums(&for_rays(i))),
        Row { bound: Bound::Words, draw: triangle, ..row("light_of_triangle", 4, |_| 0.0, |i| words([light(i.0[8])])) },
    ]
}

/// A point with a normal, a light, a random word, and the number of lights to be weighted: all or none.
fn point(d: &mut Draw) -> Input {
    let lights = view().lights.len() as u32;
    let (position, normal) = (d.point(), d.direction());
    let mut input = Input::default();
    for axis in 0..3 {
        (input.0[axis], input.0[4 + axis]) = (position[axis].to_bits(), normal[axis].to_bits());
    }
    input.0[3] = d.word() % lights;
    input.0[7] = LightGroups::new(&view()).starts() << 8 | d.pick(&[1, 2, 3, 4, 6, 16]);
    input.0[8] = if d.now_and_then() { d.pick(&[0, 1, u32::MAX]) } else { d.word() };
    input.0[9] = if d.word().is_multiple_of(8) { 0 } else { lights };
    input
}

/// Triangles around those that emit, and any others.
fn triangle(d: &mut Draw) -> Input {
    let near = view().lights.iter().map(|light| light.primitive).filter(|&primitive| primitive != u32::MAX);
    let near: Vec<u32> = near.flat_map(|primitive| [primitive - 1, primitive, primitive + 1]).collect();
    let mut input = Input::default();
    input.0[8] = if d.now_and_then() { d.pick(&[0, u32::MAX, d.index()]) } else { d.pick(&near) };
    input
}

/// Position and normal.
type Place = (Vec3, Vec3);

fn place(i: &Input) -> Place {
    (i.vector(0), i.vector(4))
}

fn weight((position, normal): Place, index: u32) -> f32 {
    let view = view();
    let light = &view.lights[index as usize];
    let triangle = || {
        let primitive = light.primitive as usize;
        let corners = view.triangles[primitive].map(|vertex| Vec3::from(view.positions[vertex as usize]));
        (corners, view.primitives[primitive].normal.into())
    };
    weigh(light, triangle, position, normal)
}

fn sampler(i: &Input) -> LightSampler {
    LightSampler::new(i.0[9] as usize, |index| weight(place(i), index as u32))
}

/// For as many rays, with those groups of lights, as `i.0[7]` has.
fn for_rays(i: &Input) -> LightSampler {
    let groups = LightGroups::from_starts(i.0[7] >> 8);
    LightSampler::for_rays(i.0[9] as usize, groups, i.0[7] & 255, |index| weight(place(i), index as u32))
}

fn cumulative(i: &Input) -> Output {
    cumulative_sums(&sampler(i))
}

fn cumulative_sums(sampler: &LightSampler) -> Output {
    output::<8>(std::array::from_fn(|index| sampler.cdf().get(index).map_or(0.0, |&sum| sum as f32)))
}

fn picked(i: &Input) -> Output {
    let (index, share) = sampler(i).pick(view().light_cdf, i.0[8]);
    output([index as f32, share as f32])
}

/// Of light `i.0[3]`, and the sum over all lights.
fn probability(i: &Input) -> Output {
    let (sampler, view) = (sampler(i), view());
    let of = |index| sampler.probability(view.light_cdf, index) as f32;
    output([of(i.0[3] as usize), (0..view.lights.len()).map(of).sum()])
}

/// The light of a triangle; `u32::MAX` if it is none.
fn light(triangle: u32) -> u32 {
    light_of_triangle(view().lights, triangle).map_or(u32::MAX, |index| index as u32)
}

/// Condition number of a weight: its change for a position or a normal changed by 1e-6, divided by 1e-6; at least the
/// weight.
fn condition_of_weight(i: &Input, index: u32) -> f64 {
    const CHANGE: f32 = 1e-6;
    let (position, normal) = place(i);
    let before = f64::from(weight((position, normal), index));
    let steps = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * CHANGE);
    let places = steps.into_iter().chain(steps.map(|step| -step));
    let moved = places.flat_map(|step| [(position + step, normal), (position, normal + step)]);
    let change = moved.map(|place| (f64::from(weight(place, index)) - before).abs()).fold(0.0, f64::max);
    before.abs().max(change / f64::from(CHANGE))
}

/// Condition number of cumulative probabilities: that of the weights, divided by their sum; infinite where rounding
/// may decide whether any weight is positive.
fn condition(i: &Input) -> f64 {
    let lights = 0..i.0[9];
    let total: f64 = lights.clone().map(|index| f64::from(weight(place(i), index))).sum();
    let all: f64 = lights.map(|index| condition_of_weight(i, index)).sum();
    match all / total {
        _ if i.0[9] == 0 => 1.0,
        relative if relative < 1e4 => 1.0 + relative,
        _ => f64::INFINITY,
    }
}

/// The same with groups of lights, whose weights are divided by the sum of the group or of those without a ray; infinite where
/// rounding may decide whether a group has a weight, or a ray.
fn condition_of_groups(i: &Input) -> f64 {
    let (lights, groups) = (i.0[9] as usize, LightGroups::from_starts(i.0[7] >> 8));
    let weight_of = |index: usize| f64::from(weight(place(i), index as u32));
    let condition_of = |index: usize| condition_of_weight(i, index as u32);
    let mut of_groups: Vec<[f64; 2]> = groups
        .of(lights)
        .map(|[first, end]| [(first..end).map(weight_of).sum(), (first..end).map(condition_of).sum()])
        .collect();
    let relative = |[sum, condition]: [f64; 2]| if condition > 0.0 { condition / sum } else { 0.0 };
    let mut all = condition(i) + of_groups.iter().copied().map(relative).sum::<f64>();
    // The strongest first: each is compared with the mean over the rays that are left.
    of_groups.sort_by(|a, b| b[0].total_cmp(&a[0]));
    let (mut rest, mut rays) =
        (of_groups.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]), f64::from(i.0[7] & 255));
    for [sum, condition] in of_groups {
        let is_tied = (sum * rays / rest[0] - 1.0).abs() < 1e-4;
        all += if is_tied { f64::INFINITY } else { relative(rest) };
        rest = [rest[0] - sum, rest[1] - condition];
        rays -= 1.0;
        if rays < 1.0 {
            break;
        }
    }
    if all < 1e4 { all } else { f64::INFINITY }
}

/// The same for the light that is picked and its probability; infinite where rounding may decide which one it is.
fn condition_of_pick(i: &Input) -> f64 {
    let condition = condition(i);
    let at = f64::from(i.0[8]) / 4_294_967_296.0;
    let near = |&end: &f64| (end - at).abs() < 2.0 * 8e-6 * condition;
    if sampler(i).cdf().iter().any(near) { f64::INFINITY } else { 2.0 * condition }
}

/// The input without weights, so that lights are chosen by power alone.
fn by_power(i: &Input) -> Input {
    let mut words = i.0;
    words[9] = 0;
    Input(words)
}

#[test]
fn lights_are_selected_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &view());
    let address = words_of(scene.address());
    // The table is meaningful: few inputs are undecided.
    for (condition, least) in [(condition_of_pick as fn(&Input) -> f64, 15_000), (condition_of_groups, 14_000)] {
        let decided = inputs(point).iter().filter(|input| condition(input).is_finite()).count();
        assert!(decided > least, "{decided}");
    }
    for row in rows() {
        // The weight without the cosine, and probabilities by power alone: both are detected.
        let wrong: Twin = match row.function {
            0 => |i| output([weight((i.vector(0), -i.vector(4)), i.0[3])]),
            1 => |i| cumulative(&by_power(i)),
            3 => |i| probability(&by_power(i)),
            4 => |i| words([light(i.0[8]) ^ 1]),
            5 => cumulative,
            _ => |i| picked(&by_power(i)),
        };
        assert_twin(&mut on, &row, &address, wrong);
    }
}
