//! Colours of vertices and faces whose numbers do not lie between 0 and 1, as they should.

use crate::report::LoadReport;

/// The number that stands for white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct White {
    pub(super) value: f64,
    /// How many numbers are below 0 or above that of white.
    outside: usize,
}

impl White {
    /// Guesses it: 1, unless a number above 1 tells that 255 or 65535 is meant. Fractions up to 2 are too bright instead.
    pub(super) fn of(numbers: impl Iterator<Item = f64> + Clone) -> Self {
        let (most, is_whole) = numbers
            .clone()
            .fold((0.0_f64, true), |(most, is_whole), number| (most.max(number), is_whole && number.fract() == 0.0));
        let value = match most {
            ..=1.0 => 1.0,
            ..=2.0 if !is_whole => 1.0,
            ..=255.0 => 255.0,
            _ => 65535.0,
        };
        Self { value, outside: numbers.filter(|number| !(0.0..=value).contains(number)).count() }
    }

    /// Says what was guessed and clamped.
    pub(super) fn report(self, subject: &str, report: &mut LoadReport) {
        if self.value > 1.0 {
            let text = format!("its colours go beyond 1; they are taken as sRGB from 0 to {}", self.value);
            report.approximated(subject, text);
        }
        if self.outside > 0 {
            let text = format!("{} channels of its colours are below 0 or above {}; clamped", self.outside, self.value);
            report.approximated(subject, text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_above_one_tell_their_range() {
        for (numbers, value, outside) in [
            (&[][..], 1.0, 0),
            (&[0.0, 0.5, 1.0], 1.0, 0),
            (&[0.0, 1.25], 1.0, 1),
            (&[0.5, -0.5], 1.0, 1),
            (&[0.0, 2.0, 1.0], 255.0, 0),
            (&[127.5, 3.0], 255.0, 0),
            (&[256.0, 0.0], 65535.0, 0),
            (&[1e9, -1.0], 65535.0, 2),
        ] {
            assert_eq!(White::of(numbers.iter().copied()), White { value, outside }, "{numbers:?}");
        }
        let mut report = LoadReport::default();
        White { value: 1.0, outside: 0 }.report("mesh", &mut report);
        assert!(report.lines.is_empty());
        White { value: 255.0, outside: 2 }.report("mesh", &mut report);
        assert!(report.lines.len() == 2 && !report.is_exact());
    }
}
