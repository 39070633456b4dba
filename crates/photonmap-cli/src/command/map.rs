//! `photonmap map`

use std::path::{Path, PathBuf};

use clap::Args;
use photon_core::IndexKind;

use super::map_scale::Scale;
use super::map_search::{self, Found, Wanted};
use crate::args::index_names;
use crate::backend::{self, BackendName, Chosen};
use crate::fault::Fault;
use crate::outputs::Outputs;
use crate::{atomic_write, npy};

/// Search a photon map: the nearest photons of each query point, or the number within a radius of points or segments.
#[derive(Clone, Debug, Args)]
pub struct MapArgs {
    /// Photons: a .npy file of float32, shape (N, 3).
    #[arg(long, value_name = "P.npy")]
    photons: PathBuf,
    /// Query points: a .npy file of float32, shape (M, 3).
    #[arg(long, value_name = "Q.npy", required_unless_present = "beams", conflicts_with = "beams")]
    queries: Option<PathBuf>,
    /// Segments instead of query points, with --radius: a .npy file of float32, shape (M, 2, 3), the ends of each, or (M, 6).
    ///
    /// Photons within the radius of a segment are counted, in double precision. On the CPU.
    #[arg(long, value_name = "B.npy", requires = "radius", conflicts_with = "k")]
    beams: Option<PathBuf>,
    /// Find this many nearest photons of each query.
    #[arg(long, value_name = "K", required_unless_present = "radius", conflicts_with = "radius")]
    k: Option<u32>,
    /// With --k: no photon farther away than this.
    #[arg(long, value_name = "R", requires = "k")]
    max_radius: Option<f32>,
    /// Count the photons within this radius of each query or segment.
    #[arg(long, value_name = "R")]
    radius: Option<f32>,
    /// Data structure of the photon map: left-balanced kd-tree, kd-tree by the Voxel Volume Heuristic, or Morton
    /// order.
    #[arg(long, default_value = "morton", value_parser = index_names())]
    index: IndexKind,
    /// Where to search.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    backend: BackendName,
    /// Number of threads on the CPU [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Write the result as a .npy file of uint32.
    ///
    /// With --k it has the shape (M, K): indices of photons, nearest first, ties by lower index, 4294967295 where
    /// there are fewer. With --radius it has the shape (M,): counts.
    #[arg(long, value_name = "OUT.npy")]
    neighbours: Option<PathBuf>,
    /// Write a report in JSON; `-` for standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Reads the points, searches, and writes the result.
///
/// # Errors
/// [`Fault::Input`] for files that cannot be read, points that are not finite and numbers out of range;
/// [`Fault::Failure`] if the search or writing fails.
pub fn run(args: &MapArgs) -> Result<(), Fault> {
    let reach = |name: &str, radius: Option<f32>| match radius {
        Some(r) if !(r > 0.0 && r.is_finite()) => {
            Err(Fault::input(format!("{name} is {r}, but must be above 0 and finite")))
        }
        _ => Ok(radius),
    };
    reach("--radius", args.radius)?;
    let max_radius = reach("--max-radius", args.max_radius)?.unwrap_or(f32::INFINITY);
    if args.k == Some(0) {
        return Err(Fault::input("--k is 0, but at least 1 is needed"));
    }
    args.neighbours.iter().try_for_each(|path| atomic_write::check(path))?;
    args.json.iter().try_for_each(|path| Outputs::check_report(path))?;
    let photons = finite(&args.photons, npy::read_points(&args.photons)?, "point", 1)?;
    let queries = match (&args.queries, &args.beams) {
        (_, Some(file)) => finite(file, npy::read_segments(file)?.into_flattened(), "segment", 2)?,
        (Some(file), None) => finite(file, npy::read_points(file)?, "point", 1)?,
        (None, None) => return Err(Fault::input("give --queries, or --beams")),
    };
    let kind = args.index;
    let width = match args.k {
        Some(k) => k as usize,
        None => 1,
    };
    if queries.len().checked_mul(width).is_none_or(|cells| cells > 1 << 33) {
        return Err(Fault::input(format!("--k {width} for {} queries is too much", queries.len())));
    }
    let scale = Scale::of(&photons, &queries);
    let [photons, queries] = [photons, queries].map(|points| scale.points(points));
    // More than there are takes no memory while they are searched.
    let most = u32::try_from(photons.len()).unwrap_or(u32::MAX);
    let wanted = match (args.k, args.radius) {
        (Some(k), _) => Wanted::Nearest { k: k.min(most), max_radius: scale.radius("--max-radius", max_radius)? },
        (None, radius) if args.beams.is_some() => {
            Wanted::CountAlong { radius: scale.radius("--radius", radius.unwrap_or(0.0))? }
        }
        (None, radius) => Wanted::Count { radius: scale.radius("--radius", radius.unwrap_or(0.0))? },
    };
    let (file, threads) = (&args.photons, args.threads);
    let place = match (args.backend, &args.beams) {
        (BackendName::Auto, Some(_)) => BackendName::Cpu,
        (BackendName::Vulkan, Some(_)) => return Err(Fault::input(map_search::BEAMS_ON_CPU)),
        (given, _) => given,
    };
    let found = match backend::open(place, threads)? {
        Chosen::Cpu(_) => map_search::on_cpu(threads, file, &photons, &queries, kind, wanted)?,
        Chosen::Vulkan(on) => map_search::on_vulkan(*on, &photons, &queries, kind, wanted)?,
    };
    let Found { seconds_build, seconds_query, .. } = found;
    if let Wanted::Nearest { k, .. } = wanted {
        scale.check(&photons, &queries, &found.words, k as usize)?;
    }

    let mut written = Outputs::default();
    if let Some(path) = &args.neighbours {
        let rows = match wanted {
            Wanted::Nearest { k, .. } => npy::write_rows(path, &found.words, (queries.len(), k as usize, width)),
            Wanted::Count { .. } | Wanted::CountAlong { .. } => npy::write_u32(path, &found.words),
        };
        written.file(path, rows);
    }
    let answered = if args.beams.is_some() { queries.len() / 2 } else { queries.len() };
    let rate = answered as f64 / seconds_query.max(1e-12);
    if let Some(path) = &args.json {
        let report = serde_json::json!({
            "backend": found.backend,
            "device": found.device,
            "threads": found.threads,
            "index": kind.name(),
            "photons": photons.len(),
            "queries": answered,
            "beams": args.beams.is_some(),
            "k": args.k,
            "max_radius": args.max_radius,
            "radius": args.radius,
            "bytes": found.bytes,
            "seconds_build": seconds_build,
            "seconds_query": seconds_query,
            "queries_per_second": rate,
        });
        written.report(path, &report);
    }
    say!(
        "wrote {written}: index of {} photons in {seconds_build:.3} s, {} queries in {seconds_query:.3} s ({rate:.0} per second)",
        photons.len(),
        answered
    );
    written.result()
}

/// Rejects points that are not finite; the error has the index of the row, which is called `what` and has `each` points.
fn finite(file: &Path, points: Vec<[f32; 3]>, what: &str, each: usize) -> Result<Vec<[f32; 3]>, Fault> {
    match points.iter().position(|point| point.iter().any(|c| !c.is_finite())) {
        None => Ok(points),
        Some(index) => Err(Fault::input(format!(
            "{}: {what} {} has the coordinates {:?}, which are not finite",
            file.display(),
            index / each,
            points[index]
        ))),
    }
}
