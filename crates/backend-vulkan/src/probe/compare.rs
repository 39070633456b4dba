//! Distances between outputs, and their bounds.

use std::fmt;

use super::draw::input;
use super::table::Row;
use super::{Input, Output, run};
use crate::{Vulkan, shaders};

/// How far each output word may be from the twin's.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bound {
    /// Integers: equal.
    Words,
    /// Floats: equal bits, except that the sign of 0 is ignored. See [`Denormals`].
    Bits,
    /// As `Bits`, for a function that amplifies flushed inputs, by this factor for an input.
    BitsMagnified(fn(&Input) -> f64),
    /// Floats: maximum absolute difference.
    Within(f64),
    /// Floats: maximum difference relative to the twin's value.
    Relative(f64),
    /// Floats: maximum difference, times a named condition number of the input.
    Conditioned(f64, &'static str, fn(&Input) -> f64),
    /// Floats: maximum difference relative to the twin's value, times a named condition number of the input.
    Scaled(f64, &'static str, fn(&Input) -> f64),
    /// Two packed 16-bit numbers: at most one step apart.
    Step,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words => write!(f, "the same"),
            Self::Bits | Self::BitsMagnified(_) => write!(f, "the same bits"),
            Self::Within(most) => write!(f, "{most:e}"),
            Self::Relative(most) => write!(f, "{most:e} of the value"),
            Self::Conditioned(most, by, _) => write!(f, "{most:e} times {by}"),
            Self::Scaled(most, by, _) => write!(f, "{most:e} of the value times {by}"),
            Self::Step => write!(f, "one step"),
        }
    }
}

/// How a device handles floats below 2⁻¹²⁶, f32's smallest normal number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Denormals {
    /// They are preserved. Bounds hold as stated.
    Kept,
    /// The device may flush any of them to 0: inputs, results, and intermediate values. Bounds hold relative to
    /// the twin's value for the inputs or for the inputs with denormals flushed, and [`FLUSHED`] is added to
    /// bounds of floats.
    Flushed,
}

impl Denormals {
    /// As the device reports; if it guarantees nothing, as a test product shows.
    pub(super) fn of(on: &mut Vulkan) -> photon_core::Result<Self> {
        if on.limits().keeps_denormals {
            return Ok(Self::Kept);
        }
        // Function 2 ends with the scalar product.
        let tiny = input([1e-30, 1e-40, 0.0, 0.0], [1e-10, 0.0, 0.0, 0.0], [0.0; 4]);
        let outputs = run(on, &shaders::PROBE_MATH, 2, &[tiny])?;
        Ok(if f32::from_bits(outputs[0][3]) > 0.0 { Self::Kept } else { Self::Flushed })
    }
}

/// Largest change of a result by flushing: a scalar product has three products and two sums, and no function
/// that is compared by bits has more operations. A function that amplifies denormals states its factor.
const FLUSHED: f64 = 5.0 * f32::MIN_POSITIVE as f64;

/// The input with 0 for each float below the normal range; `None` if it has none. Small integers are not
/// changed.
fn flushed(input: &Input) -> Option<Input> {
    let below = |word: u32| (0x1_0000..0x80_0000).contains(&(word & 0x7FFF_FFFF));
    let other = Input(input.0.map(|word| if below(word) { word & 0x8000_0000 } else { word }));
    (other.0 != input.0).then_some(other)
}

/// The largest difference as a fraction of the bound; 0 for integers and bits.
///
/// # Errors
/// Names the function, and the input that exceeds the bound the most.
pub(super) fn worst(row: &Row, inputs: &[Input], outputs: &[Output], denormals: Denormals) -> Result<f64, String> {
    let mut worst = 0.0;
    let mut culprit = None;
    for (input, output) in inputs.iter().zip(outputs) {
        let twin = (row.twin)(input);
        let other = if denormals == Denormals::Flushed { flushed(input) } else { None };
        let other = other.map_or(twin, |input| (row.twin)(&input));
        for ((&ours, &theirs), &other) in output.iter().zip(&twin).zip(&other) {
            let share = [theirs, other].map(|theirs| share(row.bound, denormals, input, ours, theirs));
            let share = share[0].min(share[1]);
            if share > worst {
                worst = share;
                culprit = Some((input, output, twin));
            }
        }
    }
    match culprit {
        Some((input, output, twin)) if worst > 1.0 => {
            let floats = |words: &[u32]| words.iter().map(|&word| f32::from_bits(word)).collect::<Vec<_>>();
            Err(format!(
                "{}: {worst:.3} times the bound, {}\n  input  {:x?} {:?}\n  GLSL   {output:x?} {:?}\n  Rust   {twin:x?} {:?}",
                row.name,
                row.bound,
                input.0,
                floats(&input.0),
                floats(output),
                floats(&twin)
            ))
        }
        _ => Ok(worst),
    }
}

/// The difference of two words as a fraction of the bound; above 1 the bound is exceeded.
fn share(bound: Bound, denormals: Denormals, input: &Input, ours: u32, theirs: u32) -> f64 {
    let verdict = |good: bool| if good { 0.0 } else { f64::INFINITY };
    if ours == theirs {
        return 0.0;
    }
    let (a, b) = (f64::from(f32::from_bits(ours)), f64::from(f32::from_bits(theirs)));
    // Infinity and NaN are equal only to themselves; the two zeros are equal.
    let lost = if denormals == Denormals::Flushed { FLUSHED } else { 0.0 };
    let apart = |most: f64| match (a - b).abs() {
        distance if distance > 0.0 && b.is_finite() => distance / (most + lost),
        distance => verdict(distance <= 0.0),
    };
    match bound {
        Bound::Words => f64::INFINITY,
        Bound::Bits => verdict((a - b).abs() <= lost),
        Bound::BitsMagnified(times) => verdict((a - b).abs() <= lost * times(input)),
        Bound::Within(most) => apart(most),
        Bound::Relative(most) => apart(most * b.abs()),
        Bound::Conditioned(most, _, condition) => apart(most * condition(input)),
        Bound::Scaled(most, _, condition) => apart(most * condition(input) * b.abs()),
        Bound::Step => {
            let near = |shift: u32| ((ours >> shift) as u16 as i16).abs_diff((theirs >> shift) as u16 as i16) <= 1;
            verdict(near(0) && near(16))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bound_can_be_exceeded() {
        let at = |bound, a: f32, b: f32| share(bound, Denormals::Kept, &Input::default(), a.to_bits(), b.to_bits());
        let next = f32::from_bits(1.0_f32.to_bits() + 1);
        assert!(at(Bound::Words, 0.0, -0.0) > 1.0 && at(Bound::Words, 2.0, 2.0) <= 0.0);
        assert!(at(Bound::Bits, 1.0, next) > 1.0 && at(Bound::BitsMagnified(|_| 1e30), 1.0, next) > 1.0);
        assert!(at(Bound::Bits, 0.0, -0.0) <= 1.0);
        assert!(at(Bound::Bits, 1e-40, 0.0) > 1.0 && at(Bound::Relative(1e-6), 1e-40, 0.0) > 1.0);
        assert!(at(Bound::Bits, f32::NAN, 0.0) > 1.0 && at(Bound::Bits, f32::INFINITY, 0.0) > 1.0);
        let ten = |_: &Input| 10.0;
        let conditioned = [Bound::Conditioned(1e-7, "ten", ten), Bound::Scaled(1e-7, "ten", ten)];
        for bound in [Bound::Within(1e-6), Bound::Relative(1e-6)].into_iter().chain(conditioned) {
            assert!(at(bound, 1.0, next) <= 1.0 && at(bound, 1.0, 1.000_01) > 1.0);
            assert!(at(bound, f32::INFINITY, 1.0) > 1.0 && at(bound, 1.0, f32::NAN) > 1.0);
        }
        assert!(at(Bound::Relative(1e-6), 1e-20, 0.0) > 1.0 && at(conditioned[1], 2e-6, 1e-6) > 1.0);
        let step = |a, b| share(Bound::Step, Denormals::Kept, &Input::default(), a, b);
        assert!(step(0x0001_FFFF, 0x0002_0000) <= 1.0);
        assert!(step(0, 2) > 1.0 && step(0x0002_0000, 0) > 1.0);
    }

    #[test]
    fn what_is_flushed_is_small() {
        let at = |bound, a: f32, b: f32| share(bound, Denormals::Flushed, &Input::default(), a.to_bits(), b.to_bits());
        let least = f32::MIN_POSITIVE;
        for bound in [Bound::Bits, Bound::Within(0.0), Bound::Relative(1e-7)] {
            assert!(at(bound, 1e-40, 0.0) <= 1.0 && at(bound, 9.0 * least, 4.5 * least) <= 1.0);
            assert!(at(bound, 9.0 * least, 3.5 * least) > 1.0 && at(bound, 1.0, 1.000_001) > 1.0);
            assert!(at(bound, f32::NAN, 0.0) > 1.0 && at(bound, f32::INFINITY, 0.0) > 1.0);
        }
        let ten = Bound::BitsMagnified(|_| 10.0);
        assert!(at(ten, 45.0 * least, 0.0) <= 1.0 && at(ten, 55.0 * least, 0.0) > 1.0);
        assert!(at(Bound::Words, 1e-40, 0.0) > 1.0, "integers are never flushed");
        let some = input([1e-40, -1e-40, least, 1.0], [0.0; 4], [0.0; 4]);
        assert_eq!(flushed(&some).map(|input| input.0), Some(input([0.0, -0.0, least, 1.0], [0.0; 4], [0.0; 4]).0));
        assert!(flushed(&Input([3; 12])).is_none());
    }
}
