//! Searches on a GPU, by Vulkan.

use std::sync::OnceLock;

use photonmap::vulkan::{Options, Vulkan, VulkanMap};
use photonmap::{Backend, IndexKind, Photon};
use pyo3::prelude::*;

use crate::error::Failure;
use crate::points::{Points, SPARE};
use crate::process;

/// Whether device="auto" is a GPU: no software driver, and usable in this process.
///
/// The answer is kept, also for forked processes, which must not call the driver. With the lock of the interpreter, with which
/// Python forks, so that none finds the answer half made.
#[pyfunction]
pub(crate) fn prefers_gpu() -> bool {
    static ANSWER: OnceLock<bool> = OnceLock::new();
    *ANSWER.get_or_init(|| photonmap::vulkan::gpu::prefers_gpu().is_ok()) && process::enter_gpu().is_ok()
}

/// Opens a GPU by its index or a part of its name, which may be a software driver; without a name the preferred one, or that
/// which the environment variable PHOTON_VK_DEVICE selects.
pub(crate) fn open(name: &str) -> Result<Vulkan, Failure> {
    process::enter_gpu()?;
    if name.is_empty() {
        return photonmap::vulkan::gpu::requested_gpu().map_err(|why| {
            Failure::device(format!(
                "no GPU can be used: {why}; install a Vulkan driver, use device=\"cpu\", or select a device by index or name, \
                 such as device=\"gpu:0\", which may be a software driver"
            ))
        });
    }
    let mut options = Options::default();
    options.disk_cache = true;
    options.device = Some(name.to_owned());
    Vulkan::with_options(&options).map_err(|error| {
        let cause = photon_image::fault::chain(&error);
        Failure::device(format!("device=\"gpu:{name}\": {cause}; install a Vulkan driver, or use device=\"cpu\""))
    })
}

/// Opens GPUs by their names, as [`open`] does; one that is named twice is opened twice. `all` alone stands for all that are
/// suitable, software drivers not included.
pub(crate) fn open_all(names: &[String]) -> Result<Vec<Vulkan>, Failure> {
    process::enter_gpu()?;
    if names != ["all"] {
        return names.iter().map(|name| open(name)).collect();
    }
    let all = photonmap::vulkan::gpu::gpus();
    let names = all.map_err(|why| Failure::device(format!("device=\"gpu:all\": {why}; use device=\"cpu\"")))?;
    names.iter().map(|name| open(name)).collect()
}

/// Neighbours of a request, on the GPU: rows of it are at most this many bytes.
const MAX_ROWS: usize = 1 << 28;

/// Points on a GPU.
pub(crate) struct GpuPoints {
    on: Vulkan,
    map: VulkanMap,
    count: usize,
}

impl GpuPoints {
    pub(crate) fn new(points: &Points, name: &str) -> Result<Self, Failure> {
        let mut on = open(name)?;
        // Only the positions are used.
        let records: Vec<Photon> =
            points.rounded().into_iter().map(|position| Photon { position, ..Photon::default() }).collect();
        let mut builder = on.map_stages(IndexKind::Morton)?.builder;
        let uploaded = on.upload("points", &records)?;
        let map = builder.build(&mut on, uploaded)?;
        Ok(Self { on, map, count: records.len() })
    }

    /// Description of the device.
    pub(crate) fn device(&self) -> String {
        self.on.device()
    }

    /// How many queries of k neighbours are answered at once.
    pub(crate) fn queries_at_once(k: usize) -> usize {
        (MAX_ROWS / 4 / k.saturating_add(SPARE)).clamp(1, 1 << 22)
    }

    /// The candidates of each query within a radius, in f32: rows of `k` + [`SPARE`] indices, but no more than there are
    /// points.
    pub(crate) fn candidates(&mut self, queries: &[[f32; 3]], k: usize, radius: f32) -> Result<Vec<u32>, Failure> {
        process::enter_gpu()?;
        let width = (k + SPARE).min(self.count);
        let mut rows = Vec::new();
        if width > 0 && !queries.is_empty() {
            let queries = self.on.queries_at(queries)?;
            let found = self.on.nearest(&self.map, &queries, width as u32, radius)?;
            self.on.download(&found, &mut rows)?;
        }
        Ok(rows)
    }

    /// The number of points within a radius of each query, in f32.
    pub(crate) fn count(&mut self, queries: &[[f32; 3]], radius: f32) -> Result<Vec<u32>, Failure> {
        process::enter_gpu()?;
        let mut counts = vec![0; queries.len()];
        if !queries.is_empty() && radius >= 0.0 {
            let queries = self.on.queries_at(queries)?;
            let found = self.on.count_within(&self.map, &queries, radius)?;
            self.on.download(&found, &mut counts)?;
        }
        Ok(counts)
    }
}
