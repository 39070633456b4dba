//! Errors while settings are chosen.
#![expect(clippy::print_stderr, reason = "what was not tried is told on standard error")]

use crate::fault::Fault;

/// Why a renderer was not made, or settings were not chosen.
#[derive(Debug)]
pub(super) enum ChoiceError {
    /// Final gathering failed, which was tried since it could be better. The render is possible without it.
    FinalGathering(Fault),
    /// Anything else.
    Other(Fault),
}

impl ChoiceError {
    pub(super) fn into_fault(self) -> Fault {
        match self {
            Self::FinalGathering(fault) | Self::Other(fault) => fault,
        }
    }
}

impl<E: Into<Fault>> From<E> for ChoiceError {
    fn from(error: E) -> Self {
        Self::Other(error.into())
    }
}

/// The result of the attempt in which final gathering may be tried; of one without it, if that fails, which is told.
///
/// # Errors
/// Those of the last attempt.
pub(super) fn with_or_without_gathering<T>(
    mut attempt: impl FnMut(bool) -> Result<T, ChoiceError>,
) -> Result<T, Fault> {
    match attempt(true) {
        Err(ChoiceError::FinalGathering(fault)) => {
            eprintln!("warning: final gathering was not tried: {fault}");
            attempt(false).map_err(ChoiceError::into_fault)
        }
        other => other.map_err(ChoiceError::into_fault),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_trial_does_not_end_the_render() {
        let attempts = |error: fn(Fault) -> ChoiceError, without: bool| {
            let mut made = Vec::new();
            let result = with_or_without_gathering(|may_gather| {
                made.push(may_gather);
                if may_gather || !without { Err(error(Fault::failure(made.len()))) } else { Ok(7) }
            });
            (made, result.map_err(|fault| fault.to_string()))
        };
        assert_eq!(attempts(ChoiceError::FinalGathering, true), (vec![true, false], Ok(7)));
        assert_eq!(attempts(ChoiceError::FinalGathering, false), (vec![true, false], Err("2".to_owned())));
        assert_eq!(attempts(ChoiceError::Other, true), (vec![true], Err("1".to_owned())));
    }
}
