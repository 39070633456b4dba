//! Vertex attributes and textures at hits compared with photon-core's.

use photon_core::glam::Vec3;
use photon_core::{Hit, Shaded, Shading, SurfaceInteraction, shade};

use super::compare::{Bound, Denormals, worst};
use super::draw::{Draw, input, inputs};
use super::shaded_scene::{LIGHTS, SHADED, TRIANGLES};
use super::table::{Row, Twin, finite, four, output};
use super::texture::VALUES;
use super::{Input, Output, assert_twin, whole_scene, words_of};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_SHADE;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row("shade_interpolate", 0, Bound::Bits, weighted, |i| {
            four_of(shade::interpolate(corners(i), [i.float(3), i.float(7), i.float(11)]))
        }),
        row(
            "shade_color",
            1,
            Bound::Bits,
            |d| Input([d.word(), d.word(), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
            |i| four_of(shade::unpack_color([i.0[0], i.0[1]])),
        ),
        // The tangent's length, and that of the sum.
        row("shade_turned", 2, Bound::Conditioned(1.2e-6, "its condition", condition), frame, |i| {
            four_of(turned(i, i.float(3)))
        }),
        // A division.
        row("shade_emission_ratio", 3, Bound::Relative(4e-7), light, |i| ratio(i, i.0[2])),
        row("shade, colours", 4, Bound::Bits, hit, |i| colors(&shaded(i, [i.float(0), i.float(1)]))),
        row("shade, specular", 6, Bound::Bits, hit, |i| specular(&shaded(i, [i.float(0), i.float(1)]))),
        // As of normals; directions of the texture are at least 0.5 long.
        row("shade, anisotropy", 7, Bound::Within(3e-5), hit, |i| anisotropy(&shaded(i, [i.float(0), i.float(1)]))),
        row("shade, transmission", 8, Bound::Bits, hit, |i| transmission(&shaded(i, [i.float(0), i.float(1)]))),
        row("shade, clearcoat's normal", 9, Bound::Within(2e-5), hit, |i| {
            four_of(shaded(i, [i.float(0), i.float(1)]).layers.coat_normal)
        }),
        row("shade, sheen", 10, Bound::Bits, hit, |i| sheen(&shaded(i, [i.float(0), i.float(1)]))),
        // A division.
        row("shade, metal", 12, Bound::Relative(4e-7), hit, |i| metal(&shaded(i, [i.float(0), i.float(1)]))),
        // The normal as below, times the slope of the albedo over the cosine, which is below 10 from a cosine of 1e-3 on.
        // Of textures with values above 1, which scenes may not have, it is large.
        row("emission_through", 11, Bound::Conditioned(2e-4, "1 + the value", magnitude), emitted, |i| {
            through(i, i.vector(6))
        }),
        // Vertex normals and tangents are off by 1e-6, a perpendicular of the tangent by four times that, and its
        // length is at least 0.5.
        row("shade, normal", 5, Bound::Within(2e-5), hit, |i| four_of(shaded(i, [i.float(0), i.float(1)]).normal)),
    ]
}

fn four_of(v: Vec3) -> Output {
    output(four(v))
}

fn corners(i: &Input) -> [Vec3; 3] {
    [0, 4, 8].map(|place| i.vector(place))
}

/// Three vectors and their weights.
fn weighted(d: &mut Draw) -> Input {
    let [u, v] = barycentric(d);
    let weights = [1.0 - u - v, u, v];
    let mut made = input(four(finite(d)), four(finite(d)), four(finite(d)));
    for (place, weight) in [3, 7, 11].into_iter().zip(weights) {
        made.0[place] = weight.to_bits();
    }
    made
}

pub(super) fn barycentric(d: &mut Draw) -> [f32; 2] {
    let (u, v) = (d.unit(), d.unit());
    if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] }
}

/// A tangent and the sign of the bitangent, a normal and a scale, and a texel of a normal map.
fn frame(d: &mut Draw) -> Input {
    let normal = d.direction();
    let tangent = d.direction() * d.pick(&[1.0, 0.8, 1e-3, 0.0]);
    let tangent = d.pick(&[tangent, tangent, normal, -normal, normal + tangent * 1e-3]);
    let byte = |d: &mut Draw| VALUES[0][(d.word() % 256) as usize];
    let texel = if d.now_and_then() { Vec3::splat(0.5) } else { Vec3::new(byte(d), byte(d), byte(d)) };
    let flat = d.pick(&[texel, texel, Vec3::new(0.5, 0.5, 1.0)]);
    let with = |v: Vec3, w: f32| v.extend(w).to_array();
    let scale = d.pick(&[1.0, 1.0, 0.0, -0.5, 3.0]);
    input(with(tangent, d.pick(&[1.0, -1.0])), with(normal, scale), four(flat))
}

fn turned(i: &Input, sign: f32) -> Vec3 {
    shade::turned(i.vector(0), sign, i.vector(4), i.vector(8), i.float(7))
}

/// Condition number: the lengths of the three vectors that are added, divided by the length of their sum, and 1. Infinite
/// where rounding may decide whether the sum is 0.
fn condition(i: &Input) -> f64 {
    let (tangent, normal) = (i.vector(0), i.vector(4));
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or(Vec3::ZERO);
    if tangent == Vec3::ZERO {
        return 1.0;
    }
    let [x, y, z] = (i.vector(8) * 2.0 - Vec3::ONE).to_array();
    let (x, y) = (x * i.float(7), y * i.float(7));
    let sum = tangent * x + normal.cross(tangent) * (y * i.float(3)) + normal * z;
    let lengths = f64::from(x.abs() + y.abs() + z.abs());
    match lengths / f64::from(sum.length()) {
        _ if lengths <= 0.0 => 1.0,
        relative if relative < 1e5 => 1.0 + relative,
        _ => f64::INFINITY,
    }
}

/// A hit: barycentric coordinates, a triangle with its position in BVH order, and its side.
fn hit_of(d: &mut Draw, triangle: u32) -> Input {
    let [u, v] = barycentric(d);
    let mut made = input([u, v, 0.0, 0.0], [0.0; 4], [0.0; 4]);
    (made.0[3], made.0[4], made.0[5]) = (SHADED.slots[triangle as usize], d.word() % 2, triangle);
    made
}

pub(super) fn hit(d: &mut Draw) -> Input {
    let triangle = d.word() % TRIANGLES;
    hit_of(d, triangle)
}

/// A point of an area light; the third word is the light.
fn light(d: &mut Draw) -> Input {
    let light = d.word() % LIGHTS;
    let mut made = hit_of(d, SHADED.lights[light as usize].primitive);
    made.0[2] = light;
    made
}

fn tables() -> Shading<'static> {
    Shading { tables: SHADED.view().shading, values: &VALUES, triangles: TRIANGLES as usize }
}

fn ratio(i: &Input, light: u32) -> Output {
    let material = SHADED.primitives[i.0[5] as usize].material as usize;
    let light = &SHADED.lights[light as usize];
    four_of(tables().emission_ratio(light, (i.float(0), i.float(1)), &SHADED.materials[material]))
}

fn shaded(i: &Input, [u, v]: [f32; 2]) -> Shaded {
    let primitive = SHADED.primitives[i.0[5] as usize];
    let (normal, front) = (Vec3::from(primitive.normal), i.0[4] != 0);
    let surface = SurfaceInteraction {
        t: 1.0,
        point: Vec3::ZERO,
        start: Vec3::ZERO,
        normal: if front { normal } else { -normal },
        cosine: 1.0,
        front,
        material: primitive.material,
    };
    let hit = Hit { t: 1.0, primitive: i.0[5], u, v };
    tables().shade(&surface, &hit, &SHADED.materials[primitive.material as usize])
}

fn specular(shaded: &Shaded) -> Output {
    let [r, g, b] = shaded.layers.specular_color.to_array();
    output([shaded.material.specular, r, g, b, shaded.layers.clearcoat, shaded.layers.clearcoat_roughness])
}

fn anisotropy(shaded: &Shaded) -> Output {
    let [x, y, z] = shaded.layers.tangent.to_array();
    output([x, y, z, shaded.layers.anisotropy])
}

fn transmission(shaded: &Shaded) -> Output {
    let [r, g, b] = shaded.layers.transmission_color.to_array();
    output([r, g, b, shaded.layers.diffuse_transmission])
}

fn sheen(shaded: &Shaded) -> Output {
    let [r, g, b] = shaded.layers.sheen_color.to_array();
    output([r, g, b, shaded.layers.sheen_roughness])
}

fn metal(shaded: &Shaded) -> Output {
    output([shaded.material.metallic])
}

/// A point of a triangle, and a direction from it.
fn emitted(d: &mut Draw) -> Input {
    let mut made = hit(d);
    let direction = d.direction().to_array();
    (made.0[6], made.0[7], made.0[8]) = (direction[0].to_bits(), direction[1].to_bits(), direction[2].to_bits());
    made
}

/// What the clearcoat lets through.
fn through(i: &Input, direction: Vec3) -> Output {
    let primitive = SHADED.primitives[i.0[5] as usize];
    let material = &SHADED.materials[primitive.material as usize];
    let (front, at) = (Vec3::from(primitive.normal), (i.float(0), i.float(1)));
    output([tables().emission_through(i.0[5] as usize, at, material, front, direction); 4])
}

fn magnitude(i: &Input) -> f64 {
    1.0 + f64::from(f32::from_bits(through(i, i.vector(6))[0]).abs())
}

fn colors(shaded: &Shaded) -> Output {
    let ([r, g, b], [x, y, z]) = (shaded.material.albedo, shaded.material.emission);
    // That of partly transmitting materials has a division, and is a row of its own.
    let metallic = if shaded.material.has_partial_transmission() { 0.0 } else { shaded.material.metallic };
    output([r, g, b, shaded.material.roughness, x, y, z, metallic])
}

/// [`shade::turned`] with lengths off by `error` of themselves, with signs by the bits of `signs`.
fn rough_turned(i: &Input, error: f32, signs: u32) -> Output {
    let off = |bit: u32| if signs >> bit & 1 == 0 { 1.0 + error } else { 1.0 - error };
    let (tangent, normal) = (i.vector(0), i.vector(4));
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or(Vec3::ZERO) * off(0);
    if tangent == Vec3::ZERO {
        return four_of(normal);
    }
    let [x, y, z] = (i.vector(8) * 2.0 - Vec3::ONE).to_array();
    let bitangent = normal.cross(tangent) * i.float(3);
    let sum = tangent * (x * i.float(7)) + bitangent * (y * i.float(7)) + normal * z;
    four_of(if sum == Vec3::ZERO { normal } else { sum.normalize_or(normal) * off(1) })
}

/// A square root and a division of 5.4e-7 and 3e-7 pass, ten times as much fails.
#[test]
fn a_device_at_the_limits_of_vulkan_passes() {
    let row = rows().remove(2);
    let inputs = inputs(row.draw);
    for signs in 0..4 {
        let with = |error| inputs.iter().map(|input| rough_turned(input, error, signs)).collect::<Vec<_>>();
        let share = worst(&row, &inputs, &with(8.4e-7), Denormals::Kept).unwrap();
        eprintln!("{share:.3} of the bound");
        assert!(worst(&row, &inputs, &with(8.4e-6), Denormals::Kept).is_err(), "{signs:b}");
    }
}

#[test]
fn hits_are_shaded_as_in_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = whole_scene(&mut on, &SHADED.view());
    let address = words_of(scene.address());
    // The table is meaningful: few inputs are undecided.
    let decided = inputs(frame).iter().filter(|input| condition(input).is_finite()).count();
    assert!(decided > 15_000, "{decided}");
    for row in rows() {
        let last: &[u32] = if row.function < 3 { &[] } else { &address };
        // Weights, channels, coordinates, signs and lights that are exchanged: all are detected.
        let wrong: Twin = match row.function {
            0 => |i| four_of(shade::interpolate(corners(i), [i.float(7), i.float(3), i.float(11)])),
            1 => |i| four_of(shade::unpack_color([i.0[1], i.0[0]])),
            2 => |i| four_of(turned(i, -i.float(3))),
            3 => |i| ratio(i, i.0[2] ^ 1),
            4 => |i| colors(&shaded(i, [i.float(1), i.float(0)])),
            9 => |i| four_of(shaded(i, [i.float(1), i.float(0)]).layers.coat_normal),
            8 => |i| transmission(&shaded(i, [i.float(1), i.float(0)])),
            10 => |i| sheen(&shaded(i, [i.float(1), i.float(0)])),
            11 => |i| through(i, i.vector(5)),
            12 => |i| metal(&shaded(i, [i.float(1), i.float(0)])),
            6 => |i| specular(&shaded(i, [i.float(1), i.float(0)])),
            _ => |i| four_of(shaded(i, [i.float(1), i.float(0)]).normal),
        };
        assert_twin(&mut on, &row, last, wrong);
    }
}
