//! Offsets of shadow rays compared with photon-core's.

use photon_core::glam::Vec3;
use photon_core::shadow_terminator::{offset, pack, unpack};
use photon_core::{Hit, Shading, SurfaceInteraction, offset as surface_offset};

use super::compare::Bound;
use super::draw::Draw;
use super::shade::hit;
use super::shaded_scene::{SHADED, TRIANGLES};
use super::table::{Row, Twin, four, output, words};
use super::texture::VALUES;
use super::{Input, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_SHADOW_TERMINATOR;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row("shadow_terminator_pack", 0, Bound::Words, short, |i| words([pack(i.vector(0))])),
        row("shadow_terminator_unpack", 1, Bound::Bits, packed, |i| output(four(unpack(i.0[0])))),
        // Vertex normals are off by 1e-6, and edges are at most 2 long.
        row("shadow_terminator_of", 2, Bound::Within(5e-6), hit, |i| output(four(offset_at(i, [0, 1, 2])))),
    ]
}

/// Vectors from below the smallest that is packed to above the largest.
fn short(d: &mut Draw) -> Input {
    let scale = d.magnitude(-33, 1);
    let power = d.magnitude(-33, 1).to_bits() & 0xFF80_0000;
    let scale = d.pick(&[scale, f32::from_bits(power), 0.0]);
    super::draw::input(four(d.direction() * scale), [0.0; 4], [0.0; 4])
}

fn packed(d: &mut Draw) -> Input {
    let word = d.word();
    let word = d.pick(&[word, word, word | 31 << 27, 0]);
    Input([word, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
}

/// The offset at a hit, with the vertex normals in this order.
fn offset_at(i: &Input, order: [usize; 3]) -> Vec3 {
    let index = i.0[5] as usize;
    let [a, b, c] = SHADED.triangles[index].map(|vertex| Vec3::from(SHADED.positions[vertex as usize]));
    let primitive = &SHADED.primitives[index];
    let hit = Hit { t: 1.0, primitive: i.0[5], u: i.float(0), v: i.float(1) };
    let front = Vec3::from(primitive.normal);
    let direction = if i.0[4] != 0 { -front } else { front };
    let vertices = [a, b, c];
    let at = SurfaceInteraction::new(direction, &hit, vertices, surface_offset::margin(vertices), primitive);
    let tables = Shading { tables: SHADED.view().shading, values: &VALUES, triangles: TRIANGLES as usize };
    let Some(normals) = tables.vertex_normals(&hit) else { return Vec3::ZERO };
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    offset(vertices, order.map(|corner| normals[corner]), weights, at.start, at.normal)
}

#[test]
fn offsets_of_shadow_rays_are_those_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &SHADED.view());
    let address = words_of(scene.address());
    for row in rows() {
        // Coordinates that are exchanged, another sign, and normals of other vertices: all are detected.
        let wrong: Twin = match row.function {
            0 => |i| words([pack(Vec3::new(i.float(1), i.float(0), i.float(2)))]),
            1 => |i| output(four(-unpack(i.0[0]))),
            _ => |i| output(four(offset_at(i, [1, 2, 0]))),
        };
        assert_twin(&mut on, &row, if row.function < 2 { &[] } else { &address }, wrong);
    }
}
