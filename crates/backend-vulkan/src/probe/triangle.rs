//! The ray-triangle test compared with photon-scene's.

use photon_core::glam::{DVec3, Vec3};
use photon_core::{Ray, RayCaster};
use photon_scene::BruteForce;

use super::compare::{Bound, Denormals, worst};
use super::draw::{Draw, input, inputs};
use super::table::{Row, output};
use super::{Input, Output, run};
use crate::{Vulkan, shaders};

/// The function, its twin and its bound.
pub(super) fn row() -> Row {
    Row {
        name: "test_triangle",
        module: &shaders::PROBE_TRIANGLE,
        function: 0,
        bound: Bound::Conditioned(1e-6, "its condition", condition),
        draw: ray,
        twin: brute_force,
    }
}

/// A triangle for each input: general, axis-aligned and thin ones.
fn corners(slot: u32) -> [Vec3; 3] {
    let mut d = Draw::of(slot, 1);
    let [a, mut b, mut c] = [d.point(), d.point(), d.point()];
    match d.word() % 4 {
        0 => (b.z, c.z) = (a.z, a.z),
        1 => c = a + (b - a) * d.between(0.0, 1.0) + (c - a) * 1e-3,
        _ => {}
    }
    [a, b, c]
}

/// A ray towards the triangle or past it; targets include its corners and edges, directions include axes.
fn ray(d: &mut Draw) -> Input {
    let slot = d.index();
    let [a, b, c] = corners(slot);
    let weights = [0.0, 1.0, 0.5, 1.0 / 3.0];
    let (u, v) = if d.now_and_then() {
        (d.pick(&weights), d.pick(&weights))
    } else {
        (d.between(-0.3, 1.3), d.between(-0.3, 1.3))
    };
    let towards = a * (1.0 - u - v) + b * u + c * v;
    let axis = d.pick(&[Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z]);
    let origin = if d.now_and_then() { towards - axis * 0.5 } else { d.point() };
    let direction = (towards - origin).normalize_or(axis);
    let farthest = d.pick(&[f32::MAX, f32::MAX, 0.25]);
    let mut input = input(origin.extend(farthest).to_array(), direction.extend(0.0).to_array(), [0.0; 4]);
    input.0[8] = slot;
    input
}

fn brute_force(input: &Input) -> Output {
    let positions = corners(input.0[8]).map(|corner| corner.to_array());
    let ray = Ray { origin: input.vector(0), direction: input.vector(4), t_max: input.float(3) };
    let caster = BruteForce::build(&positions, &[[0, 1, 2]]).unwrap();
    caster.nearest(&ray).map_or([0; 8], |hit| output([hit.t, hit.u, hit.v, 1.0]))
}

/// Condition number: the amplification of rounding errors, which is larger the more edge-on and the thinner the
/// triangle is. Infinite where rounding decides whether there is a hit.
fn condition(input: &Input) -> f64 {
    let [a, b, c] = corners(input.0[8]).map(|corner| corner.as_dvec3());
    let (origin, direction) = (input.vector(0).as_dvec3(), input.vector(4).as_dvec3());
    let normal = (b - a).cross(c - a);
    let facing = normal.dot(direction);
    let longest = (b - a).length().max((c - a).length()).max((c - b).length());
    let condition = (1.0 + longest) / facing.abs();
    let t = normal.dot(a - origin) / facing;
    let point = origin + direction * t;
    let weight = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
    let margins = [weight(a, b), weight(b, c), weight(c, a), t, t - f64::from(input.float(3))];
    if margins.iter().all(|margin| margin.abs() > 1e-6 * condition) { condition } else { f64::INFINITY }
}

#[test]
fn one_triangle_is_met_where_rust_meets_it() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let row = row();
    let mut inputs = inputs(row.draw);
    let mut table = Vec::with_capacity(inputs.len() * 12);
    for input in &inputs {
        table.extend(corners(input.0[8]).iter().flat_map(|corner| corner.extend(0.0).to_array()));
    }
    let triangles = on.memory("corners", table.len() as u64 * 4).unwrap();
    on.write(&triangles, 0, bytemuck::cast_slice(&table)).unwrap();
    // The test reads only the second address of a scene.
    let scene = on.memory("scene", 128).unwrap();
    on.fill_words(&scene, 0, 128, 0).unwrap();
    on.write(&scene, 8, bytemuck::bytes_of(&triangles.address())).unwrap();
    let address = scene.address();
    for input in &mut inputs {
        input.0[10..].copy_from_slice(&[address as u32, (address >> 32) as u32]);
    }
    let outputs = run(&mut on, row.module, row.function, &inputs).unwrap();
    let denormals = Denormals::of(&mut on).unwrap();
    let share = worst(&row, &inputs, &outputs, denormals).unwrap();
    let hits = outputs.iter().filter(|output| output[3] != 0).count();
    let decided = inputs.iter().filter(|input| condition(input).is_finite()).count();
    eprintln!("{:<24} {share:>9.3e} of {}; {hits} hits, {decided} decided", row.name, row.bound);
    // The table is meaningful: there are hits and misses, and few of them depend on rounding.
    assert!(hits > inputs.len() / 8 && hits < inputs.len() * 3 / 4 && decided > inputs.len() / 2);

    // The comparison can fail: swapped weights are detected.
    let swapped: Vec<Output> = outputs.iter().map(|&[t, u, v, hit, ..]| [t, v, u, hit, 0, 0, 0, 0]).collect();
    assert!(worst(&row, &inputs, &swapped, denormals).is_err());
}
