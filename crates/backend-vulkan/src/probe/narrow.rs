//! V2, V3: the narrowest reflections and the most grazing directions against double precision, and the reflectance of smooth
//! metals.
//!
//! Inputs are exact in both precisions. Bounds are sums of rounding errors in units of [`STEP`], with 5 for a division and 9
//! for a square root, which Vulkan allows.

use std::f64::consts::{PI, TAU};

use photon_core::glam::{DVec3, Vec3};
use photon_core::{Bsdf, Features, Lobe, Material, MaterialKind, MediumStack, fresnel, ggx, interface};

use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, output};
use super::{Input, Output, assert_twin, glossy};
use crate::{Vulkan, shaders};

/// Largest relative error of one rounding.
pub(super) const STEP: f64 = 6e-8;

/// Squares of roughnesses: the least width, beside it, and others to 1.
const WIDTHS: [f32; 6] = [1e-3, 1.001e-3, 3e-3, 0.01, 0.1, 1.0];
const COSINES: [f32; 8] = [1e-7, 1e-6, 1e-4, 1e-3, 0.02, 0.5, 0.999_999, 1.0];

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let (gloss, smooth) = (&shaders::PROBE_GLOSSY, &shaders::PROBE_BSDF);
    let row = |name, module, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    vec![
        // 17 for the distribution, 19 for the visibility, 36 for the density; one more for the reference.
        row("ggx_pdf, narrow", gloss, 1, Bound::Relative(37.0 * STEP), pair, |i| parts(i, width(i))),
        row("ggx_sample, narrow", gloss, 0, Bound::Conditioned(STEP, "its condition", cancellation), one, |i| {
            sampled(i, [8, 9])
        }),
        row("mirror_reflectance", smooth, 4, Bound::Bits, metal, |i| reflectance(i, i.float(3))),
    ]
}

/// The width as kernels compute it.
fn width(i: &Input) -> f64 {
    f64::from((i.float(3) * i.float(3)).max(ggx::MIN_ALPHA))
}

fn towards(cosine: f32, turns: f32) -> Vec3 {
    let (sin, cos) = (f64::from(turns) * TAU).sin_cos();
    let cosine = f64::from(cosine);
    let sine = (1.0 - cosine * cosine).sqrt();
    DVec3::new(sine * cos, sine * sin, cosine).as_vec3()
}

fn drawn(d: &mut Draw, b: Vec3) -> Input {
    let roughness = d.pick(&WIDTHS).sqrt();
    let a = towards(d.pick(&COSINES), d.unit());
    input(a.extend(roughness).to_array(), b.extend(1.0).to_array(), [d.unit(), d.unit(), 0.0, 0.0])
}

/// A direction, and a microfacet normal a few widths from the surface's, or anywhere.
fn pair(d: &mut Draw) -> Input {
    let near = d.pick(&[0.0, 0.1, 1.0, 5.0, 100.0_f32]) * d.pick(&[1e-3, 0.01, 1.0]);
    let grazing = d.pick(&COSINES);
    let cosine = if d.now_and_then() { grazing } else { 1.0 / (1.0 + near * near).sqrt() };
    let b = towards(cosine, d.unit());
    drawn(d, b)
}

fn one(d: &mut Draw) -> Input {
    drawn(d, Vec3::Z)
}

fn vector(i: &Input, place: usize) -> DVec3 {
    i.vector(place).as_dvec3()
}

fn spread(alpha: f64, cosine: f64) -> f64 {
    (alpha * alpha + (1.0 - alpha * alpha) * cosine * cosine).sqrt()
}

/// The factor of a bounded cap (Eto and Tokuyoshi 2023, equation 5).
fn cap(alpha: f64, o: DVec3) -> f64 {
    let s = (1.0 + o.x.hypot(o.y)).powi(2);
    (1.0 - alpha * alpha) * s / (s + alpha * alpha * o.z * o.z)
}

fn parts(i: &Input, alpha: f64) -> Output {
    let (o, h) = (vector(i, 0), vector(i, 4));
    let root = h.x * h.x + h.y * h.y + alpha * alpha * h.z * h.z;
    let distribution = alpha * alpha / (PI * root * root);
    let visibility = 0.5 / (o.z * spread(alpha, h.z) + h.z * spread(alpha, o.z));
    let pdf = distribution / (2.0 * (cap(alpha, o) * o.z + spread(alpha, o.z)));
    output([distribution, visibility, pdf].map(|x| x as f32))
}

/// The point of the cap, stretched, whose direction is the microfacet normal; and its parts: the stretched direction of the
/// path, the distance from the pole, and the sine.
fn on_cap(i: &Input, [u, v]: [usize; 2]) -> (DVec3, DVec3, f64, f64) {
    let (alpha, o) = (width(i), vector(i, 0));
    let top = DVec3::new(alpha * o.x, alpha * o.y, o.z).normalize_or_zero();
    let versine = f64::from(i.float(u)) * (1.0 + cap(alpha, o) * top.z);
    let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
    let (sin, cos) = (f64::from(i.float(v)) * TAU).sin_cos();
    let sum = DVec3::new(alpha * (sine * cos + top.x), alpha * (sine * sin + top.y), 1.0 - versine + top.z);
    (sum, top, versine, sine)
}

fn sampled(i: &Input, places: [usize; 2]) -> Output {
    let o = vector(i, 0);
    let h = on_cap(i, places).0.normalize_or(DVec3::Z);
    let [x, y, z] = (h * (2.0 * o.dot(h)) - o).as_vec3().to_array();
    output([x, y, z])
}

/// Rounding errors of the reflected direction: those of the sum, over its length, which is short where the point of the cap
/// and the stretched direction cancel.
fn cancellation(i: &Input) -> f64 {
    let (sum, top, versine, sine) = on_cap(i, [8, 9]);
    let below = versine * cap(width(i), vector(i, 0)).min(1.0) * top.z;
    // 17 for a part of the stretched direction, 50 for what reaches below the equator.
    let of_versine = 50.0 * below + 2.0 * versine;
    let upwards = of_versine + 1.0 + 17.0 * top.z + sum.z.abs();
    // The root of a difference, near the pole and opposite to it.
    let of_square = 2.0 * (1.0 - versine).abs() * of_versine + 3.0 * versine;
    let of_sine = (of_square / (2.0 * sine.max(1e-30))).min((of_square / STEP).sqrt()) + 9.0 * sine;
    // Sine and cosine of turns have absolute errors of 2⁻²².
    let across = width(i) * (of_sine + 4.0 * sine + 20.0);
    4.0 * ((upwards + 1.5 * across) / sum.length() + 12.0) + 6.0
}

/// A colour, a share of metal and a cosine, grazing ones among them.
fn metal(d: &mut Draw) -> Input {
    let color = [d.unit(), d.unit(), d.unit(), d.pick(&[0.0, 1.0, 0.5])];
    let cosine = if d.now_and_then() { d.pick(&COSINES) } else { d.unit() };
    input(color, [cosine, 0.0, 0.0, 0.0], [0.0; 4])
}

fn reflectance(i: &Input, metallic: f32) -> Output {
    let albedo = i.vector(0).to_array();
    let material = Material { kind: MaterialKind::Mirror as u32, albedo, metallic, ..Material::default() };
    let sides = interface(&[], &material, true, MediumStack::VACUUM, false);
    let bsdf = Bsdf::new(Features::MIRROR, &material, i.float(4), &sides);
    let [r, g, b] = bsdf.weight(Lobe::SpecularReflection).to_array();
    output([r, g, b, fresnel::schlick_rise(i.float(4))])
}

#[test]
fn narrow_reflections_are_those_of_double_precision() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let scene = glossy::scene(&mut on);
    for row in rows() {
        let wrong: super::table::Twin = match row.name {
            "ggx_pdf, narrow" => |i| parts(i, width(i) * (1.0 + 1e-5)),
            "ggx_sample, narrow" => |i| sampled(i, [9, 8]),
            _ => |i| reflectance(i, 1.0 - i.float(3)),
        };
        assert_twin(&mut on, &row, &super::words_of(scene.address()), wrong);
    }
}
