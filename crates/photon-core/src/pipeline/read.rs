//! The film on its way to the host, which is read once after a pass.

use super::Pipeline;
use crate::backend::TransportBackend;
use crate::error::Result;
use crate::film::Film;
use crate::film::forecast::ErrorModel;

impl<B: TransportBackend> Pipeline<B> {
    /// The sums over passes: those of the last forecast, if no pass came after it.
    pub(super) fn sums(&mut self) -> Result<Film> {
        match self.read.take() {
            Some(film) => Ok(film),
            None => self.on.read_film(&self.film),
        }
    }

    /// The error model of the film, which is kept until the next pass.
    pub(super) fn error_model(&mut self, share: f64) -> Result<Option<ErrorModel>> {
        let film = self.sums()?;
        let intervals = film.confidence_intervals().unwrap_or_default();
        self.read = Some(film);
        Ok(ErrorModel::new(&intervals, self.schedule, share, self.settings.kernel.second_radius_noise()))
    }
}
