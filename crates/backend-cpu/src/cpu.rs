//! The backend: a pool of threads, and buffers that are vectors.

use std::time::Instant;

use photon_core::{Error, Photon, PhotonFormat, RayCaster, Result, SceneView, Stage, StageTimings};

use crate::map::rows::Rows;

/// Makes the ray caster of a scene.
pub(crate) type MakeCaster = Box<dyn Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + Send>;

/// Renders on the processor's cores.
#[expect(missing_debug_implementations, reason = "holds a thread pool and a closure")]
pub struct Cpu {
    pub(crate) pool: rayon::ThreadPool,
    pub(crate) make_caster: Option<MakeCaster>,
    pub(crate) timings: StageTimings,
    pub(crate) running: Option<(Stage, Instant)>,
    memory: Vec<(String, u64)>,
}

impl Cpu {
    /// On all cores.
    ///
    /// # Errors
    /// [`Error::Backend`] if the threads cannot be started.
    pub fn new() -> Result<Self> {
        Self::start(0)
    }

    /// On so many threads. The picture does not depend on it.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for 0 or over 4096; [`Error::Backend`] if they cannot be started.
    pub fn with_threads(threads: usize) -> Result<Self> {
        if !(1..=4096).contains(&threads) {
            return Err(Error::InvalidSetting {
                name: "threads",
                value: threads.to_string(),
                hint: "must lie between 1 and 4096",
            });
        }
        Self::start(threads)
    }

    fn start(threads: usize) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|n| format!("photon-{n}"))
            .build()
            .map_err(|source| Error::Backend { backend: "cpu: starting threads", source: Box::new(source) })?;
        Ok(Self { pool, make_caster: None, timings: StageTimings::default(), running: None, memory: Vec::new() })
    }

    /// With a ray caster of the caller's instead of `photon_scene::Accel`. It is made once for each
    /// scene, from vertices and triangles in normalised space.
    #[must_use]
    pub fn with_caster<F>(mut self, make: F) -> Self
    where
        F: Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + Send + 'static,
    {
        self.make_caster = Some(Box::new(make));
        self
    }

    /// How many threads it works on.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    pub(crate) fn note_memory(&mut self, label: &str, bytes: u64) {
        match self.memory.iter_mut().find(|(known, _)| known == label) {
            Some((_, known)) => *known = bytes,
            None => self.memory.push((label.to_owned(), bytes)),
        }
    }

    pub(crate) fn noted_memory(&self) -> &[(String, u64)] {
        &self.memory
    }

    pub(crate) fn forget_memory(&mut self) {
        self.memory.clear();
    }
}

/// Elements of one kind.
#[derive(Debug)]
pub struct CpuBuffer<T> {
    pub(crate) data: Vec<T>,
    /// Photons that are cut short; then there is nothing in `data`.
    pub(crate) short: Option<Rows>,
    pub(crate) label: &'static str,
    pub(crate) capacity: u64,
    pub(crate) needed: u64,
}

impl<T: Copy> CpuBuffer<T> {
    /// What it holds; nothing of photons that are cut short ([`photon_core::Backend::alloc_photons`]).
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        &self.data
    }

    pub(crate) fn len(&self) -> usize {
        self.data.len() + self.short.as_ref().map_or(0, Rows::len)
    }

    pub(crate) fn clear(&mut self) {
        self.data.clear();
        if let Some(rows) = &mut self.short {
            rows.clear();
        }
        self.needed = 0;
    }

    /// Appends what fits, and counts all.
    pub(crate) fn append(&mut self, more: &[T]) {
        let room = (self.capacity - self.data.len() as u64).min(more.len() as u64) as usize;
        self.data.extend_from_slice(&more[..room]);
        self.needed += more.len() as u64;
    }
}

impl<T> CpuBuffer<T> {
    /// How much it holds of a photon.
    pub(crate) fn photon_format(&self) -> PhotonFormat {
        self.short.as_ref().map_or(PhotonFormat::Full, Rows::photon_format)
    }

    /// Checks that it holds whole photons.
    pub(crate) fn check_full(&self) -> Result<()> {
        self.photon_format().check_full(self.label)
    }
}

impl CpuBuffer<Photon> {
    /// Appends what fits, as much of it as is kept, and counts all.
    pub(crate) fn append_photons(&mut self, more: &[Photon]) {
        let room = (self.capacity - self.len() as u64).min(more.len() as u64) as usize;
        match &mut self.short {
            None => self.data.extend_from_slice(&more[..room]),
            Some(rows) => rows.append(&more[..room]),
        }
        self.needed += more.len() as u64;
    }

    /// As much of a photon as is kept.
    #[inline]
    pub(crate) fn photon(&self, index: usize) -> Photon {
        match &self.short {
            None => self.data[index],
            Some(rows) => rows.get(index),
        }
    }
}
