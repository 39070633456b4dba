//! The functions, their twins, and the bound of each.
//!
//! Vulkan allows division an error of 2.5 units in the last place, a relative 3e-7, and a square root the 2.5
//! of a division plus the 2 of an inverse square root, 5.4e-7; the bounds follow from these.

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, centred_f32, evenly_spread, lcg, philox4x32, unit_f32};
use photon_core::{Kernel, RandomKind, fresnel, math, octahedral, offset, sampling};

use super::compare::Bound;
use super::draw::{Draw, LAST, input};
use super::{Input, Output, area, bias, gloss_caustics, solid_angle};
use crate::device::Module;
use crate::shaders;

/// One function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) name: &'static str,
    pub(super) module: &'static Module,
    /// Specialization constant 2 of the module.
    pub(super) function: u32,
    pub(super) bound: Bound,
    pub(super) draw: fn(&mut Draw) -> Input,
    pub(super) twin: Twin,
}

/// All functions in `shaders-glsl` with a twin in photon-core.
pub(super) fn rows() -> Vec<Row> {
    let row = |name, module, function, bound, draw, twin| Row { name, module, function, bound, draw, twin };
    [
        math_rows(row),
        random_rows(row),
        direction_rows(row),
        surface_rows(row),
        solid_angle::rows(),
        area::rows(),
        bias::rows(),
        gloss_caustics::rows(),
    ]
    .concat()
}

/// A function of the inputs in Rust.
pub(super) type Twin = fn(&Input) -> Output;
type Draws = fn(&mut Draw) -> Input;
type Make = fn(&'static str, &'static Module, u32, Bound, Draws, Twin) -> Row;

fn math_rows(row: Make) -> Vec<Row> {
    let module = &shaders::PROBE_MATH;
    vec![
        row(
            "copysign",
            module,
            0,
            Bound::Words,
            |d| input([d.any(), d.any(), 0.0, 0.0], Z, Z),
            |i| output([i.float(0).copysign(i.float(1))]),
        ),
        row(
            "is_finite, is_nan",
            module,
            1,
            Bound::Words,
            |d| input([d.any(), 0.0, 0.0, 0.0], Z, Z),
            |i| {
                let x = i.float(0);
                words([x.is_finite().into(), x.is_nan().into(), (x.is_finite() && x > 0.0).into()])
            },
        ),
        row(
            "cross3, dot3",
            module,
            2,
            Bound::Bits,
            |d| input(four(finite(d)), four(finite(d)), Z),
            |i| {
                let (a, b) = (i.vector(0), i.vector(4));
                let cross = a.cross(b);
                output([cross.x, cross.y, cross.z, a.dot(b)])
            },
        ),
        row(
            "normalize_or",
            module,
            3,
            Bound::Within(1e-6),
            |d| input(four(vector(d)), four(d.direction()), Z),
            |i| vector_output(i.vector(0).normalize_or(i.vector(4))),
        ),
        row(
            "sin_cos_turns",
            module,
            4,
            Bound::Bits,
            |d| input([d.unit(), 0.0, 0.0, 0.0], Z, Z),
            |i| {
                let (sin, cos) = math::sin_cos_turns(i.float(0));
                output([sin, cos])
            },
        ),
        row("exp_neg", module, 5, Bound::Bits, exponent, |i| output([math::exp_neg(i.float(0))])),
        row(
            "math_ln",
            module,
            6,
            Bound::Bits,
            |d| input([normal(d), 0.0, 0.0, 0.0], Z, Z),
            |i| output([math::ln(i.float(0))]),
        ),
        // A division of the smaller by the larger.
        row("turns_of", module, 7, Bound::Relative(7e-7), angle, |i| output([math::turns_of(i.float(0), i.float(1))])),
        row("one_minus_exp", module, 9, Bound::Bits, exponent, |i| output([math::one_minus_exp(i.float(0))])),
        row(
            "minus_ln_one_minus",
            module,
            10,
            Bound::Bits,
            |d| input([d.unit(), 0.0, 0.0, 0.0], Z, Z),
            |i| output([math::minus_ln_one_minus(i.float(0))]),
        ),
        // The last step, which corrects rounding errors, is relative to the residual of the cube: 2⁻²³ of it,
        // and less.
        row("cube_root", module, 8, Bound::BitsMagnified(slope_of_root), root, |i| {
            output([math::cube_root(i.float(0))])
        }),
    ]
}

fn random_rows(row: Make) -> Vec<Row> {
    let module = &shaders::PROBE_RANDOM;
    vec![
        row("philox4x32", module, 0, Bound::Words, any_words, |i| {
            let [a, b, c, d, e, f, ..] = i.0;
            words(philox4x32([a, b, c, d], [e, f]))
        }),
        row("lcg, unit_f32, centred_f32", module, 1, Bound::Words, any_words, |i| {
            let [word, ..] = i.0;
            words([lcg(word), unit_f32(word).to_bits(), centred_f32(word).to_bits()])
        }),
        row("evenly_spread", module, 4, Bound::Words, any_words, |i| {
            let [u, v, index, ..] = i.0;
            words(evenly_spread([u, v], index))
        }),
        row("wavelength_word", module, 3, Bound::Words, sampler, |i| words([sampler_of(i).wavelength(i.0[6])])),
        row("sampler_words", module, 2, Bound::Words, sampler, |i| {
            let [.., first, second, _, _, _, _] = i.0;
            let mut sampler = sampler_of(i);
            let (first, second) = (sampler.words(first), sampler.words(second));
            words([first, second].concat().try_into().unwrap_or([0; 8]))
        }),
    ]
}

/// The sampler of an input of [`sampler`].
fn sampler_of(i: &Input) -> Sampler {
    let [kind, low, high, pass, domain, path, ..] = i.0;
    let kind = [RandomKind::Counter, RandomKind::Lcg][kind as usize];
    let domains = [Domain::Photon, Domain::Eye, Domain::Shadow, Domain::Gather, Domain::Area, Domain::Aimed];
    Sampler::new(kind, u64::from(high) << 32 | u64::from(low), pass, domains[domain as usize], path)
}

fn direction_rows(row: Make) -> Vec<Row> {
    let (packing, module) = (&shaders::PROBE_OCTAHEDRAL, &shaders::PROBE_SAMPLING);
    let pair: Draws = |d| input([d.unit(), d.unit(), 0.0, 0.0], Z, Z);
    let turned: Draws = |d| {
        let sign = d.pick(&[1.0, -0.5]);
        input([sign * d.unit(), d.unit(), 0.0, 0.0], Z, Z)
    };
    let spot: Draws = |d| {
        let outer = if d.now_and_then() { d.pick(&[1.0, 0.5, 1e-7, LAST]) } else { d.between(0.0, 1.0) };
        let inner = if d.now_and_then() { d.pick(&[outer, 0.0, 0.999 * outer]) } else { d.between(0.0, outer) };
        input([d.unit(), inner, outer, 0.0], Z, Z)
    };
    vec![
        // A division: the nearest step of 2⁻¹⁵ may be a neighbouring one.
        row(
            "octahedral_pack",
            packing,
            0,
            Bound::Step,
            |d| input(four(vector(d)), Z, Z),
            |i| words([octahedral::pack(i.vector(0))]),
        ),
        row("octahedral_unpack", packing, 1, Bound::Within(1e-6), packed, |i| {
            vector_output(octahedral::unpack(i.0[0]))
        }),
        row(
            "sampling_basis",
            module,
            0,
            Bound::Within(4e-7),
            |d| input(four(d.direction()), Z, Z),
            |i| {
                let (t, b) = sampling::basis(i.vector(0));
                output([t.x, t.y, t.z, 0.0, b.x, b.y, b.z])
            },
        ),
        // Near the pole a cosine determines the sine poorly, but both sides get the same one.
        row("sampling_about", module, 1, Bound::Within(2e-6), about, |i| {
            vector_output(sampling::about(i.vector(0), i.float(4), i.float(5)))
        }),
        row("cosine_hemisphere", module, 2, Bound::Within(2e-6), about, |i| {
            vector_output(sampling::cosine_hemisphere(i.vector(0), i.float(4), i.float(5)))
        }),
        row("uniform_sphere", module, 3, Bound::Within(2e-6), turned, |i| {
            vector_output(sampling::uniform_sphere(i.float(0), i.float(1)))
        }),
        row("sampling_triangle", module, 4, Bound::Relative(7e-7), pair, |i| {
            let (b, c) = sampling::triangle(i.float(0), i.float(1));
            output([b, c])
        }),
        row("sampling_disc", module, 5, Bound::Relative(7e-7), pair, |i| {
            let (x, y) = sampling::disc(i.float(0), i.float(1));
            output([x, y])
        }),
        row("spot_falloff", module, 6, Bound::Relative(8e-7), spot, |i| {
            output([sampling::spot_falloff(i.float(0), i.float(1), i.float(2))])
        }),
        // Double precision in Rust.
        row("spot_solid_angle", module, 7, Bound::Relative(4e-7), spot, |i| {
            output([sampling::spot_solid_angle(i.float(1), i.float(2)) as f32])
        }),
        row("spot_versine", module, 8, Bound::Within(1e-6), spot, |i| {
            output([sampling::spot_versine(i.float(1), i.float(2), i.float(0))])
        }),
        // A square root and a division, each within 2.5 steps.
        row("sun_versine", module, 9, Bound::Relative(8e-7), spot, |i| {
            output([sampling::sun_versine(i.float(2), i.float(0))])
        }),
    ]
}

fn surface_rows(row: Make) -> Vec<Row> {
    let (module, points, kernels) = (&shaders::PROBE_BSDF, &shaders::PROBE_OFFSET, &shaders::PROBE_KERNEL);
    vec![
        row("fresnel", module, 0, Bound::Within(2e-6), fresnel, |i| {
            let f = fresnel::fresnel(i.float(0), i.float(1));
            output([f.reflectance, f.cos_transmitted])
        }),
        row(
            "sheet_reflectance",
            module,
            1,
            Bound::Relative(4e-7),
            |d| input([d.unit(), 0.0, 0.0, 0.0], Z, Z),
            |i| output([fresnel::sheet_reflectance(i.float(0))]),
        ),
        row("bsdf_reflect", module, 2, Bound::Within(1e-6), meeting, |i| {
            vector_output(fresnel::reflect(i.vector(0), i.vector(4)))
        }),
        // When entering a medium of lower index, two vectors of length 1/eta nearly cancel.
        row(
            "bsdf_refract",
            module,
            3,
            Bound::Conditioned(2e-6, "max(1, 1/eta)", |i| f64::from(i.float(8)).recip().max(1.0)),
            meeting,
            |i| vector_output(fresnel::refract(i.vector(0), i.vector(4), i.float(8), i.float(9))),
        ),
        row("barycentric", points, 0, Bound::Bits, corners, |i| {
            let vertices = [i.vector(0), i.vector(4), i.vector(8)];
            vector_output(offset::barycentric(vertices, i.float(3), i.float(7)))
        }),
        // A division where a weight is raised, of a quantity that is at most two steps of the offset.
        row("within", points, 2, Bound::Within(2e-7), near_edges, |i| {
            let vertices = [i.vector(0), i.vector(4), i.vector(8)];
            vector_output(offset::within(vertices, i.float(11), i.float(3), i.float(7)))
        }),
        row(
            "off_surface",
            points,
            1,
            Bound::Bits,
            |d| input(four(d.point()), four(d.direction()), Z),
            |i| vector_output(offset::off_surface(i.vector(0), i.vector(4))),
        ),
        // Equal bits except for the cone, which has a square root and a division, and may be 0 at its edge.
        row("kernel_weight", kernels, 0, Bound::Bits, kernel, weight),
    ]
}

/// Corners, and barycentric weights of the second and the third; many of them on or near an edge.
fn near_edges(d: &mut Draw) -> Input {
    let ends = [0.0, 1e-8, 1e-6, 1e-3, 1.0, 1.0 - LAST, 0.999_999, 0.999];
    let weight = |d: &mut Draw| if d.now_and_then() { d.pick(&ends) } else { d.unit() };
    let (u, rest) = (weight(d), weight(d));
    let v = (1.0 - u) * rest;
    let [a, b, c] = [d.point(), d.point(), d.point()];
    input([a.x, a.y, a.z, u], [b.x, b.y, b.z, v], [c.x, c.y, c.z, offset::margin([a, b, c])])
}

/// [`offset::barycentric`] with one rounding fewer.
pub(super) fn fused_barycentric(i: &Input) -> Output {
    let [a, b, c] = [i.vector(0), i.vector(4), i.vector(8)];
    let (u, v) = (i.float(3), i.float(7));
    let axis = |a: f32, b: f32, c: f32| v.mul_add(c, a * (1.0 - u - v) + b * u);
    vector_output(Vec3::new(axis(a.x, b.x, c.x), axis(a.y, b.y, c.y), axis(a.z, b.z, c.z)))
}

const Z: [f32; 4] = [0.0; 4];

pub(super) fn four(v: Vec3) -> [f32; 4] {
    [v.x, v.y, v.z, 0.0]
}

/// A vector of any length, including zero and overflowing ones.
fn vector(d: &mut Draw) -> Vec3 {
    if d.now_and_then() {
        let scale = d.pick(&[0.0, -0.0, 1e-10, 1e10, f32::INFINITY, f32::NAN]);
        return d.direction() * scale;
    }
    let scale = d.pick(&[1.0, 1.0, 0.01, 30.0]);
    d.direction() * scale
}

/// A vector without NaN, whose bits are unspecified.
pub(super) fn finite(d: &mut Draw) -> Vec3 {
    let scale = d.pick(&[1.0, 1e-3, 1e-10, 1e10]);
    d.direction() * scale
}

fn normal(d: &mut Draw) -> f32 {
    let beside_one = [1.0 - LAST, 1.0, f32::from_bits(0x3F80_0001), 0.5, std::f32::consts::FRAC_1_SQRT_2, f32::MAX];
    if d.now_and_then() { d.pick(&beside_one) } else { d.magnitude(-126, 127) }
}

fn root(d: &mut Draw) -> Input {
    let x = if d.now_and_then() { d.pick(&[0.0, -0.0, 1e-40, f32::INFINITY, f32::NAN, 1.0, 8.0]) } else { normal(d) };
    input([x, 0.0, 0.0, 0.0], Z, Z)
}

/// Condition number of the cube root: its change for a change of the input, divided by the change.
fn slope_of_root(i: &Input) -> f64 {
    let root = f64::from(i.float(0)).cbrt();
    (3.0 * root * root).recip()
}

/// A vector whose second coordinate, which comes first, is not negative; includes multiples of an eighth of a
/// turn and their neighbourhoods.
fn angle(d: &mut Draw) -> Input {
    let special = [0.0, -0.0, 1e-20, 0.414_213_56, 0.414_213_6, 1.0 - LAST, 1.0, 1.000_000_1, 2.414_213_7, 1e20];
    let mut length = || if d.now_and_then() { d.pick(&special) } else { d.magnitude(-20, 20) };
    let (y, x) = (length(), length());
    input([y.abs(), x * d.pick(&[1.0, -1.0]), 0.0, 0.0], Z, Z)
}

fn exponent(d: &mut Draw) -> Input {
    let below = f32::from_bits(87.0_f32.to_bits() - 1);
    let special = [0.0, -0.0, 1e-40, 1e-7, below, 87.0, 1e4, f32::INFINITY, f32::NAN];
    let x = if d.now_and_then() { d.pick(&special) } else { d.magnitude(-20, 7) };
    input([x, 0.0, 0.0, 0.0], Z, Z)
}

fn any_words(d: &mut Draw) -> Input {
    Input(std::array::from_fn(|_| if d.now_and_then() { d.pick(&[0, 1, u32::MAX]) } else { d.word() }))
}

fn sampler(d: &mut Draw) -> Input {
    let mut input = any_words(d);
    input.0[0] = d.pick(&[0, 1]);
    input.0[4] = d.pick(&[0, 1, 2, 3, 4]);
    // The first blocks.
    if d.now_and_then() {
        input.0[6] = d.pick(&[0, 1, 2]);
        input.0[7] = d.pick(&[0, 1, 2]);
    }
    input
}

/// Words that are packed unit vectors, and arbitrary ones.
fn packed(d: &mut Draw) -> Input {
    let word = if d.now_and_then() { d.word() } else { octahedral::pack(d.direction()) };
    Input([word, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
}

fn about(d: &mut Draw) -> Input {
    input(four(d.direction()), [d.unit(), d.unit(), 0.0, 0.0], Z)
}

fn eta(d: &mut Draw) -> f32 {
    let special = [1.0, 1.0 - LAST, 1.000_000_1, 1e-6, 1e-3, 1e3, 1e6, 1e18];
    if d.now_and_then() { d.pick(&special) } else { d.between(0.4, 2.5) }
}

fn fresnel(d: &mut Draw) -> Input {
    let eta = eta(d);
    // The critical angle, and grazing incidence.
    let critical = (1.0 - eta * eta).max(0.0).sqrt();
    let cosine = if d.now_and_then() { d.pick(&[0.0, 1e-30, 1e-4, critical, 1.0, 1.000_000_1]) } else { d.unit() };
    input([cosine, eta, 0.0, 0.0], Z, Z)
}

/// A direction, a normal facing it, a relative index of refraction, and the corresponding cosine.
fn meeting(d: &mut Draw) -> Input {
    let (direction, normal) = (d.direction(), d.direction());
    let normal = if direction.dot(normal) > 0.0 { -normal } else { normal };
    let eta = eta(d);
    let cosine = fresnel::fresnel(-direction.dot(normal), eta).cos_transmitted;
    input(four(direction), four(normal), [eta, cosine, 0.0, 0.0])
}

fn corners(d: &mut Draw) -> Input {
    let [a, b, c] = [d.point(), d.point(), d.point()];
    let (u, v) = (d.unit(), d.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    input([a.x, a.y, a.z, u], [b.x, b.y, b.z, v], four(c))
}

fn kernel(d: &mut Draw) -> Input {
    let u = if d.now_and_then() { 1.0 } else { d.unit() };
    let mut input = input([0.0, 0.0, u, 0.0], Z, Z);
    input.0[0] = d.pick(&[0, 1]);
    input
}

fn weight(i: &Input) -> Output {
    output([[Kernel::Constant, Kernel::Epanechnikov][i.0[0] as usize].weight(i.float(2))])
}

pub(super) fn words<const N: usize>(words: [u32; N]) -> Output {
    let mut output = [0; 8];
    output[..N].copy_from_slice(&words);
    output
}

pub(super) fn output<const N: usize>(floats: [f32; N]) -> Output {
    words(floats.map(f32::to_bits))
}

fn vector_output(v: Vec3) -> Output {
    output([v.x, v.y, v.z])
}
