//! Blocks of passes on the ranks of an MPI job, and the sum of their films in a fixed order.
//!
//! `MPI_Reduce` adds in an order of its own, so that its result depends on the number of ranks. Here each rank adds the
//! blocks of all ranks for a part of the pixels, in order of blocks: [`Sums::add`]. The film has the bits of
//! [`photon_core::render_blocks`] in one process with the same grain, for any number of ranks, if their devices are of one
//! kind.

mod exchange;
mod render;

pub use exchange::Sums;
pub use render::{Checkpoints, Outcome, render};
