//! Pixels of a film as numbers of 64 bits, to be sent between processes and added there.

use std::ops::Range;

use photon_core::Film;

use crate::column::Column;

/// The sums of film pixels as `u64` words: all sums of the first pixel, then those of the second, and so on. The layout is
/// that of this version of the library: for messages between processes of one program, not for files.
#[derive(Clone, Debug)]
pub struct FilmWords {
    columns: Vec<Column>,
    per_pixel: usize,
}

impl FilmWords {
    /// The words of films with error statistics, or without.
    #[must_use]
    pub fn new(errors: bool) -> Self {
        let columns = Column::all(errors);
        let per_pixel = columns.iter().map(|column| column.width()).sum();
        Self { columns, per_pixel }
    }

    /// Words per pixel.
    #[must_use]
    pub fn per_pixel(&self) -> usize {
        self.per_pixel
    }

    /// The words of a range of pixels.
    ///
    /// # Panics
    /// If the range leaves the film.
    #[must_use]
    pub fn of(&self, film: &Film, pixels: Range<usize>) -> Vec<u64> {
        let mut words = vec![0; pixels.len() * self.per_pixel];
        for (pixel, words) in pixels.zip(words.chunks_exact_mut(self.per_pixel)) {
            self.each(words, |column, words| column.get(film, pixel, words));
        }
        words
    }

    /// Replaces the sums of a range of pixels.
    ///
    /// # Panics
    /// If the range leaves the film, or `words` has another length.
    pub fn set(&self, film: &mut Film, pixels: Range<usize>, words: &[u64]) {
        assert_eq!(words.len(), pixels.len() * self.per_pixel, "words of pixels");
        for (pixel, words) in pixels.zip(words.chunks_exact(self.per_pixel)) {
            let mut rest = words;
            for column in &self.columns {
                let (these, others) = rest.split_at(column.width());
                column.set(film, pixel, these);
                rest = others;
            }
        }
    }

    /// Adds words to the sums of the same pixels, as [`Film::merge`] does, bit by bit.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn add(&self, sums: &mut [u64], words: &[u64]) {
        assert_eq!(sums.len(), words.len(), "words of the same pixels");
        for (sums, words) in sums.chunks_exact_mut(self.per_pixel).zip(words.chunks_exact(self.per_pixel)) {
            let mut words = words.iter();
            self.each(sums, |column, sums| {
                sums.iter_mut().zip(&mut words).for_each(|(sum, &word)| *sum = column.add(*sum, word));
            });
        }
    }

    /// Calls `visit` with each column and its words of a pixel.
    fn each(&self, words: &mut [u64], mut visit: impl FnMut(Column, &mut [u64])) {
        let mut rest = words;
        for &column in &self.columns {
            let (these, others) = rest.split_at_mut(column.width());
            visit(column, these);
            rest = others;
        }
    }
}
