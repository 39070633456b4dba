//! Alpha coverage compared with photon-core's.

use photon_core::{Hit, Shading, alpha, partial_transmission};

use super::compare::Bound;
use super::draw::{Draw, LAST, input};
use super::shade::barycentric;
use super::shaded_scene::{SHADED, TRIANGLES};
use super::table::{Row, Twin, output};
use super::texture::VALUES;
use super::{Input, Output, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_ALPHA;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row(
            "alpha_mix",
            0,
            Bound::Words,
            |d| Input([d.word(), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
            |i| word(alpha::mix(i.0[0])),
        ),
        row("alpha_keep", 1, Bound::Words, ray, |i| word(alpha::keep(i.float(0), i.0[1], i.0[2]).into())),
        row("alpha_coverage", 2, Bound::Bits, material, |i| output([alpha::coverage(i.float(0), i.float(1))])),
        row("alpha_coverage_of", 3, Bound::Bits, hit, |i| output([covered(i, [i.float(0), i.float(1)])])),
        row("partial_share", 4, Bound::Bits, shares, |i| {
            output([partial_transmission::share(i.float(0), i.float(1), i.float(2))])
        }),
        // A division.
        row("partial_opaque_metallic", 5, Bound::Relative(4e-7), shares, |i| {
            output([partial_transmission::opaque_metallic(i.float(0), i.float(1))])
        }),
        row("partial_share_at", 6, Bound::Bits, hit, |i| output([share(i, [i.float(0), i.float(1)])])),
        row("partial_material", 7, Bound::Words, met, |i| word(met_material(i, i.0[2]))),
    ]
}

fn word(value: u32) -> Output {
    let mut output = [0; 8];
    output[0] = value;
    output
}

/// A coverage, a triangle and a word: one that decides now and then.
fn ray(d: &mut Draw) -> Input {
    let (triangle, word) = (d.pick(&[0, 1, 7, u32::MAX, 0x8000_0000]), d.word());
    let triangle = if d.now_and_then() { d.word() } else { triangle };
    let mut made = Input::default();
    made.0[..3].copy_from_slice(&[0, triangle, word]);
    let (any, threshold) = (d.unit(), threshold(&made));
    made.0[0] = d.pick(&[0.0, 1.0, any, threshold, threshold + 1.0 / 16_777_216.0]).to_bits();
    made
}

/// An alpha and a cutoff, often equal.
fn material(d: &mut Draw) -> Input {
    let (any, small) = (d.unit(), d.magnitude(-30, 0));
    let alpha = d.pick(&[0.0, 1.0, 1.0 / 255.0, any, small, 1.5]);
    let other = d.unit();
    input([alpha, d.pick(&[0.0, 0.0, alpha, 0.5, other, 2.0]), 0.0, 0.0], [0.0; 4], [0.0; 4])
}

/// A hit: barycentric coordinates, a triangle and its position in BVH order.
fn hit(d: &mut Draw) -> Input {
    let [u, v] = barycentric(d);
    let triangle = d.word() % TRIANGLES;
    let mut made = input([u, v, 0.0, 0.0], [0.0; 4], [0.0; 4]);
    (made.0[3], made.0[5]) = (SHADED.slots[triangle as usize], triangle);
    made
}

/// Three numbers in the unit interval, or somewhat more.
fn shares(d: &mut Draw) -> Input {
    let mut any = || {
        let unit = d.unit();
        d.pick(&[0.0, 1.0, unit, unit, 1.0 - 1e-6, 1.25])
    };
    input([any(), any(), any(), 0.0], [0.0; 4], [0.0; 4])
}

/// A hit and the random word of its ray: one that decides now and then.
fn met(d: &mut Draw) -> Input {
    let mut made = hit(d);
    let (any, last) = (d.word(), (share(&made, [made.float(0), made.float(1)]) * 16_777_216.0) as u32);
    made.0[2] = d.pick(&[0, u32::MAX, any, any, last.wrapping_shl(8), last.wrapping_shl(8).wrapping_sub(1)]);
    made
}

fn tables() -> Shading<'static> {
    Shading { tables: SHADED.view().shading, values: &VALUES, triangles: TRIANGLES as usize }
}

fn share(i: &Input, [u, v]: [f32; 2]) -> f32 {
    let material = SHADED.primitives[i.0[5] as usize].material as usize;
    tables().glass_share(&Hit { t: 1.0, primitive: i.0[5], u, v }, &SHADED.materials[material])
}

fn met_material(i: &Input, word: u32) -> u32 {
    let index = SHADED.primitives[i.0[5] as usize].material;
    let hit = Hit { t: 1.0, primitive: i.0[5], u: i.float(0), v: i.float(1) };
    tables().met_material(&hit, index, &SHADED.materials[index as usize], word)
}

fn covered(i: &Input, [u, v]: [f32; 2]) -> f32 {
    let material = SHADED.primitives[i.0[5] as usize].material as usize;
    tables().coverage(&Hit { t: 1.0, primitive: i.0[5], u, v }, &SHADED.materials[material])
}

#[test]
fn coverage_is_that_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &SHADED.view());
    let address = words_of(scene.address());
    for row in rows() {
        // Each time something slightly different, which is detected.
        let wrong: Twin = match row.function {
            0 => |i| word(alpha::mix(i.0[0] ^ 1)),
            1 => |i| word((alpha::keep(i.float(0), i.0[1], i.0[2]) || i.float(0) > 0.999_999_9 * threshold(i)).into()),
            2 => |i| output([if i.float(1) > 0.0 { alpha::coverage(i.float(0), i.float(1)) } else { i.float(0) }]),
            4 => |i| output([i.float(0) * i.float(1) * (1.0 - i.float(2))]),
            5 => |i| output([i.float(0) / (1.0 - i.float(1))]),
            6 => |i| output([share(i, [i.float(0) + 4.0 * LAST, i.float(1)])]),
            7 => |i| word(met_material(i, i.0[2] ^ 256)),
            _ => |i| output([covered(i, [i.float(0) + 4.0 * LAST, i.float(1)])]),
        };
        assert_twin(&mut on, &row, &address, wrong);
    }
}

/// The coverage above which the triangle is there.
fn threshold(i: &Input) -> f32 {
    (alpha::mix(i.0[2] ^ i.0[1].wrapping_mul(0x9E37_79B9)) >> 8) as f32 / 16_777_216.0
}
