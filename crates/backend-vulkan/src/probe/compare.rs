//! How far outputs are apart, and how far they may be.

use std::fmt;

use super::table::Row;
use super::{Input, Output};

/// How far a function may be from its twin, word by word.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bound {
    /// Integers: the same.
    Words,
    /// Floats: the same bits; but what is below the normal range may be 0, and 0 has no sign.
    Bits,
    /// Floats: so far apart.
    Within(f64),
    /// Floats: so far apart, as a share of the twin's.
    Relative(f64),
    /// Floats: so far apart, times a condition number of the input, which has a name.
    Conditioned(f64, &'static str, fn(&Input) -> f64),
    /// Two packed 16-bit numbers: one step apart.
    Step,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words => write!(f, "the same"),
            Self::Bits => write!(f, "the same bits"),
            Self::Within(most) => write!(f, "{most:e}"),
            Self::Relative(most) => write!(f, "{most:e} of the value"),
            Self::Conditioned(most, by, _) => write!(f, "{most:e} times {by}"),
            Self::Step => write!(f, "one step"),
        }
    }
}

/// The worst distance as a share of the bound; integers and bits give 0.
///
/// # Errors
/// The function, and the input that is farthest beyond the bound.
pub(super) fn worst(row: &Row, inputs: &[Input], outputs: &[Output]) -> Result<f64, String> {
    let mut worst = 0.0;
    let mut culprit = None;
    for (input, output) in inputs.iter().zip(outputs) {
        let twin = (row.twin)(input);
        for (&ours, &theirs) in output.iter().zip(&twin) {
            let share = share(row.bound, input, ours, theirs);
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

/// The distance of two words as a share of the bound: above 1 is beyond it.
fn share(bound: Bound, input: &Input, ours: u32, theirs: u32) -> f64 {
    let verdict = |good: bool| if good { 0.0 } else { f64::INFINITY };
    if ours == theirs {
        return 0.0;
    }
    let (a, b) = (f64::from(f32::from_bits(ours)), f64::from(f32::from_bits(theirs)));
    // Neither infinity nor NaN is near anything but itself; the two zeros are.
    let apart = |most: f64| match (a - b).abs() {
        distance if distance > 0.0 && b.is_finite() => distance / most,
        distance => verdict(distance <= 0.0),
    };
    match bound {
        Bound::Words => f64::INFINITY,
        Bound::Bits => {
            let small = |x: f64| x.abs() < f64::from(f32::MIN_POSITIVE);
            verdict(small(a) && small(b))
        }
        Bound::Within(most) => apart(most),
        Bound::Relative(most) => apart(most * b.abs()),
        Bound::Conditioned(most, _, condition) => apart(most * condition(input)),
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
        let at = |bound, a: f32, b: f32| share(bound, &Input::default(), a.to_bits(), b.to_bits());
        let next = f32::from_bits(1.0_f32.to_bits() + 1);
        assert!(at(Bound::Words, 0.0, -0.0) > 1.0 && at(Bound::Words, 2.0, 2.0) <= 0.0);
        assert!(at(Bound::Bits, 1.0, next) > 1.0);
        assert!(at(Bound::Bits, 0.0, -0.0) <= 1.0 && at(Bound::Bits, 1e-40, 0.0) <= 1.0);
        assert!(at(Bound::Bits, f32::NAN, 0.0) > 1.0);
        for bound in [Bound::Within(1e-6), Bound::Relative(1e-6), Bound::Conditioned(1e-7, "ten", |_| 10.0)] {
            assert!(at(bound, 1.0, next) <= 1.0 && at(bound, 1.0, 1.000_01) > 1.0);
            assert!(at(bound, f32::INFINITY, 1.0) > 1.0 && at(bound, 1.0, f32::NAN) > 1.0);
        }
        assert!(at(Bound::Relative(1e-6), 1e-20, 0.0) > 1.0);
        let step = |a, b| share(Bound::Step, &Input::default(), a, b);
        assert!(step(0x0001_FFFF, 0x0002_0000) <= 1.0);
        assert!(step(0, 2) > 1.0 && step(0x0002_0000, 0) > 1.0);
    }
}
