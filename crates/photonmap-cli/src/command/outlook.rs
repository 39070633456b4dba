//! The error of a film file, and how many more passes a target takes.

use std::path::Path;

use clap::Args;

use crate::fault::Fault;
use crate::forecast_text::error_line;
use crate::stdout;

/// The error to reach.
#[derive(Clone, Debug, Args)]
pub struct TargetArgs {
    /// Also print how many more passes this relative error takes, such as 0.05; 0 if it is reached. The film needs --errors.
    #[arg(long, value_name = "ERROR")]
    target_error: Option<f64>,
    /// The share of the pixels that have to reach it, of those with an error estimate.
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, requires = "target_error")]
    share: f64,
}

impl TargetArgs {
    /// Checks the target against a film of the settings that the films have.
    ///
    /// # Errors
    /// [`Fault::Input`] for a target out of range, a film without error statistics, or a file that is no film.
    pub(super) fn check(&self, path: &Path) -> Result<(), Fault> {
        let Some(target) = self.target_error else { return Ok(()) };
        let target = photon_film::read_info(path)?.key.error_target(target, self.share);
        target.map(drop).map_err(|error| Fault::input(format!("{}: {error}", path.display())))
    }

    /// Prints the error of the film, and on standard output the number of further passes if there is a target: an upper
    /// estimate, rounded up to whole blocks.
    ///
    /// # Errors
    /// [`Fault::Input`] for a target out of range or a film without error statistics; [`Fault::Failure`] if no pixel has an
    /// error estimate yet, or no number of passes is enough.
    pub(super) fn print(&self, path: &Path) -> Result<(), Fault> {
        let Some(target) = self.target_error else { return Ok(()) };
        let named = |why: &dyn std::fmt::Display| format!("{}: {why}", path.display());
        let (film, info) = photon_film::load(path)?;
        let target = info.key.error_target(target, self.share).map_err(|error| Fault::input(named(&error)))?;
        let Some(forecast) = target.forecast(&film, u32::MAX, 0.0) else {
            return Err(Fault::failure(named(&"no pixel has an error estimate yet: render more passes")));
        };
        say!("{}", error_line(&path.display().to_string(), &forecast));
        let Some(needed) = forecast.passes_needed else {
            return Err(Fault::failure(named(&"the target is out of reach of any number of passes")));
        };
        let more = needed.saturating_sub(film.passes).checked_next_multiple_of(info.key.grain());
        stdout::write(format!("{}\n", more.unwrap_or(u32::MAX)).as_bytes())
    }
}
