//! Rough glass compared with photon-core's.

use std::sync::LazyLock;

use photon_core::glam::Vec3;
use photon_core::{Interface, Lobe, Material, MediumStack, RoughGlass, RoughGlassTable, interface, sampling};
use photon_scene::{MaterialDesc, Scene, SceneBuilder, Surface, shapes};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, output};
use super::{Input, Output, assert_twin, whole_scene, words_of};
use crate::scene::VulkanScene;
use crate::{Vulkan, shaders};

const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);

/// A block of rough glass and a rough sheet; the roughness is that of each input.
static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = SceneBuilder::new();
    let glass = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [0.9, 0.6, 0.3], roughness: 0.5 };
    let glass = scene.material(MaterialDesc::new("glass", glass));
    let sheet = Surface::Thin { ior: 1.33, tint: [0.9, 0.6, 0.3], roughness: 0.5 };
    let sheet = scene.material(MaterialDesc::new("sheet", sheet));
    let (positions, triangles) = shapes::cuboid([-1.0; 3], [1.0, 0.0, 1.0]);
    scene.mesh("block", positions, triangles, glass);
    scene.quad("sheet", [[-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]], sheet);
    scene.light("point", photon_scene::LightDesc::Point { position: [0.0, 2.0, 0.0], intensity: [1.0; 3] });
    scene.build().unwrap()
});

static TABLE: LazyLock<RoughGlassTable> = LazyLock::new(|| RoughGlassTable::new(&SCENE.view()).expect("one ratio"));

/// The block and the sheet on a device.
pub(super) fn scene(on: &mut Vulkan) -> VulkanScene {
    whole_scene(on, &SCENE.view())
}

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_ROUGH_GLASS;
    let row = |name, function, bound, twin| Row { name, module, function, bound, draw, twin };
    vec![
        row("rough_glass_new", 0, Bound::Within(3e-5), |i| parts(i, i.float(8))),
        row("rough_glass_evaluate", 1, Bound::Relative(1e-3), |i| evaluated(i, i.vector(0), i.vector(4))),
        row("rough_glass_sample", 2, Bound::Conditioned(1e-3, "its condition", cancellation), |i| {
            sampled(i, i.float(8))
        }),
    ]
}

/// How much the reciprocal of that length counts in [`cancellation`].
pub(super) const MAGNIFIED: f64 = 1e-3;

/// A visible normal is a unit vector along the sum of a point of a sphere and the stretched direction of the path. At the
/// edge of the visible ones both cancel: their rounding errors count over the length of the sum.
pub(super) fn cancellation(i: &Input) -> f64 {
    let (tangent, bitangent) = sampling::basis(NORMAL);
    let (wo, alpha) = (i.vector(0), f64::from(i.float(3) * i.float(3)));
    let [x, y, z] = [tangent, bitangent, NORMAL].map(|axis| f64::from(wo.dot(axis)));
    let inverse = 1.0 / (alpha * alpha * (x * x + y * y) + z * z).sqrt();
    let top = z * inverse;
    let versine = f64::from(i.float(8)) * (1.0 + top);
    let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
    let (sin, cos) = (f64::from(i.float(9)) * std::f64::consts::TAU).sin_cos();
    let sum =
        [alpha * (sine * cos + alpha * x * inverse), alpha * (sine * sin + alpha * y * inverse), 1.0 - versine + top];
    let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
    // The sine has the error of a root near its end.
    1.0 + MAGNIFIED / length.max(1e-9) / sine.max(1e-4)
}

/// Directions on either side, the first on that of the normal; a roughness; a kind of boundary, and uniform numbers.
fn draw(d: &mut Draw) -> Input {
    let mut about =
        |normal: Vec3| sampling::about(normal, d.pick(&[0.001, 0.1, 0.5, 0.9, 0.98]) * d.between(0.9, 1.0), d.unit());
    let (a, above, below) = (about(NORMAL), about(NORMAL), about(-NORMAL));
    let b = if d.now_and_then() { above } else { below };
    let roughness = d.pick(&[0.3, 0.5, 0.77, 1.0]);
    let kind = d.pick(&[0.0, 1.0, 2.0]) + d.between(0.0, 0.999);
    input(a.extend(roughness).to_array(), b.extend(kind).to_array(), [d.unit(), d.unit(), 0.0, 0.0])
}

fn kind(i: &Input) -> f32 {
    i.float(7).floor()
}

fn glass(i: &Input) -> RoughGlass {
    glass_from(i, i.vector(0).dot(NORMAL))
}

fn glass_from(i: &Input, cosine: f32) -> RoughGlass {
    let view = SCENE.view();
    let material = Material { roughness: i.float(3), ..view.materials[usize::from(kind(i) == 2.0)] };
    let sides: Interface = interface(view.media, &material, kind(i) != 1.0, MediumStack::VACUUM, false);
    RoughGlass::new(&TABLE, &material, cosine, &sides).expect("rough")
}

fn parts(i: &Input, cosine: f32) -> Output {
    let [lost, beyond, staying, light_side, near, far] = glass(i).parts(&TABLE, cosine);
    output([lost, beyond, staying, light_side, near, far])
}

pub(super) fn evaluated(i: &Input, wo: Vec3, wi: Vec3) -> Output {
    let found = glass(i).evaluate(&TABLE, wo, wi, NORMAL);
    let [r, g, b] = found.value.to_array();
    output([r, g, b, found.pdf])
}

pub(super) fn sampled(i: &Input, u: f32) -> Output {
    let drawn = glass(i).sample(&TABLE, i.vector(0), NORMAL, [i.float(7) - kind(i), u, i.float(9)]);
    let ([x, y, z], [r, g, b]) = (drawn.direction.to_array(), drawn.found.weight(1.0).to_array());
    output([x, y, z, f32::from(u8::from(drawn.lobe == Lobe::SpecularReflection)), r, g, b, drawn.rest])
}

/// The direction of a sample, its largest weight, and whether it is one of what single scattering loses: then its value and its
/// density are evaluated for the direction, whose half vector is found again.
pub(super) fn drawn(i: &Input) -> (Vec3, f32, bool) {
    let choice = i.float(7) - kind(i);
    let [lost, ..] = glass(i).parts(&TABLE, 1.0);
    let drawn = glass(i).sample(&TABLE, i.vector(0), NORMAL, [choice, i.float(8), i.float(9)]);
    (drawn.direction, drawn.found.weight(1.0).max_element(), choice < lost)
}

/// What single scattering loses from `direction`, a difference of 1 and what it keeps.
pub(super) fn lost_from(i: &Input, direction: Vec3) -> f64 {
    let cosine = direction.dot(NORMAL);
    let [near, ..] = glass_from(i, cosine.abs()).parts(&TABLE, 1.0);
    let [_, beyond, ..] = glass(i).parts(&TABLE, cosine.abs());
    f64::from(if cosine > 0.0 { near } else { beyond })
}

#[test]
fn rough_glass_is_that_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = scene(&mut on);
    let address = words_of(scene.address());
    for row in rows() {
        assert_twin(
            &mut on,
            &row,
            &address,
            match row.function {
                0 => |i| parts(i, i.float(9)),
                1 => |i| evaluated(i, i.vector(4), i.vector(0)),
                _ => |i| sampled(i, i.float(8) * 0.99),
            },
        );
    }
}
