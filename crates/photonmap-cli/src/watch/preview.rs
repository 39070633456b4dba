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
        if path.exists() && !path.is_file() {
            return Err(Fault::input(format!(
                "--preview {}: it is no regular file, which is replaced",
                path.display()
            )));
        }
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

#[cfg(test)]
mod tests {
    use photon_core::Units;

    use super::*;
    use crate::exposure::Exposure;
    use crate::tonemap::ToneMap;

    /// A gradient of which the right half is transparent.
    fn film() -> Film {
        let mut film = Film::new(8, 2, Units::default()).unwrap();
        film.passes = 4;
        for (i, pixel) in film.pixels.iter_mut().enumerate() {
            pixel.layers[1] = [0.1 * i as f64, 0.5, 0.02 * (i * i) as f64];
            pixel.hits = if i % 8 < 4 { 4 } else { (i % 4) as u64 };
        }
        film
    }

    /// The file that is made of a device's picture is that of the film, byte by byte, with a background and without.
    #[test]
    fn pictures_of_devices_are_written_as_films_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.png");
        let film = film();
        let written = |exposure, transparent, by_device: bool| {
            let look = Look { transparent, exposure: Exposure::Stops(exposure), tonemap: ToneMap::Agx };
            let mut preview = Preview::new(&path, look).unwrap();
            if by_device {
                preview.show_image(&film.display(&preview.display().unwrap())).unwrap();
            } else {
                preview.show(&film).unwrap();
            }
            std::fs::read(&path).unwrap()
        };
        for transparent in [false, true] {
            assert!(written(-1.0, transparent, true) == written(-1.0, transparent, false), "{transparent}");
        }
        assert!(written(-1.0, true, true) != written(-1.0, false, true), "the comparison notices an opacity");
        assert!(written(-1.0, true, true) != written(-0.5, true, true), "and an exposure");
        // An automatic exposure, and an EXR, need a film.
        let look = Look { transparent: false, exposure: Exposure::Auto, tonemap: ToneMap::Agx };
        assert!(Preview::new(&path, look).unwrap().display().is_none());
        let look = Look { exposure: Exposure::Stops(0.0), ..look };
        assert!(Preview::new(&folder.path().join("a.exr"), look).unwrap().display().is_none());
    }
}
