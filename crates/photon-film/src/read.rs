//! Reads film files. Nothing in a file is relied on before it was checked.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use photon_core::{FileKind, Film};
use zip::ZipArchive;
use zip::result::ZipError;

use crate::column::Column;
use crate::error::FilmFileError;
use crate::header::{FORMAT, FilmInfo, Header, NAME, empty_film};
use crate::npy;

/// Largest description, bytes.
const MAX_DESCRIPTION: u64 = 1 << 24;

/// Reads the description of a film file; the pixels are not read.
///
/// # Errors
/// [`FilmFileError::Read`], [`FilmFileError::Damaged`], [`FilmFileError::Newer`].
pub fn read_info(path: &Path) -> Result<FilmInfo, FilmFileError> {
    FilmReader::open(path).map(|reader| reader.info)
}

/// Reads a film file.
///
/// # Errors
/// As [`read_info`]; [`FilmFileError::Film`] if there is not enough memory.
pub fn load(path: &Path) -> Result<(Film, FilmInfo), FilmFileError> {
    film(FilmReader::open(path)?)
}

/// Reads a film file from a source of `length` bytes; `path` is for messages.
///
/// # Errors
/// As [`load`].
pub fn load_from(source: impl Read + Seek, length: u64, path: &Path) -> Result<(Film, FilmInfo), FilmFileError> {
    film(FilmReader::new(source, length, path)?)
}

fn film(mut reader: FilmReader<impl Read + Seek>) -> Result<(Film, FilmInfo), FilmFileError> {
    let path = reader.path.clone();
    let path = path.as_path();
    let mut film = empty_film(&reader.info).map_err(|source| FilmFileError::film(path, source))?;
    for column in reader.arrays.clone() {
        let mut pixel = 0;
        reader.array(column, |row| {
            for bits in row.chunks_exact(column.width()) {
                column.set(&mut film, pixel, bits);
                pixel += 1;
            }
        })?;
    }
    Ok((film, reader.info))
}

/// An open film file.
pub(crate) struct FilmReader<R> {
    path: PathBuf,
    zip: ZipArchive<R>,
    pub(crate) info: FilmInfo,
    /// The arrays that are not 0 everywhere.
    pub(crate) arrays: Vec<Column>,
}

impl FilmReader<BufReader<File>> {
    /// Opens a file.
    pub(crate) fn open(path: &Path) -> Result<Self, FilmFileError> {
        let open = || -> std::io::Result<_> {
            // Opening a pipe would wait for its writer.
            let kind = std::fs::metadata(path)?;
            if !kind.is_file() {
                let what = if kind.is_dir() { "it is a folder" } else { "it is not a regular file" };
                return Err(std::io::Error::other(what));
            }
            let mut file = File::open(path)?;
            let length = file.metadata()?.len();
            let mut start = Vec::new();
            file.by_ref().take(FileKind::START as u64).read_to_end(&mut start)?;
            file.rewind()?;
            Ok((file, length, FileKind::other_than(&["zip"], &start)))
        };
        let (file, length, kind) = open().map_err(|source| FilmFileError::Read { path: path.to_owned(), source })?;
        if let Some(kind) = kind {
            return Err(FilmFileError::OtherKind { path: path.to_owned(), kind });
        }
        Self::new(BufReader::new(file), length, path)
    }
}

impl<R: Read + Seek> FilmReader<R> {
    /// Checks the description of a film, the names and the sizes of its arrays.
    fn new(source: R, length: u64, path: &Path) -> Result<Self, FilmFileError> {
        let damaged = |why: &dyn ToString| FilmFileError::damaged(path, why.to_string());
        let mut zip = ZipArchive::new(source).map_err(|error| zip_error(path, error))?;
        let mut text = Vec::new();
        {
            let mut file = zip.by_name(NAME).map_err(|error| zip_error(path, error))?;
            if file.size() > MAX_DESCRIPTION {
                return Err(damaged(&format!("{NAME} has {} bytes", file.size())));
            }
            file.read_to_end(&mut text).map_err(|error| damaged(&format!("{NAME}: {error}")))?;
        }
        let json: serde_json::Value =
            serde_json::from_slice(&text).map_err(|error| damaged(&format!("{NAME}: {error}")))?;
        let found = json["format"].as_u64().ok_or_else(|| damaged(&format!("{NAME} has no format")))?;
        if found > u64::from(FORMAT) {
            return Err(FilmFileError::Newer { path: path.to_owned(), found, known: FORMAT.into() });
        }
        let header: Header = serde_json::from_value(json).map_err(|error| damaged(&format!("{NAME}: {error}")))?;
        let info = header.info().map_err(|why| damaged(&why))?;
        let all = Column::all(info.errors);
        let arrays: Vec<Column> = all.into_iter().filter(|column| header.arrays.contains(&column.name())).collect();
        if arrays.len() != header.arrays.len() || zip.len() != arrays.len() + 1 {
            return Err(damaged(&"its arrays are not those that it lists"));
        }
        if !arrays.contains(&Column::Hits) {
            return Err(damaged(&"it has no array hits"));
        }
        let mut reader = Self { path: path.to_owned(), zip, info, arrays };
        reader.check_sizes(length)?;
        Ok(reader)
    }

    /// Checks the size of every array against the picture's and the file's, before memory is allocated for them.
    fn check_sizes(&mut self, length: u64) -> Result<(), FilmFileError> {
        let (width, height) = self.info.key.size();
        let mut total = 0_u64;
        for &column in &self.arrays {
            let expected = npy::header(column, width, height).len() as u64 + npy::data_bytes(column, width, height);
            let name = format!("{}.npy", column.name());
            let file = self.zip.by_name(&name).map_err(|error| zip_error(&self.path, error))?;
            total = total.saturating_add(expected);
            let stored = file.compression() == zip::CompressionMethod::Stored;
            if !stored || file.size() != expected || file.compressed_size() != expected || total > length {
                let why =
                    format!("{name} has {} bytes, but a picture of {width}x{height} needs {expected}", file.size());
                return Err(FilmFileError::damaged(&self.path, why));
            }
        }
        Ok(())
    }

    /// Reads an array, row by row; the bits of each row are given to `take`. After the last row, the checksum is compared.
    pub(crate) fn array(&mut self, column: Column, mut take: impl FnMut(&[u64])) -> Result<(), FilmFileError> {
        let (width, height) = self.info.key.size();
        let name = format!("{}.npy", column.name());
        let mut file = self.zip.by_name(&name).map_err(|error| zip_error(&self.path, error))?;
        let damaged = |why: &dyn ToString| FilmFileError::damaged(&self.path, format!("{name}: {}", why.to_string()));
        let expected = npy::header(column, width, height);
        let mut head = vec![0; expected.len()];
        file.read_exact(&mut head).map_err(|error| damaged(&error))?;
        if head != expected {
            return Err(damaged(&"has another type or shape"));
        }
        let mut bytes = vec![0; width as usize * column.width() * 8];
        let mut row = vec![0_u64; width as usize * column.width()];
        let paths = self.info.contains.count().saturating_mul(u64::from(self.info.key.camera_samples()));
        for y in 0..height {
            file.read_exact(&mut bytes).map_err(|error| damaged(&error))?;
            let (words, _) = bytes.as_chunks::<8>();
            row.iter_mut().zip(words).for_each(|(bits, word)| *bits = u64::from_le_bytes(*word));
            // Checksums are right where a broken computer wrote wrong sums.
            if let Some((at, why)) =
                row.iter().enumerate().find_map(|(at, &bits)| Some((at, column.fault(bits, paths)?)))
            {
                let x = at / column.width();
                return Err(damaged(&format!("the sum of the pixel in column {x} and row {y} {why}")));
            }
            take(&row);
        }
        // The checksum is compared at the end of the data.
        match file.read(&mut [0]) {
            Ok(0) => Ok(()),
            Ok(_) => Err(damaged(&"has more data than its shape")),
            Err(error) => Err(damaged(&error)),
        }
    }
}

fn zip_error(path: &Path, error: ZipError) -> FilmFileError {
    FilmFileError::damaged(path, error)
}
