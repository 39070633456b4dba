//! Sums of films that are distributed over ranks.

use std::ops::Range;

use mpi::datatype::{Partition, PartitionMut};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Root, Source};
use photon_core::{Film, FilmTally, PassSet};
use photon_film::{FilmWords, tally_from_text, tally_to_text};

/// Words that a rank sends and receives at a time, at most: MPI counts with 31 bits, and buffers should stay small.
const WORDS_AT_A_TIME: usize = 1 << 25;

/// The sums over blocks of this rank's share of the pixels.
pub struct Sums<'a> {
    world: &'a SimpleCommunicator,
    layout: FilmWords,
    pixels: usize,
    /// Of the pixels of this rank; empty before the first block.
    words: Vec<u64>,
    portions: usize,
    /// What the photons of the blocks of this rank did; on rank 0 also those of a film that is continued.
    tally: FilmTally,
}

impl<'a> Sums<'a> {
    /// No sums yet, for films of `pixels` pixels, with error statistics or without.
    #[must_use]
    pub fn new(world: &'a SimpleCommunicator, pixels: usize, errors: bool) -> Self {
        Self::in_portions(world, pixels, errors, WORDS_AT_A_TIME)
    }

    /// As [`Sums::new`], with messages of at most about this many words.
    #[must_use]
    pub fn in_portions(world: &'a SimpleCommunicator, pixels: usize, errors: bool, words: usize) -> Self {
        let layout = FilmWords::new(errors);
        let portions = (pixels * layout.per_pixel()).div_ceil(words).max(1);
        Self { world, layout, pixels, words: Vec::new(), portions, tally: FilmTally::default() }
    }

    /// The part of a rank's pixels in a portion.
    fn part(&self, rank: usize, portion: usize) -> Range<usize> {
        let ranks = self.world.size() as usize;
        let share = |whole: Range<usize>, index: usize, of: usize| {
            let at = |index| whole.start + whole.len() * index / of;
            at(index)..at(index + 1)
        };
        share(share(0..self.pixels, rank, ranks), portion, self.portions)
    }

    /// Adds the blocks that the first `blocks` ranks have rendered, in order of rank. All ranks call this together; `film` is
    /// the block of this rank, if it is one of them.
    ///
    /// # Panics
    /// If the film is not of the size that was given, or is missing.
    pub fn add(&mut self, film: Option<&Film>, blocks: usize) {
        let (ranks, rank) = (self.world.size() as usize, self.world.rank() as usize);
        if let Some(film) = film.filter(|_| rank < blocks) {
            self.tally.merge(&film.tally);
        }
        let first = self.words.is_empty();
        let mut sums = std::mem::take(&mut self.words);
        for portion in 0..self.portions {
            let words_of = |range: &Range<usize>| range.len() * self.layout.per_pixel();
            let mut sent = Vec::new();
            let mut counts = vec![0; ranks];
            if rank < blocks {
                let film = film.expect("the film of this rank's block");
                assert_eq!(film.pixels.len(), self.pixels, "pixels of a film");
                for (to, count) in counts.iter_mut().enumerate() {
                    let words = self.layout.of(film, self.part(to, portion));
                    *count = words.len();
                    sent.extend(words);
                }
            }
            let mine = self.part(rank, portion);
            let each = words_of(&mine);
            let received_counts: Vec<usize> = (0..ranks).map(|from| if from < blocks { each } else { 0 }).collect();
            let mut received = vec![0_u64; each * blocks];
            self.world.all_to_all_varcount_into(
                &Partition::new(&sent[..], as_counts(&counts), offsets(&counts)),
                &mut PartitionMut::new(&mut received[..], as_counts(&received_counts), offsets(&received_counts)),
            );
            let start = (mine.start - self.part(rank, 0).start) * self.layout.per_pixel();
            for (block, words) in received.chunks_exact(each.max(1)).enumerate() {
                if first && block == 0 {
                    // Not added to 0, which would change the sign of -0.
                    sums.extend_from_slice(words);
                } else {
                    self.layout.add(&mut sums[start..start + each], words);
                }
            }
        }
        self.words = sums;
    }

    /// Sets the sums to those of a film that rank 0 has.
    ///
    /// # Panics
    /// If rank 0 has no film.
    pub fn scatter(&mut self, film: Option<&Film>) {
        let mut sums = Vec::new();
        self.in_portions_of_all(|sums_of, counts, mine| {
            let mut words = vec![0_u64; mine];
            let root = sums_of.world.process_at_rank(0);
            if sums_of.world.rank() == 0 {
                let film = film.expect("the film of rank 0");
                let all: Vec<u64> =
                    counts.iter().flat_map(|(range, _)| sums_of.layout.of(film, range.clone())).collect();
                let counts: Vec<usize> = counts.iter().map(|(_, count)| *count).collect();
                let parts = Partition::new(&all[..], as_counts(&counts), offsets(&counts));
                root.scatter_varcount_into_root(&parts, &mut words[..]);
            } else {
                root.scatter_varcount_into(&mut words[..]);
            }
            sums.extend(words);
        });
        self.words = sums;
        self.tally = film.map_or_else(FilmTally::default, |film| film.tally.clone());
    }

    /// The whole film, on rank 0: an empty film of the right size with the sums of all ranks. The other ranks give and get
    /// `None`. All ranks call this together.
    pub fn gather(&self, mut film: Option<Film>, contains: &PassSet) -> Option<Film> {
        let mut sent = 0;
        self.in_portions_of_all(|sums_of, counts, mine| {
            let words = &sums_of.words[sent..sent + mine];
            sent += mine;
            let root = sums_of.world.process_at_rank(0);
            let Some(film) = &mut film else {
                root.gather_varcount_into(words);
                return;
            };
            let lengths: Vec<usize> = counts.iter().map(|(_, count)| *count).collect();
            let mut all = vec![0_u64; lengths.iter().sum()];
            root.gather_varcount_into_root(
                words,
                &mut PartitionMut::new(&mut all[..], as_counts(&lengths), offsets(&lengths)),
            );
            let mut rest = &all[..];
            for (range, count) in counts {
                let (words, others) = rest.split_at(*count);
                sums_of.layout.set(film, range.clone(), words);
                rest = others;
            }
        });
        let tally = self.gather_tally();
        if let Some(film) = &mut film {
            film.tally = tally;
            film.contains = contains.clone();
            film.passes = u32::try_from(contains.count()).unwrap_or(u32::MAX);
        }
        film
    }

    /// The counts of all ranks, on rank 0; on others their own.
    ///
    /// # Panics
    /// If ranks are of different versions of the program.
    fn gather_tally(&self) -> FilmTally {
        let mut all = self.tally.clone();
        if self.world.rank() > 0 {
            self.world.process_at_rank(0).send(tally_to_text(&all).as_bytes());
            return all;
        }
        for rank in 1..self.world.size() {
            let (text, _) = self.world.process_at_rank(rank).receive_vec::<u8>();
            let tally = tally_from_text(&String::from_utf8_lossy(&text)).expect("a rank of the same program");
            all.merge(&tally);
        }
        all
    }

    /// Calls `visit` for each portion with the pixels and the number of words of each rank, and that of this one.
    fn in_portions_of_all(&self, mut visit: impl FnMut(&Self, &[(Range<usize>, usize)], usize)) {
        for portion in 0..self.portions {
            let of = |rank| {
                let range = self.part(rank, portion);
                let words = range.len() * self.layout.per_pixel();
                (range, words)
            };
            let counts: Vec<_> = (0..self.world.size() as usize).map(of).collect();
            let mine = counts[self.world.rank() as usize].1;
            visit(self, &counts, mine);
        }
    }
}

/// Counts as MPI wants them. Portions keep them below 2³¹.
fn as_counts(counts: &[usize]) -> Vec<i32> {
    counts.iter().map(|&count| i32::try_from(count).expect("a portion is small")).collect()
}

/// Where each count begins.
fn offsets(counts: &[usize]) -> Vec<i32> {
    let starts = counts.iter().scan(0, |sum, &count| Some(std::mem::replace(sum, *sum + count)));
    as_counts(&starts.collect::<Vec<_>>())
}
