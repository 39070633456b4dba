//! The search of `photonmap map`, on either backend.

use std::path::Path;
use std::time::Instant;

use backend_cpu::index::PointIndex;
use backend_vulkan::Vulkan;
use photon_core::{Backend, IndexKind, Photon, Stage};

use crate::fault::Fault;

/// Beams are searched on one backend.
pub(crate) const BEAMS_ON_CPU: &str = "--beams is searched on the CPU: leave out --backend, or use --backend cpu";

/// The kind of search.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wanted {
    /// The k nearest, none farther than the radius, which may be infinite.
    Nearest { k: u32, max_radius: f32 },
    /// Their number within the radius.
    Count { radius: f32 },
    /// Their number within the radius of segments, of which two queries each are the ends.
    CountAlong { radius: f32 },
}

impl Wanted {
    /// Numbers in the answer to so many query points.
    fn answers(self, queries: usize) -> usize {
        match self {
            Self::Nearest { k, .. } => queries * k as usize,
            Self::Count { .. } => queries,
            Self::CountAlong { .. } => queries / 2,
        }
    }
}

/// The result of a search.
#[derive(Debug)]
pub(crate) struct Found {
    /// Rows of photon indices, or counts.
    pub(crate) words: Vec<u32>,
    pub(crate) backend: &'static str,
    /// Name of the device, if any.
    pub(crate) device: Option<String>,
    /// Number of threads, if the search ran on the CPU.
    pub(crate) threads: Option<usize>,
    /// Bytes of the index, photons not counted; unknown on some backends.
    pub(crate) bytes: Option<u64>,
    pub(crate) seconds_build: f64,
    pub(crate) seconds_query: f64,
}

/// Searches on the CPU. An error in the photons names `file`.
pub(crate) fn on_cpu(
    threads: Option<usize>,
    file: &Path,
    photons: &[[f32; 3]],
    queries: &[[f32; 3]],
    kind: IndexKind,
    wanted: Wanted,
) -> Result<Found, Fault> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool.build().map_err(Fault::failure)?;
    let begun = Instant::now();
    let index = pool.install(|| PointIndex::build(photons, kind));
    let index = index.map_err(|why| Fault::input(format!("{}: {why}", file.display())))?;
    let seconds_build = begun.elapsed().as_secs_f64();
    let mut words = vec![0_u32; wanted.answers(queries.len())];
    let begun = Instant::now();
    pool.install(|| match wanted {
        Wanted::Count { radius } => {
            index.count_within_many(queries, radius * radius, &mut words);
            Ok(())
        }
        Wanted::CountAlong { radius } => {
            index.count_near_segments(queries.as_chunks::<2>().0, radius, &mut words);
            Ok(())
        }
        Wanted::Nearest { k, max_radius } => {
            index.nearest_many(queries, k as usize, max_radius * max_radius, &mut words)
        }
    })
    .map_err(Fault::failure)?;
    let seconds_query = begun.elapsed().as_secs_f64();
    let (threads, bytes) = (Some(pool.current_num_threads()), Some(index.bytes()));
    Ok(Found { words, backend: "cpu", device: None, threads, bytes, seconds_build, seconds_query })
}

/// Searches on a GPU. Seconds are by its own clock, so that they include neither copies to and from the device
/// nor the compilation of kernels.
pub(crate) fn on_vulkan(
    mut on: Vulkan,
    photons: &[[f32; 3]],
    queries: &[[f32; 3]],
    kind: IndexKind,
    wanted: Wanted,
) -> Result<Found, Fault> {
    // These searches only use the positions.
    let records: Vec<Photon> = photons.iter().map(|&position| Photon { position, ..Photon::default() }).collect();
    let mut builder = on.map_stages(kind)?.builder;
    let there = on.upload("photons", &records)?;
    let queries = on.queries_at(queries)?;
    on.timings()?;
    let begun = Instant::now();
    on.mark(Some(Stage::Build));
    let map = builder.build(&mut on, there)?;
    on.mark(None);
    let seconds_build = spent(&mut on, Stage::Build, begun)?;
    let begun = Instant::now();
    on.mark(Some(Stage::Estimate));
    let answers = match wanted {
        Wanted::Nearest { k, max_radius } => on.nearest(&map, &queries, k, max_radius)?,
        Wanted::Count { radius } => on.count_within(&map, &queries, radius)?,
        Wanted::CountAlong { .. } => return Err(Fault::input(BEAMS_ON_CPU)),
    };
    on.mark(None);
    let seconds_query = spent(&mut on, Stage::Estimate, begun)?;
    let mut words = Vec::new();
    on.download(&answers, &mut words)?;
    let device = Some(on.device());
    Ok(Found { words, backend: "vulkan", device, threads: None, bytes: None, seconds_build, seconds_query })
}

/// Seconds of one stage; by the host's clock if the device has none.
fn spent(on: &mut Vulkan, stage: Stage, begun: Instant) -> Result<f64, Fault> {
    let seconds = on.timings()?.get(stage);
    Ok(if seconds > 0.0 { seconds } else { begun.elapsed().as_secs_f64() })
}
