//! The photon map by itself, as another renderer would use it: own photons, own queries.
#![expect(clippy::print_stderr, reason = "what it did goes to stderr")]

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use backend_cpu::index::PointIndex;
use clap::Parser;
use photon_core::IndexKind;
use photon_examples::args::{BackendName, IndexName};
use photon_examples::fault::{self, Fault};
use photon_examples::npy;

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
    #[arg(long, value_enum, default_value_t = BackendName::Cpu)]
    backend: BackendName,
    /// Threads [default: all cores].
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
    if args.backend == BackendName::Vulkan {
        return Err(Fault::input("--backend vulkan: this build has no Vulkan backend; use --backend cpu"));
    }
    let reach = |name: &str, radius: Option<f32>| match radius {
        Some(r) if !(r > 0.0 && r.is_finite()) => {
            Err(Fault::input(format!("{name} is {r}, but must be above 0 and finite")))
        }
        _ => Ok(radius),
    };
    let radius = reach("--radius", args.radius)?;
    let max_radius = reach("--max-radius", args.max_radius)?.unwrap_or(f32::INFINITY);
    if args.k == Some(0) {
        return Err(Fault::input("--k is 0, but at least 1 is needed"));
    }
    if args.threads == Some(0) {
        return Err(Fault::input("--threads is 0, but at least 1 is needed"));
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
    let cells = queries.len().checked_mul(width).filter(|&cells| cells <= 1 << 33);
    let cells = cells.ok_or_else(|| Fault::input(format!("--k {width} for {} queries is too much", queries.len())))?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool.build().map_err(Fault::failure)?;

    let begun = Instant::now();
    let built = pool.install(|| PointIndex::build(&photons, kind));
    let index = built.map_err(|why| Fault::input(format!("{}: {why}", args.photons.display())))?;
    let seconds_build = begun.elapsed().as_secs_f64();
    let mut found = vec![0_u32; cells];
    let begun = Instant::now();
    pool.install(|| match radius {
        Some(radius) => index.count_within_many(&queries, radius * radius, &mut found),
        None => index.nearest_many(&queries, width, max_radius * max_radius, &mut found),
    });
    let seconds_query = begun.elapsed().as_secs_f64();

    if let Some(path) = &args.neighbours {
        npy::write_u32(path, &found, args.k.map(|k| k as usize))?;
    }
    let rate = queries.len() as f64 / seconds_query.max(1e-12);
    if let Some(path) = &args.json {
        let report = serde_json::json!({
            "backend": "cpu",
            "threads": pool.current_num_threads(),
            "index": format!("{kind:?}").to_lowercase(),
            "photons": photons.len(),
            "queries": queries.len(),
            "k": args.k,
            "max_radius": args.max_radius,
            "radius": args.radius,
            "bytes": index.bytes(),
            "seconds_build": seconds_build,
            "seconds_query": seconds_query,
            "queries_per_second": rate,
        });
        std::fs::write(path, format!("{report:#}\n")).map_err(|why| Fault::writing(path, why))?;
    }
    eprintln!(
        "{} photons arranged in {seconds_build:.3} s, {} queries in {seconds_query:.3} s ({rate:.0} a second)",
        photons.len(),
        queries.len()
    );
    Ok(())
}
