//! Errors while settings are chosen.

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

/// The result of the attempt in which final gathering may be tried, or if that fails, of one without it and a warning.
///
/// # Errors
/// Those of the last attempt.
pub(super) fn with_or_without_gathering<T>(
    mut attempt: impl FnMut(bool) -> Result<T, ChoiceError>,
) -> Result<(T, Option<String>), Fault> {
    match attempt(true) {
        Err(ChoiceError::FinalGathering(fault)) => {
            let warning = format!("trying final gathering failed: {fault}; settings are chosen without it");
            say!("warning: {warning}");
            attempt(false).map(|made| (made, Some(warning))).map_err(ChoiceError::into_fault)
        }
        other => other.map(|made| (made, None)).map_err(ChoiceError::into_fault),
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
        let warning = "trying final gathering failed: 1; settings are chosen without it".to_owned();
        assert_eq!(attempts(ChoiceError::FinalGathering, true), (vec![true, false], Ok((7, Some(warning)))));
        assert_eq!(attempts(ChoiceError::FinalGathering, false), (vec![true, false], Err("2".to_owned())));
        assert_eq!(attempts(ChoiceError::Other, true), (vec![true], Err("1".to_owned())));
    }
}
