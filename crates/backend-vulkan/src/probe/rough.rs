//! Arithmetic of a device that is as inaccurate as Vulkan allows, for simulations.

use super::compare::{Denormals, worst};
use super::draw::inputs;
use super::table::Row;
use super::{Input, Output};

/// Relative errors of divisions and square roots, each with a sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rough {
    /// The errors, as a multiple of those that Vulkan allows.
    pub(super) times: f32,
    /// The sign of each operation's error, by its number.
    pub(super) signs: u32,
}

impl Rough {
    /// `x` off by `error`, with the sign of the operation with this number.
    fn off(self, x: f32, error: f32, operation: u32) -> f32 {
        let sign = if self.signs >> operation & 1 == 0 { 1.0 } else { -1.0 };
        (f64::from(x) * (1.0 + f64::from(sign * self.times * error))) as f32
    }

    pub(super) fn divided(self, quotient: f32, operation: u32) -> f32 {
        self.off(quotient, 3e-7, operation)
    }

    pub(super) fn root(self, x: f32, operation: u32) -> f32 {
        self.off(x.sqrt(), 5.4e-7, operation)
    }
}

/// Asserts that a function's outputs are within its bound for all these signs of errors, and that those of a device
/// `too_rough` times as inaccurate are not, for most of them.
pub(super) fn assert_bounded(
    row: &Row,
    signs: impl ExactSizeIterator<Item = u32>,
    too_rough: f32,
    one: impl Fn(Rough, &Input) -> Output,
) {
    let inputs: Vec<Input> = inputs(row.draw).into_iter().step_by(4).collect();
    let (mut largest, mut failed, patterns) = (0.0_f64, 0, signs.len());
    for signs in signs {
        let of = |times| {
            let outputs: Vec<Output> = inputs.iter().map(|input| one(Rough { times, signs }, input)).collect();
            worst(row, &inputs, &outputs, Denormals::Kept)
        };
        largest = largest.max(of(1.0).unwrap());
        failed += usize::from(of(too_rough).is_err());
    }
    eprintln!("{:<24} {largest:.3} of the bound, {failed} of {patterns} fail {too_rough} times as rough", row.name);
    assert!(2 * failed > patterns, "{}: {failed} of {patterns}", row.name);
}
