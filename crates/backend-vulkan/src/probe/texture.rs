//! Texture lookups compared with photon-core's.

use std::sync::LazyLock;

use photon_core::texture::{ByteValues, axis, byte_values, lookup};
use photon_core::{Filter, TexelFormat, Wrap};

use super::compare::Bound;
use super::draw::{Draw, LAST};
use super::shaded_scene::SHADED;
use super::table::{Row, Twin, output};
use super::{Input, assert_twin, run, whole_scene, words_of};
use crate::{Vulkan, shaders};

pub(super) static VALUES: LazyLock<ByteValues> = LazyLock::new(byte_values);

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_TEXTURE;
    let row = |name, function, draw, twin| Row { name, module, function, bound: Bound::Bits, draw, twin };
    vec![
        row("texture_axis", 0, coordinate, |i| output(along(i, 0))),
        row("texture_lookup", 1, coordinates, |i| output(texel(i, [i.float(4), i.float(5)]))),
    ]
}

/// A coordinate of a texture of `size` texels: numbers of any size, and edges and centres of texels of several
/// repetitions with their neighbours.
fn along_axis(d: &mut Draw, size: u32) -> u32 {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MAX, -1e-9, 1e-9, -0.0, 1e-40, 1e6, -7.5];
    let half = (d.word() % (10 * size)) as f32 - 5.0 * size as f32;
    let edge = 0.5 * half / size as f32;
    let beside = f32::from_bits(d.pick(&[edge.to_bits() + 1, edge.to_bits().saturating_sub(1)]));
    let (odd, any, unit) = (d.pick(&odd), d.between(-3.0, 3.0), d.unit());
    d.pick(&[odd, edge, beside, any, any, unit]).to_bits()
}

/// A coordinate, a number of texels, a wrap mode and a filter.
fn coordinate(d: &mut Draw) -> Input {
    let size = d.pick(&[1, 2, 3, 4, 5, 7, 256, 4096, 65_535]);
    let mut input = Input::default();
    input.0[..4].copy_from_slice(&[along_axis(d, size), size, d.pick(&[0, 1, 2]), d.pick(&[0, 1])]);
    input
}

/// Coordinates and a texture.
fn coordinates(d: &mut Draw) -> Input {
    let index = d.word() % SHADED.shading.textures.len() as u32;
    let texture = &SHADED.shading.textures[index as usize];
    let mut input = Input::default();
    input.0[4..7].copy_from_slice(&[along_axis(d, texture.width), along_axis(d, texture.height), index]);
    input
}

/// The texels and the weight of an input, in another wrap mode if `shift` is not 0.
fn along(i: &Input, shift: u32) -> [f32; 3] {
    let filter = if i.0[3] == Filter::Linear as u32 { Filter::Linear } else { Filter::Nearest };
    let (first, second, weight) = axis(i.float(0), i.0[1], WRAPS[((i.0[2] + shift) % 3) as usize], filter);
    [first as f32, second as f32, weight]
}

fn texel(i: &Input, uv: [f32; 2]) -> [f32; 4] {
    lookup(&SHADED.shading.textures[i.0[6] as usize], &VALUES, uv)
}

#[test]
fn textures_are_read_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &SHADED.view());
    let address = words_of(scene.address());
    for row in rows() {
        // Another wrap mode, and a coordinate that is slightly different: both are detected.
        let wrong: Twin = match row.function {
            0 => |i| output(along(i, 1)),
            _ => |i| output(texel(i, [i.float(4) + 4.0 * LAST, i.float(5)])),
        };
        assert_twin(&mut on, &row, &address, wrong);
    }
}

/// V9: texels beyond 4 GiB of the largest textures that are valid. Only the last row's end is in memory: the texture's
/// address is so far before it that lookups there read it.
#[test]
fn texels_beyond_4_gib_are_found() {
    const COUNT: u32 = 16;
    let Some(mut on) = Vulkan::for_tests() else { return };
    let values = on.memory("values", size_of::<ByteValues>() as u64).unwrap();
    on.write(&values, 0, bytemuck::cast_slice(VALUES.as_flattened())).unwrap();
    for (format, height) in [(TexelFormat::Linear8, 1_u32 << 16), (TexelFormat::Float32, 1 << 13)] {
        let width = 1_u32 << 16;
        let words = format.words() as u64;
        let texel = |k: u32| if format.is_float() { (k as f32).to_bits() } else { k };
        let end: Vec<u32> = (0..COUNT).flat_map(|k| (0..words as u32).map(move |c| texel(k + 100 * c))).collect();
        let texels = on.memory("texels", 4 * end.len() as u64).unwrap();
        on.write(&texels, 0, bytemuck::cast_slice(&end)).unwrap();
        let before = 4 * (u64::from(width) * u64::from(height) * words - end.len() as u64);
        assert!(before > u64::from(u32::MAX));
        let start = texels.address().wrapping_sub(before);
        // `Texture` of texture.glsl: its wrap modes clamp, and its filter takes the nearest texel.
        let [low, high] = words_of(start);
        let clamp = Wrap::Clamp as u32;
        let image = [low, high, width, height, format as u32, clamp, clamp, Filter::Nearest as u32];
        let images = on.memory("textures", 32).unwrap();
        on.write(&images, 0, bytemuck::cast_slice(&image)).unwrap();
        // Of `ShadingRef` and `SceneRef` only what a lookup reads: images and values, and the former's address.
        let mut shading = [0_u64; 17];
        (shading[6], shading[7]) = (images.address(), values.address());
        let shading_memory = on.memory("shading", size_of_val(&shading) as u64).unwrap();
        on.write(&shading_memory, 0, bytemuck::cast_slice(&shading)).unwrap();
        let mut scene = [0_u64; 12];
        scene[9] = shading_memory.address();
        let scene_memory = on.memory("scene", size_of_val(&scene) as u64).unwrap();
        on.write(&scene_memory, 0, bytemuck::cast_slice(&scene)).unwrap();
        let inputs: Vec<Input> = (0..COUNT)
            .map(|k| {
                let mut input = Input::default();
                let u = ((width - COUNT + k) as f32 + 0.5) / width as f32;
                let v = ((height - 1) as f32 + 0.5) / height as f32;
                input.0[4..6].copy_from_slice(&[u, v].map(f32::to_bits));
                input.0[10..].copy_from_slice(&words_of(scene_memory.address()));
                input
            })
            .collect();
        let found = run(&mut on, &shaders::PROBE_TEXTURE, 1, &inputs).unwrap();
        for (k, found) in (0..COUNT).zip(found) {
            let expected = match format {
                TexelFormat::Float32 => [0, 1, 2, 3].map(|c| (k + 100 * c) as f32),
                _ => [VALUES[0][k as usize], 0.0, 0.0, 0.0],
            };
            assert_eq!(found[..4], expected.map(f32::to_bits), "{format:?}, texel {k} from the end");
        }
    }
}
