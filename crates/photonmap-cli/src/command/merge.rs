//! `photonmap merge`

use std::path::PathBuf;

use clap::Args;

use crate::command::outlook::TargetArgs;
use crate::fault::Fault;

/// Add the passes of film files of one picture, such as those of a job array.
///
/// The films must have the same scene, view and settings, and no pass in common. Memory: at most 24 bytes for each pixel,
/// for any number of films; with --target-error, that of the film.
#[derive(Clone, Debug, Args)]
pub struct MergeArgs {
    /// The film file to write; may be one of the others.
    #[arg(value_name = "OUT.film")]
    output: PathBuf,
    /// The film files to add, in any order.
    #[arg(value_name = "FILE.film", required = true)]
    films: Vec<PathBuf>,
    #[command(flatten)]
    target: TargetArgs,
}

/// Merges the films.
///
/// # Errors
/// [`Fault::Input`] names the film that is damaged or does not fit; [`Fault::Failure`] if the file cannot be written.
pub fn run(args: &MergeArgs) -> Result<(), Fault> {
    if let Some(first) = args.films.first() {
        args.target.check(first)?;
    }
    let info = photon_film::merge(&args.output, &args.films)?;
    if !info.in_order {
        say!(
            "note: the last bits may differ from those of a single render; for the same bits, render all films on one \
             backend, and each after the first as the next block of {} passes",
            info.key.grain()
        );
    }
    let (films, passes) = (args.films.len(), info.contains.count());
    say!("wrote {}: {passes} passes of {films} films ({})", args.output.display(), info.contains);
    args.target.print(&args.output)
}
