//! The photon map by itself, as another renderer would use it: own photons, own queries.
#![expect(clippy::print_stderr, reason = "what it did goes to stderr")]

mod search;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use photon_core::IndexKind;
use photon_examples::args::{BackendName, IndexName};
use photon_examples::backend::{self, Chosen};
use photon_examples::fault::{self, Fault};
use photon_examples::npy;
use search::{Found, Wanted};

/// Finds the photons nearest to each query, or counts those within a radius.
#[derive(Debug, Parser)]
#[command(name = "map_only", version, about)]
struct Args {
    /// Photons: a .npy file of float32, shape (N, 3).
    #[arg(long, value_name = "P.npy")]
    photons: PathBuf,
    /// Queries: a .npy file of float32, shape (M, 3).
    #[arg(long, value_name = "Q.npy")]
    queries: PathBuf,
    /// So many nearest photons for each query.
    #[arg(long, value_name = "K", required_unless_present = "radius", conflicts_with = "radius")]
    k: Option<u32>,
    /// With --k: none farther than this.
    #[arg(long, value_name = "R", requires = "k")]
    max_radius: Option<f32>,
    /// Count the photons within this radius of each query.
    #[arg(long, value_name = "R")]
    radius: Option<f32>,
    /// How photons are arranged.
    #[arg(long, value_enum, default_value_t = IndexName::Morton)]
    index: IndexName,
    /// Where to search.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    backend: BackendName,
    /// Threads, on the CPU [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// What was found, as a .npy file of uint32: with --k of shape (M, K), nearest first, ties by lower
    /// number, 4294967295 where there are fewer; with --radius counts of shape (M,).
    #[arg(long, value_name = "OUT.npy")]
    neighbours: Option<PathBuf>,
    /// Report to write.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
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
    let photons = npy::read_points(&args.photons)?;
    let queries = npy::read_points(&args.queries)?;
    let kind = match args.index {
        IndexName::Median => IndexKind::Median,
        IndexName::Vvh => IndexKind::Vvh,
        IndexName::Morton => IndexKind::Morton,
    };
    let width = match args.k {
        Some(k) => k as usize,
        None => 1,
    };
    if queries.len().checked_mul(width).is_none_or(|cells| cells > 1 << 33) {
        return Err(Fault::input(format!("--k {width} for {} queries is too much", queries.len())));
    }
    let wanted = match (args.k, args.radius) {
        (Some(k), _) => Wanted::Nearest { k, max_radius },
        (None, radius) => Wanted::Count { radius: radius.unwrap_or(0.0) },
    };
    let (file, threads) = (&args.photons, args.threads);
    let found = match backend::open(args.backend, threads)? {
        Chosen::Cpu(_) => search::on_cpu(threads, file, &photons, &queries, kind, wanted)?,
        Chosen::Vulkan(on) => search::on_vulkan(*on, file, &photons, &queries, kind, wanted)?,
    };
    let Found { seconds_build, seconds_query, .. } = found;

    if let Some(path) = &args.neighbours {
        npy::write_u32(path, &found.words, args.k.map(|k| k as usize))?;
    }
    let rate = queries.len() as f64 / seconds_query.max(1e-12);
    if let Some(path) = &args.json {
        let report = serde_json::json!({
            "backend": found.backend,
            "device": found.device,
            "threads": found.threads,
            "index": format!("{kind:?}").to_lowercase(),
            "photons": photons.len(),
            "queries": queries.len(),
            "k": args.k,
            "max_radius": args.max_radius,
            "radius": args.radius,
            "bytes": found.bytes,
            "seconds_build": seconds_build,
            "seconds_query": seconds_query,
            "queries_per_second": rate,
        });
        photon_examples::whole::write_bytes(path, format!("{report:#}\n").as_bytes())?;
    }
    eprintln!(
        "{} photons arranged in {seconds_build:.3} s, {} queries in {seconds_query:.3} s ({rate:.0} a second)",
        photons.len(),
        queries.len()
    );
    Ok(())
}
