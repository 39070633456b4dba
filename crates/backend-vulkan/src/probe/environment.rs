//! Environment maps compared with photon-core's.

use std::sync::LazyLock;

use photon_core::glam::{Quat, Vec3};
use photon_core::math::turns_of;
use photon_core::random::SplitMix64;
use photon_core::{EnvironmentMap, Requirements, Settings};
use photon_scene::{MaterialDesc, Scene, SceneBuilder};

use super::compare::Bound;
use super::draw::{Draw, LAST, input, inputs};
use super::table::{Row, four, output};
use super::{Input, Output, run, worst_of};
use crate::scene::VulkanScene;
use crate::{Vulkan, shaders};

/// Scenes with a small map, with one that is rotated, and with one whose cells span several texels.
static SCENES: LazyLock<[Scene; 3]> = LazyLock::new(|| {
    [(7, 5, 0.0), (9, 4, 0.3), (4100, 2, 0.77)].map(|(width, height, rotation)| {
        let mut numbers = SplitMix64(width as u64);
        let texels: Vec<[f32; 3]> = (0..width * height)
            .map(|_| std::array::from_fn(|_| 0.05 + (numbers.word() % 1000) as f32 * 0.01))
            .collect();
        let mut scene = SceneBuilder::new();
        let floor = scene.material(MaterialDesc::lambert("floor", [0.5; 3]));
        scene.quad("floor", [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0]], floor);
        scene.environment(EnvironmentMap::new(width, &texels, rotation).unwrap());
        scene.build().unwrap()
    })
});

/// The brightest texel of each map, times the sum of its width and height.
static SLOPES: LazyLock<[f64; 3]> = LazyLock::new(|| {
    SCENES.each_ref().map(|scene| {
        let map = scene.view().environment.unwrap();
        let brightest = map.texels().iter().flatten().fold(0.0_f32, |a, &b| a.max(b));
        f64::from(brightest) * f64::from(map.width() + map.height())
    })
});

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_ENVIRONMENT;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row("environment_bilinear", 0, Bound::Bits, coordinates, |i| {
            output(map(i).bilinear(i.float(0), i.float(1)).to_array())
        }),
        // Two angles, each off by a division of at most an eighth of a turn, one of them by a square root too.
        row("environment_radiance", 1, Bound::Conditioned(2e-7, "its condition", slope), direction, |i| {
            output(map(i).radiance(i.vector(0)).to_array())
        }),
        // A division.
        row("environment_interval", 2, Bound::Relative(4e-7), random, intervals),
        // 2π times an error in the angle of two divisions.
        row(
            "environment_sample, direction",
            3,
            Bound::Conditioned(4e-6, "its condition", near_the_pole),
            random,
            |i| output(map(i).sample([i.0[4], i.0[5]]).direction.to_array()),
        ),
        row("environment_sample, weight", 4, Bound::Conditioned(6e-7, "its condition", slope_of_weight), random, |i| {
            output(map(i).sample([i.0[4], i.0[5]]).weight.to_array())
        }),
        // Two divisions.
        row("environment_sample, pdf", 5, Bound::Relative(7e-7), random, |i| {
            output([map(i).sample([i.0[4], i.0[5]]).pdf])
        }),
        row("environment_pdf", 6, Bound::Conditioned(7e-7, "its condition", beside_edges), direction, |i| {
            output([map(i).pdf(i.vector(0))])
        }),
    ]
}

/// The map of an input.
pub(super) fn map(i: &Input) -> &'static EnvironmentMap {
    SCENES[i.0[9] as usize].view().environment.unwrap()
}

fn of_map(d: &mut Draw, mut made: Input) -> Input {
    made.0[9] = d.word() % SCENES.len() as u32;
    made
}

/// Coordinates, among them edges and centres of texels, their neighbours, 0 and 1.
fn coordinates(d: &mut Draw) -> Input {
    let made = of_map(d, Input::default());
    let sizes = [map(&made).width(), map(&made).height()];
    let mut at = |size: u32| {
        let edge = (0.5 * (d.word() % (2 * size + 1)) as f32) / size as f32;
        let beside = d.pick(&[edge, (edge - LAST).max(0.0), (edge + LAST).min(1.0)]);
        let unit = d.unit();
        d.pick(&[beside, unit, 1.0, 1e-9]).to_bits()
    };
    let mut words = made.0;
    (words[0], words[1]) = (at(sizes[0]), at(sizes[1]));
    Input(words)
}

fn direction(d: &mut Draw) -> Input {
    let made = input(four(d.direction()), [0.0; 4], [0.0; 4]);
    of_map(d, made)
}

/// Random words, among them 0, 1, the largest, and the first words of cells and those before.
fn random(d: &mut Draw) -> Input {
    let mut made = of_map(d, Input::default());
    let map = map(&made);
    for (word, starts) in made.0[4..6].iter_mut().zip([map.row_starts(), map.column_starts()]) {
        let start = d.pick(starts);
        *word = if d.now_and_then() { d.pick(&[0, 1, u32::MAX, start, start.wrapping_sub(1)]) } else { d.word() };
    }
    made
}

/// The intervals of a row and of a cell in it.
fn intervals(i: &Input) -> Output {
    let (row, within, probability) = EnvironmentMap::interval(map(i).row_starts(), map(i).row_guide(), i.0[4]);
    let columns = map(i).columns() as usize;
    let cells = row * columns..(row + 1) * columns;
    let (starts, guide) = (&map(i).column_starts()[cells.clone()], &map(i).column_guides()[cells]);
    let (column, within_column, probability_of_column) = EnvironmentMap::interval(starts, guide, i.0[5]);
    output([row as f32, within, probability, 0.0, column as f32, within_column, probability_of_column, 0.0])
}

/// The change of the radiance for a change of both coordinates, at most.
fn slope(i: &Input) -> f64 {
    SLOPES[i.0[9] as usize]
}

/// Condition number of a sampled direction: the height in the cell is a quotient near 1 at the lower pole, and the sine
/// is the square root of what is left.
fn near_the_pole(i: &Input) -> f64 {
    let words = [i.0[4], i.0[5]];
    let (row, ..) = EnvironmentMap::interval(map(i).row_starts(), map(i).row_guide(), words[0]);
    let direction = map(i).sample(words).direction;
    let sine = f64::from(direction.x).hypot(f64::from(direction.z));
    if direction.y > 0.0 { 1.0 } else { 1.0 + f64::from(map(i).rows()[row].extent) / sine }
}

/// [`slope`] for the weight of a sample, which is the radiance times a factor.
fn slope_of_weight(i: &Input) -> f64 {
    let sample = map(i).sample([i.0[4], i.0[5]]);
    slope(i) * f64::from(sample.weight.x) / f64::from(map(i).radiance(sample.direction).x)
}

/// Condition number of a density: the density, which is one of a cell; infinite where rounding may move the direction
/// across the cell's edge. Coordinates are off by an angle's 7e-7 of at most one half, and a rotation.
fn beside_edges(i: &Input) -> f64 {
    let (map, v) = (map(i), i.vector(0));
    let from_centre = turns_of(v.x.abs(), -v.z).copysign(v.x);
    let across = (v.x * v.x + v.z * v.z).sqrt();
    let (u, height) = (0.5 + f64::from(from_centre + map.rotation()), 2.0 * f64::from(turns_of(across, v.y)));
    let near = |share: f64, size: u32, shift: f64| {
        let cells = (share * f64::from(size) + shift) / f64::from(map.step());
        (cells - cells.round()).abs() * f64::from(map.step()) < 1e-6 * f64::from(size)
    };
    // Columns start at the first texel's centre, and the last one reaches beyond the image's edge; rows at the upper pole.
    let edge = near(u - u.floor(), map.width(), -0.5) || near(height, map.height(), 0.5);
    if edge { f64::INFINITY } else { f64::from(map.pdf(v)) }
}

/// Inputs with the addresses of their maps' scenes, and what the device returns for them.
fn run_maps(on: &mut Vulkan, row: &Row, scenes: &[VulkanScene]) -> (Vec<Input>, Vec<Output>) {
    let mut inputs = inputs(row.draw);
    for input in &mut inputs {
        let address = scenes[input.0[9] as usize].address();
        input.0[10..].copy_from_slice(&[address as u32, (address >> 32) as u32]);
    }
    let outputs = run(on, row.module, row.function, &inputs).unwrap();
    (inputs, outputs)
}

#[test]
fn environment_maps_are_read_and_sampled_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let everything = Requirements::everything(&Settings::default());
    let scenes = SCENES.each_ref().map(|scene| VulkanScene::new(&mut on, &scene.view(), &everything).unwrap());
    assert!(SCENES[1].view().environment.unwrap().rotation() > 0.2);
    assert!(SCENES[2].view().environment.unwrap().step() > 1);
    let decided = inputs(direction).iter().filter(|input| beside_edges(input).is_finite()).count();
    assert!(decided > 15_000, "{decided}");
    for mut row in rows() {
        let (inputs, outputs) = run_maps(&mut on, &row, &scenes);
        let share = worst_of(&mut on, &row, &inputs, &outputs).unwrap();
        eprintln!("{:<24} {share:>9.3e} of {}", row.name, row.bound);
        // A mirrored image, the image without its rotation, and exchanged words: all are detected.
        row.twin = match row.function {
            0 => |i| output(map(i).bilinear(1.0 - i.float(0), i.float(1)).to_array()),
            1 => |i| output(map(i).radiance(unrotated(i)).to_array()),
            2 => |i| intervals(&exchanged(i)),
            3 => |i| output(map(i).sample([i.0[5], i.0[4]]).direction.to_array()),
            4 => |i| output(map(i).sample([i.0[5], i.0[4]]).weight.to_array()),
            5 => |i| output([map(i).sample([i.0[5], i.0[4]]).pdf]),
            _ => |i| output([map(i).pdf(unrotated(i))]),
        };
        assert!(worst_of(&mut on, &row, &inputs, &outputs).is_err(), "{}", row.name);
    }
}

/// The direction that a map without its rotation has there.
fn unrotated(i: &Input) -> Vec3 {
    Quat::from_rotation_y(map(i).rotation() * std::f32::consts::TAU) * i.vector(0)
}

fn exchanged(i: &Input) -> Input {
    let mut words = i.0;
    words.swap(4, 5);
    Input(words)
}
