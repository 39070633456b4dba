//! Merges film files, array by array, so that no whole film is in memory.

use std::path::{Path, PathBuf};

use crate::atomic_write;
use crate::column::Column;
use crate::error::FilmFileError;
use crate::header::{FilmInfo, Header};
use crate::read::FilmReader;
use crate::write::FilmWriter;

/// Adds the passes of all `films` and writes them to `out`, which may be one of them. Films are added in order of seed and
/// first pass, whatever the order in which they are named.
///
/// If the first has whole blocks, each of the others is the next block ([`photon_core::Blocks`]), and all are of one backend, the
/// sums are bitwise those of a single render, which [`FilmInfo::in_order`] of the result says; otherwise they may differ by
/// rounding. Gaps between the passes are allowed.
///
/// Memory: one array, at most 24 bytes for each pixel, for any number of films.
///
/// # Errors
/// [`FilmFileError::OtherKey`] and [`FilmFileError::PassTwice`] name the film that does not fit; those of
/// [`crate::load`] and [`crate::save`]. A previous file `out` is left as it was.
pub fn merge(out: &Path, films: &[PathBuf]) -> Result<FilmInfo, FilmFileError> {
    let mut films = films
        .iter()
        .map(|path| Ok((path.as_path(), FilmReader::open(path)?.info)))
        .collect::<Result<Vec<_>, FilmFileError>>()?;
    films.sort_by_key(|(_, info)| info.contains.ranges().next().map(|(seed, range)| (seed, range.start)));
    let info = checked(&films)?;
    let (width, height) = info.key.size();
    let mut header = Header::new(&info, &info.contains);
    // The error of a film that is read while the file is written.
    let mut cause = None;
    let written = atomic_write::write(out, |file| {
        let mut writer = FilmWriter::new(file, width, height);
        for column in Column::all(info.errors) {
            let sums = match sum(column, &films) {
                Ok(sums) => sums,
                Err(error) => {
                    let text = error.to_string();
                    cause = Some(error);
                    return Err(text.into());
                }
            };
            let mut rows = sums.chunks_exact((width as usize * column.width()).max(1));
            let is_empty = sums.iter().all(|&bits| bits == 0);
            writer.array(column, is_empty, &mut header, |row| {
                rows.next().into_iter().for_each(|sums| row.copy_from_slice(sums));
                Ok(())
            })?;
        }
        writer.finish(&header)
    });
    match (written, cause) {
        (Ok(()), _) => Ok(info),
        (Err(_), Some(cause)) => Err(cause),
        (Err(why), None) => Err(FilmFileError::write(out, why)),
    }
}

/// The description of the sum of films, which are sorted.
fn checked(films: &[(&Path, FilmInfo)]) -> Result<FilmInfo, FilmFileError> {
    let [(_, first), others @ ..] = films else { return Err(FilmFileError::NoFilms) };
    let mut all = first.clone();
    for (path, info) in others {
        info.check(&all.key, &all.scene, path)?;
        if (info.errors, info.clamp) != (all.errors, all.clamp) {
            return Err(FilmFileError::damaged(path, "its arrays are not those of its settings"));
        }
        if let Some((seed, passes)) = all.contains.overlap(&info.contains) {
            return Err(FilmFileError::PassTwice { path: (*path).to_owned(), seed, passes });
        }
        let ends = all.contains.ranges().next().map(|(seed, range)| (seed, range.end));
        let begins = info.contains.ranges().next().map(|(seed, range)| (seed, range.start));
        let is_next_block = ends == begins && info.contains.count() == u64::from(all.key.grain());
        let same_backend =
            info.makers.iter().all(|maker| all.makers.iter().all(|known| known.backend == maker.backend));
        all.in_order &= info.in_order && is_next_block && same_backend;
        all.contains.merge(&info.contains).map_err(|source| FilmFileError::film(path, source))?;
        info.makers.iter().for_each(|maker| all.add_maker(maker));
        all.tally.merge(&info.tally);
    }
    if all.contains.count() > u64::from(u32::MAX) {
        return Err(FilmFileError::damaged(films[films.len() - 1].0, "with it there are more than 2^32 - 1 passes"));
    }
    Ok(all)
}

/// The bits of the sums of a column, film after film.
fn sum(column: Column, films: &[(&Path, FilmInfo)]) -> Result<Vec<u64>, FilmFileError> {
    let (width, height) = films[0].1.key.size();
    let mut sums = vec![0_u64; width as usize * height as usize * column.width()];
    for (path, info) in films {
        let mut reader = FilmReader::open(path)?;
        if reader.info != *info {
            return Err(FilmFileError::damaged(path, "it has changed while it was merged"));
        }
        if !reader.arrays.contains(&column) {
            continue;
        }
        let mut rest = sums.as_mut_slice();
        reader.array(column, |row| {
            let (sums, after) = std::mem::take(&mut rest).split_at_mut(row.len());
            sums.iter_mut().zip(row).for_each(|(sum, &bits)| *sum = column.add(*sum, bits));
            rest = after;
        })?;
    }
    Ok(sums)
}
