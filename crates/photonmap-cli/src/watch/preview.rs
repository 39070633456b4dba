//! The picture so far in a file.

use std::path::{Path, PathBuf};

use photon_core::{Display, DisplayImage, Film};

use super::Sink;
use crate::atomic_write;
use crate::command::picture::{self, Look};
use crate::fault::Fault;
use crate::png_file;

pub(super) struct Preview {
    path: PathBuf,
    look: Look,
}

impl Preview {
    pub(super) fn new(path: &Path, look: Look) -> Result<Self, Fault> {
        picture::check_name(path)?;
        atomic_write::check(path)?;
        Ok(Self { path: path.to_owned(), look })
    }
}

impl Sink for Preview {
    fn display(&self) -> Option<Display> {
        if picture::is_exr(&self.path) { None } else { self.look.display() }
    }

    fn show_image(&mut self, image: &DisplayImage) -> Result<Option<String>, String> {
        png_file::write_image(&self.path, image, self.look.transparent)
            .map(|()| None)
            .map_err(|fault| fault.to_string())
    }

    fn show(&mut self, film: &Film) -> Result<Option<String>, String> {
        let attributes = [("photon:passes".to_owned(), film.passes.to_string())];
        picture::write_quietly(&self.path, film, self.look, &attributes)
            .map(|_stops| None)
            .map_err(|fault| fault.to_string())
    }
}
