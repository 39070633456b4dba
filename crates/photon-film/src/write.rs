//! Writes film files.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use photon_core::Film;
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::atomic_write;
use crate::column::Column;
use crate::error::FilmFileError;
use crate::header::{FilmInfo, Header, NAME};
use crate::npy;

/// Writes a film, atomically and durably ([`atomic_write`]). Of `info`, the key, the scene and the makers are stored, and
/// whether sums are in order; all else is that of the film.
///
/// # Errors
/// [`FilmFileError::NotStorable`] for a film with a pass that was cut short, or whose passes are not known;
/// [`FilmFileError::Write`]. A previous file is left as it was.
pub fn save(path: &Path, film: &Film, info: &FilmInfo) -> Result<(), FilmFileError> {
    check(path, film, info)?;
    let written = atomic_write::write(path, |file| write_film(file, film, info));
    written.map_err(|why| FilmFileError::write(path, why))
}

/// Writes a film as [`save`] does, to any destination, such as memory; `path` is for messages.
///
/// # Errors
/// As [`save`].
pub fn save_to(to: impl Write + Seek, film: &Film, info: &FilmInfo, path: &Path) -> Result<(), FilmFileError> {
    check(path, film, info)?;
    write_film(to, film, info).map_err(|why| FilmFileError::write(path, why))
}

/// Checks that a film can be stored.
fn check(path: &Path, film: &Film, info: &FilmInfo) -> Result<(), FilmFileError> {
    let refuse = |why| Err(FilmFileError::NotStorable { path: path.to_owned(), why });
    if film.cut {
        return refuse("its pass was cut short");
    }
    if film.contains.is_empty() || film.contains.count() != u64::from(film.passes) {
        return refuse("its passes are not known");
    }
    if info.key.size() != (film.width, film.height) || info.key.units() != film.units {
        return refuse("it has not the size and the units of its key");
    }
    Ok(())
}

fn write_film(to: impl Write + Seek, film: &Film, info: &FilmInfo) -> Result<(), atomic_write::Failure> {
    let (errors, tally) = (film.errors.is_some(), film.tally.clone());
    let info = FilmInfo { errors, clamp: film.clamp, tally, ..info.clone() };
    let mut header = Header::new(&info, &film.contains);
    let mut zip = FilmWriter::new(to, film.width, film.height);
    for column in Column::all(info.errors) {
        let mut bits = [0; 3];
        let bits = &mut bits[..column.width()];
        let mut pixels = 0..film.pixels.len();
        let is_empty = pixels.clone().all(|pixel| {
            column.get(film, pixel, bits);
            bits.iter().all(|&bits| bits == 0)
        });
        zip.array(column, is_empty, &mut header, |row| {
            for (to, pixel) in row.chunks_exact_mut(column.width()).zip(&mut pixels) {
                column.get(film, pixel, to);
            }
            Ok(())
        })?;
    }
    zip.finish(&header)
}

/// A film file while it is written.
pub(crate) struct FilmWriter<W: Write + Seek> {
    zip: ZipWriter<Abandoned<W>>,
    width: u32,
    height: u32,
}

impl<W: Write + Seek> FilmWriter<W> {
    pub(crate) fn new(file: W, width: u32, height: u32) -> Self {
        Self { zip: ZipWriter::new(Abandoned::new(file)), width, height }
    }

    /// Writes an array row by row; `fill` sets the next row. An empty array is left out, except for the hits, so that a
    /// small file cannot claim to be a large picture.
    pub(crate) fn array(
        &mut self,
        column: Column,
        is_empty: bool,
        header: &mut Header,
        mut fill: impl FnMut(&mut [u64]) -> Result<(), atomic_write::Failure>,
    ) -> Result<(), atomic_write::Failure> {
        if is_empty && column != Column::Hits {
            return Ok(());
        }
        let head = npy::header(column, self.width, self.height);
        let bytes = head.len() as u64 + npy::data_bytes(column, self.width, self.height);
        self.start(&format!("{}.npy", column.name()), bytes)?;
        self.zip.write_all(&head)?;
        let mut row = vec![0_u64; self.width as usize * column.width()];
        let mut bytes = Vec::with_capacity(row.len() * 8);
        for _ in 0..self.height {
            fill(&mut row)?;
            bytes.clear();
            bytes.extend(row.iter().flat_map(|bits| bits.to_le_bytes()));
            self.zip.write_all(&bytes)?;
        }
        header.arrays.push(column.name());
        Ok(())
    }

    /// Writes the description and the directory.
    pub(crate) fn finish(mut self, header: &impl serde::Serialize) -> Result<(), atomic_write::Failure> {
        let text = format!("{}\n", serde_json::to_string_pretty(header)?);
        self.start(NAME, text.len() as u64)?;
        self.zip.write_all(text.as_bytes())?;
        self.zip.finish()?.flush()?;
        Ok(())
    }

    fn start(&mut self, name: &str, bytes: u64) -> io::Result<()> {
        // Without a time, so that the same film is the same file.
        let options = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .last_modified_time(zip::DateTime::default())
            .large_file(bytes >= u64::from(u32::MAX));
        Ok(self.zip.start_file(name, options)?)
    }
}

/// A file that pretends to take everything once it has failed. The caller gets the error and discards the file; without this,
/// [`ZipWriter`] would try again when it is dropped, and print that it fails.
struct Abandoned<W> {
    file: W,
    failed: bool,
    position: u64,
}

impl<W> Abandoned<W> {
    fn new(file: W) -> Self {
        Self { file, failed: false, position: 0 }
    }

    /// Notes a failure, other than a call that was interrupted and is repeated.
    fn noted<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        self.failed |= result.as_ref().is_err_and(|why| why.kind() != io::ErrorKind::Interrupted);
        result
    }
}

impl<W: Write> Write for Abandoned<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = if self.failed { Ok(bytes.len()) } else { self.file.write(bytes) };
        let count = self.noted(result)?;
        self.position += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.failed {
            return Ok(());
        }
        let result = self.file.flush();
        self.noted(result)
    }
}

impl<W: Seek> Seek for Abandoned<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let pretended = match to {
            SeekFrom::Start(position) => position,
            SeekFrom::Current(by) | SeekFrom::End(by) => self.position.saturating_add_signed(by),
        };
        let result = if self.failed { Ok(pretended) } else { self.file.seek(to) };
        self.position = self.noted(result)?;
        Ok(self.position)
    }
}
