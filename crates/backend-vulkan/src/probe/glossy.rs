//! Glossy surfaces compared with photon-core's.

use std::sync::LazyLock;

use photon_core::glam::{Vec2, Vec3};
use photon_core::{
    AlbedoTable, Glossy, Layers, Material, ReflectionLobe, Requirements, Settings, anisotropy, ggx, glossy, sampling,
};
use photon_scene::{MaterialDesc, Scene, SceneBuilder};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, output};
use super::{Input, Output, run_row, words_of, worst_of};
use crate::scene::VulkanScene;
use crate::{Vulkan, shaders};

pub(super) const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);
const GEOMETRIC: Vec3 = Vec3::new(0.6, 0.48, -0.64);

/// A plate of a metal; roughness and share of metal are those of each input.
static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = SceneBuilder::new();
    let plate = scene.material(MaterialDesc::metal("plate", [0.9, 0.6, 0.3], 0.5));
    scene.quad("plate", [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0]], plate);
    // A sheen, whose table is uploaded with it.
    let cloth = scene.material(MaterialDesc::lambert("cloth", [0.5; 3]).with_sheen([1.0; 3], 0.5));
    scene.quad("cloth", [[-2.0, -1.0, -2.0], [-2.0, -1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, -2.0]], cloth);
    scene.light("point", photon_scene::LightDesc::Point { position: [0.0, 1.0, 0.0], intensity: [1.0; 3] });
    scene.build().unwrap()
});

/// The plate on a device.
pub(super) fn scene(on: &mut Vulkan) -> VulkanScene {
    let view = SCENE.view();
    VulkanScene::new(on, &view, &Requirements::of(&view, &Settings::default())).unwrap()
}

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_GLOSSY;
    let row = |name, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    // Devices may round divisions and square roots by 2.5 steps. A half vector that is off by 5e-7 changes the narrowest
    // distribution drawn here, of a width of .04, by the fourth power of 1 + 5e-7/.04.
    vec![
        // Where the bound of the cap is nearly 1, the sine is the root of a difference of two steps.
        row("ggx_sample", 0, Bound::Within(1e-4), local, |i| {
            let [x, y, z] = ggx::sample(alpha(i), i.vector(0), i.float(8), i.float(9)).to_array();
            output([x, y, z])
        }),
        row("ggx_pdf", 1, Bound::Relative(4e-6), local, |i| {
            let (o, h) = (i.vector(0), i.vector(4));
            output([ggx::distribution(alpha(i), h), ggx::visibility(alpha(i), o.z, h.z), ggx::pdf(alpha(i), o, h)])
        }),
        row("albedo_directional", 2, Bound::Within(1e-5), local, |i| albedos(i, i.float(8))),
        row("glossy_new", 3, Bound::Within(3e-5), world, |i| parts(i, i.float(8))),
        row("glossy_evaluate", 4, Bound::Relative(1e-4), world, |i| evaluated(i, &layers(i), i.vector(0), i.vector(4))),
        // Factors are 1 within a step of the colours; the narrowest width is that of glossy_evaluate.
        row("lobe_weight", 6, Bound::Relative(1e-4), world, |i| lobe(i, &layers(i), i.vector(0), i.vector(4))),
        row("glossy_sample", 5, Bound::Within(1e-3), world, |i| sampled(i, &layers(i), i.float(8))),
        // At the pole of the cap, a step of 2⁻²² in 2 − versine moves the sine by √(2 · 2⁻²²) = 7e-4.
        row("anisotropy_sample", 7, Bound::Within(1e-3), local, |i| anisotropic_sample(i, i.float(8))),
        row("anisotropy_pdf", 8, Bound::Relative(4e-6), local, |i| anisotropic_parts(i, i.vector(0), i.vector(4))),
        // A step of the direction.
        row("anisotropy_pack", 9, Bound::Within(1e-4), tangent, |i| packed(i, i.vector(0))),
        row("glossy_evaluate, anisotropic", 10, Bound::Relative(1e-4), world, |i| {
            evaluated(i, &anisotropic(i), i.vector(0), i.vector(4))
        }),
        row("glossy_sample, anisotropic", 11, Bound::Within(1e-3), world, |i| sampled(i, &anisotropic(i), i.float(8))),
        row("glossy_new, transmission", 13, Bound::Within(3e-5), world, |i| transmitted(i, i.float(8))),
        // The same factors as glossy_evaluate, and a ratio of cosines.
        row("glossy_evaluate, clearcoat's normal", 14, Bound::Relative(2e-4), world, |i| {
            value(i, &coated(i, i.float(8)), i.vector(0), i.vector(4))
        }),
        row("glossy_sample, clearcoat's normal", 15, Bound::Conditioned(1e-3, HORIZON, at_horizon), world, |i| {
            drawn_from(i, &coated(i, i.float(8)), i.float(8))
        }),
        // Sines and cosines of half vectors: off by 5e-7, with exponents up to 102 of a logarithm that is off by 5e-7.
        row("glossy_new, sheen", 16, Bound::Within(1e-4), world, |i| clothed_parts(i, i.float(9))),
        row("glossy_evaluate, sheen", 17, Bound::Relative(2e-4), world, |i| {
            evaluated(i, &clothed(i), i.vector(0), i.vector(4))
        }),
        row("glossy_sample, sheen", 18, Bound::Within(1e-3), world, |i| sampled(i, &clothed(i), i.float(8))),
        row("lobe_weight, sheen", 19, Bound::Conditioned(2e-4, "its condition", of_cloth), world, |i| {
            cloth_lobe(i, i.vector(0), i.vector(4))
        }),
        row("lobe_weight, anisotropic", 12, Bound::Relative(1e-4), world, |i| {
            lobe(i, &anisotropic(i), i.vector(0), i.vector(4))
        }),
    ]
}

/// A tangent of the normal, a strength, and words for a path.
fn tangent(d: &mut Draw) -> Input {
    let (x, y) = sampling::basis(NORMAL);
    let (sin, cos) = photon_core::math::sin_cos_turns(d.unit());
    let mut made =
        input((x * cos + y * sin).extend(0.0).to_array(), [0.0, 0.0, 0.0, d.pick(&[0.0, 0.2, 1.0])], [0.0; 4]);
    made.0[8] = d.word();
    made
}

fn widths(i: &Input) -> Vec2 {
    anisotropy::widths(i.float(3), i.float(9))
}

fn anisotropic_sample(i: &Input, u: f32) -> Output {
    let [x, y, z] = anisotropy::sample(widths(i), i.vector(0), u, i.float(9)).to_array();
    output([x, y, z])
}

fn anisotropic_parts(i: &Input, o: Vec3, h: Vec3) -> Output {
    let widths = widths(i);
    let (pdf, roughness) = (anisotropy::pdf(widths, o, h), anisotropy::equivalent_roughness(widths));
    output([anisotropy::distribution(widths, h), anisotropy::visibility(widths, o, h), pdf, roughness])
}

fn packed(i: &Input, along: Vec3) -> Output {
    let word = anisotropy::pack(&Layers::default().with_anisotropy(i.float(7), along), NORMAL);
    let (strength, tangent) = anisotropy::unpack(word, NORMAL).unwrap_or((0.0, sampling::basis(NORMAL).0));
    let [x, y, z] = if tangent.dot(along) < 0.0 { -tangent } else { tangent }.to_array();
    let path = (anisotropy::path_word(i.0[8], word) >> 16) as f32;
    output([x, y, z, strength, path, path, path, path])
}

fn alpha(i: &Input) -> f32 {
    (i.float(3) * i.float(3)).max(ggx::MIN_ALPHA)
}

/// Directions above the plane z = 0, a roughness, a share of metal, and two uniform numbers.
fn local(d: &mut Draw) -> Input {
    drawn(d, Vec3::Z)
}

/// The same above the plane of the normal.
fn world(d: &mut Draw) -> Input {
    drawn(d, NORMAL)
}

fn drawn(d: &mut Draw, normal: Vec3) -> Input {
    let mut above = || sampling::about(normal, d.pick(&[0.001, 0.1, 0.5, 0.9, 0.98]) * d.between(0.9, 1.0), d.unit());
    let (a, b) = (above(), above());
    let roughness = d.pick(&[0.2, 0.3, 0.5, 1.0, 0.77]);
    let metallic = d.pick(&[0.0, 1.0, 0.3]);
    input(a.extend(roughness).to_array(), b.extend(metallic).to_array(), [d.unit(), d.unit(), 0.0, 0.0])
}

fn material(i: &Input) -> Material {
    Material { roughness: i.float(3), metallic: i.float(7), ..SCENE.view().materials[0] }
}

/// A specular colour that depends on the share of metal, white for one of three; half of them with a clearcoat.
pub(super) fn layers(i: &Input) -> Layers {
    let part = i.float(7);
    let clearcoat = if i.float(9) < 0.5 { 0.0 } else { 0.8 };
    Layers::default().with_specular_color(Vec3::new(1.0, 1.0 - part, 1.0 + 30.0 * part)).with_clearcoat(clearcoat, 0.3)
}

/// The same with anisotropy, in any direction.
fn anisotropic(i: &Input) -> Layers {
    layers(i).with_anisotropy(0.7, Vec3::new(i.float(8), i.float(9), 0.3))
}

/// With a sheen of a roughness between 0 and 1.
fn clothed(i: &Input) -> Layers {
    layers(i).with_sheen(Vec3::new(0.9, 0.5, 0.2), i.float(8))
}

fn clothed_parts(i: &Input, cosine: f32) -> Output {
    let glossy = glossy(i, &clothed(i));
    let [r, g, b] = glossy.diffuse().to_array();
    let entering = glossy.coat().entering(cosine) / 16.0;
    output([r, g, b, glossy.specular_probability(), glossy.sheen_probability(), entering, glossy.sheen_through()])
}

/// The value, and 1e-4: those of the narrowest lobes end among denormals. Where the half vector h is close to the normal,
/// the value is sensitive to its cosine: sin² h is 1 − cos² h, off by 2.4e-7, and its power 1/2α relatively by that over
/// 2α sin² h.
fn of_cloth(i: &Input) -> f64 {
    let lobe = ReflectionLobe::new(ReflectionLobe::pack_sheen(&clothed(i)), i.vector(0), NORMAL);
    let half = (i.vector(0).as_dvec3() + i.vector(4).as_dvec3()).normalize_or(NORMAL.as_dvec3());
    let sine_squared = half.cross(NORMAL.as_dvec3()).length_squared();
    let alpha = f64::from(i.float(8)).powi(2).max(1e-6);
    let sensitivity = 2.4e-7 / (2.0 * alpha * sine_squared.max(1e-12));
    1e-4 + f64::from(lobe.weight(i.vector(4), GEOMETRIC).x) * (1.0 + sensitivity / 2e-4)
}

fn cloth_lobe(i: &Input, wo: Vec3, wi: Vec3) -> Output {
    let lobe = ReflectionLobe::new(ReflectionLobe::pack_sheen(&clothed(i)), wo, NORMAL);
    let [r, g, b] = lobe.weight(wi, GEOMETRIC).to_array();
    output([r, g, b])
}

fn glossy(i: &Input, layers: &Layers) -> Glossy {
    Glossy::new(&material(i), layers, i.vector(0).dot(NORMAL))
}

fn albedos(i: &Input, cosine: f32) -> Output {
    let table = AlbedoTable::get();
    let (directional, mean) = (table.directional(cosine, i.float(3)), table.mean(i.float(3)));
    output([directional.x, directional.y, mean.x, mean.y])
}

fn parts(i: &Input, cosine: f32) -> Output {
    let glossy = glossy(i, &layers(i));
    let [r, g, b] = glossy.diffuse().to_array();
    let first = glossy.specular_probability();
    let rest = glossy::rest_of(i.float(9), first);
    // The factor is up to 1/T̄: with these coats less than 16.
    let entering = glossy.coat().entering(cosine) / 16.0;
    output([r, g, b, first, glossy.multiple_probability(), entering, rest])
}

/// With diffuse transmission of this share.
fn transmitted(i: &Input, share: f32) -> Output {
    let glossy = glossy(i, &layers(i).with_diffuse_transmission(share, Vec3::new(0.9, 0.5, 0.1)));
    let ([r, g, b], [x, y, z]) = (glossy.diffuse().to_array(), glossy.transmitted().to_array());
    output([r, g, b, glossy.specular_probability(), x, y, z, glossy.transmission_probability()])
}

/// With a clearcoat that has another normal; for photons if `choice` is below ½.
fn coated(i: &Input, choice: f32) -> Glossy {
    let layers = layers(i).with_coat_normal(Vec3::new(0.36, 0.8, -0.48));
    Glossy::at(&material(i), &layers, i.vector(0).dot(NORMAL), i.vector(0), choice < 0.5)
}

const HORIZON: &str = "1 + 0.03 of the weight over the cosine";

/// The reflection of a clearcoat with another normal is weighted by the cosine to the shading normal, also where that is
/// close to 0: the weight is then off by its slope, weight over cosine, times what the direction is off by, 3e-5.
fn at_horizon(i: &Input) -> f64 {
    let (wi, found) = coated(i, i.float(8)).sample(i.vector(0), NORMAL, i.float(8), i.float(9));
    let slope = found.weight(1.0).max_element() / wi.dot(NORMAL).max(1e-5);
    1.0 + 0.03 * f64::from(slope)
}

pub(super) fn evaluated(i: &Input, layers: &Layers, wo: Vec3, wi: Vec3) -> Output {
    value(i, &glossy(i, layers), wo, wi)
}

fn value(i: &Input, glossy: &Glossy, wo: Vec3, wi: Vec3) -> Output {
    let found = glossy.evaluate(wo, wi, NORMAL);
    let [r, g, b] = found.value.to_array();
    let limited = glossy::limited(i.vector(4), GEOMETRIC, NORMAL);
    output([r, g, b, found.pdf, limited, limited, limited, limited])
}

fn lobe(i: &Input, layers: &Layers, wo: Vec3, wi: Vec3) -> Output {
    let (words, factor) = ReflectionLobe::pack(&material(i), layers);
    let anisotropy = anisotropy::pack(layers, NORMAL);
    let weight = ReflectionLobe::with_anisotropy(words, anisotropy, wo, NORMAL).weight(wi, GEOMETRIC);
    let ([x, y, z], [r, g, b]) = (factor.to_array(), weight.to_array());
    output([x, y, z, 0.0, r, g, b])
}

fn sampled(i: &Input, layers: &Layers, u: f32) -> Output {
    drawn_from(i, &glossy(i, layers), u)
}

fn drawn_from(i: &Input, glossy: &Glossy, u: f32) -> Output {
    let (wi, found) = glossy.sample(i.vector(0), NORMAL, u, i.float(9));
    let ([x, y, z], [r, g, b]) = (wi.to_array(), found.weight(1.0).to_array());
    output([x, y, z, 0.0, r, g, b])
}

#[test]
fn glossy_surfaces_are_those_of_rust() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = scene(&mut on);
    let address = words_of(scene.address());
    for mut row in rows() {
        let (inputs, outputs) = run_row(&mut on, &row, &address);
        let share = worst_of(&mut on, &row, &inputs, &outputs).unwrap();
        eprintln!("{:<24} {share:>9.3e} of {}", row.name, row.bound);
        // Exchanged numbers and directions: all are detected.
        row.twin = match row.function {
            0 => |i| {
                let [x, y, z] = ggx::sample(alpha(i), i.vector(0), i.float(9), i.float(8)).to_array();
                output([x, y, z])
            },
            1 => |i| {
                let (o, h) = (i.vector(4), i.vector(0));
                output([ggx::distribution(alpha(i), h), ggx::visibility(alpha(i), o.z, h.z), ggx::pdf(alpha(i), o, h)])
            },
            2 => |i| albedos(i, i.float(9)),
            3 => |i| parts(i, i.float(9)),
            4 => |i| evaluated(i, &layers(i), i.vector(4), i.vector(0)),
            5 => |i| sampled(i, &layers(i), i.float(8) * 0.99),
            6 => |i| lobe(i, &layers(i), i.vector(0), i.vector(0)),
            7 => |i| anisotropic_sample(i, i.float(9)),
            8 => |i| anisotropic_parts(i, i.vector(4), i.vector(0)),
            9 => |i| packed(i, sampling::basis(NORMAL).0),
            // Without the anisotropy.
            10 => |i| evaluated(i, &layers(i), i.vector(0), i.vector(4)),
            13 => |i| transmitted(i, i.float(9)),
            14 => |i| value(i, &coated(i, 1.0 - i.float(8)), i.vector(0), i.vector(4)),
            15 => |i| drawn_from(i, &coated(i, i.float(8)), i.float(8) * 0.99),
            11 => |i| sampled(i, &layers(i), i.float(8)),
            16 => |i| clothed_parts(i, i.float(8)),
            // Without the sheen.
            17 => |i| evaluated(i, &layers(i), i.vector(0), i.vector(4)),
            18 => |i| sampled(i, &layers(i), i.float(8)),
            19 => |i| cloth_lobe(i, i.vector(0), i.vector(0)),
            _ => |i| lobe(i, &layers(i), i.vector(0), i.vector(4)),
        };
        assert!(worst_of(&mut on, &row, &inputs, &outputs).is_err(), "{}", row.name);
    }
}
