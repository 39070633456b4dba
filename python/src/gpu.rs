//! Searches on a GPU, by Vulkan.

use photonmap::vulkan::{Options, Vulkan, VulkanMap};
use photonmap::{Backend, IndexKind, Photon};

use crate::error::Failure;
use crate::points::{Points, SPARE};
use crate::process;

/// Opens a GPU by its index or a part of its name; without a name the preferred one, or that which the environment variable
/// PHOTON_VK_DEVICE selects.
pub(crate) fn open(name: &str) -> Result<Vulkan, Failure> {
    process::enter_gpu()?;
    let mut options = Options::default();
    options.disk_cache = true;
    options.device = (!name.is_empty()).then(|| name.to_owned());
    Vulkan::with_options(&options).map_err(|error| {
        let what = if name.is_empty() { "no GPU can be used".to_owned() } else { format!("device=\"gpu:{name}\"") };
        let cause = photonmap_cli::fault::chain(&error);
        Failure::device(format!("{what}: {cause}; install a Vulkan driver, or use device=\"cpu\""))
    })
}

/// Opens GPUs by their names, as [`open`] does; one that is named twice is opened twice. `all` alone stands for all that are
/// suitable, software drivers not included.
pub(crate) fn open_all(names: &[String]) -> Result<Vec<Vulkan>, Failure> {
    process::enter_gpu()?;
    if names != ["all"] {
        return names.iter().map(|name| open(name)).collect();
    }
    let all = photonmap_cli::backend::gpus();
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
