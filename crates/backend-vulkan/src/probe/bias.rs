//! The probe of `bias.glsl`.

use photon_core::{ErrorMoments, Estimate};

use super::Output;
use super::compare::Bound;
use super::draw::{Draw, input};
use super::table::{Row, finite, four, output};
use crate::shaders;

/// A halving and a doubling, both exact, and one subtraction each; the difference of two floats is rounded to f64 in
/// Rust, and then to f32, which is the same as rounding once.
pub(super) fn rows() -> Vec<Row> {
    let draw = |d: &mut Draw| input(four(finite(d)), four(finite(d)), four(finite(d)));
    let twin = |i: &super::Input| -> Output {
        let estimate = Estimate { flux: i.vector(0).into(), ..Estimate::default() };
        let moments = ErrorMoments { wide: i.vector(4).into(), narrow: i.vector(8).into(), ..ErrorMoments::default() };
        let ([a, b, c], [x, y, z]) = moments.biases(&estimate);
        output([a, b, c, 0.0, x, y, z].map(|bias| bias as f32))
    };
    vec![Row { name: "biases", module: &shaders::PROBE_BIAS, function: 0, bound: Bound::Bits, draw, twin }]
}
