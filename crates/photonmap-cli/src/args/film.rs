//! The options of film files.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::values::duration;

/// The film file of a render.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Film file")]
pub struct FilmArgs {
    /// Keep the sums of all passes in this file, .film; if it exists, the render is continued from it.
    ///
    /// The result is the same as without interruption, bit by bit. It ends as --passes, --total-photons or
    /// --target-error say; radii that were derived are those in the file.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub film: Option<PathBuf>,
    /// How often the film file is written: a time such as 30s, 5min or 1h; 0s: after every block.
    #[arg(long, value_name = "TIME", default_value = "5min", value_parser = duration, requires = "film", hide_short_help = true)]
    pub checkpoint: Duration,
    /// Passes in a block [default: 1; with several devices but no --film, such that each renders two blocks or more].
    ///
    /// Passes are added in order within each block, and blocks in order: the picture depends on the grain in its last bits. A film contains whole blocks, and the film of a job array is that of a single render, bit by bit, if each job renders
    /// one block.
    #[arg(long, value_name = "N", hide_short_help = true, hide_long_help = true)]
    pub grain: Option<u32>,
}
