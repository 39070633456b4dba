//! The backend: a thread pool, with vectors as buffers.

use std::time::Instant;

use photon_core::{Error, Photon, PhotonFormat, RayCaster, Result, SceneView, Stage, StageTimings, StopCondition};

use crate::map::rows::Rows;

/// Builds the ray caster of a scene.
pub(crate) type MakeCaster = Box<dyn Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + Send>;

/// Renders on the CPU cores.
#[expect(missing_debug_implementations, reason = "holds a thread pool and a closure")]
pub struct Cpu {
    pub(crate) pool: rayon::ThreadPool,
    pub(crate) make_caster: Option<MakeCaster>,
    pub(crate) timings: StageTimings,
    pub(crate) running: Option<(Stage, Instant)>,
    pub(crate) stop: Stop,
    memory: Vec<(String, u64)>,
}

impl Cpu {
    /// Uses all cores.
    ///
    /// # Errors
    /// [`Error::Backend`] if the threads cannot be started.
    pub fn new() -> Result<Self> {
        Self::start(0)
    }

    /// Uses `threads` threads. The image does not depend on their number.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for 0 or more than 4096; [`Error::Backend`] if the threads cannot be started.
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
        Ok(Self {
            pool,
            make_caster: None,
            timings: StageTimings::default(),
            running: None,
            stop: Stop::default(),
            memory: Vec::new(),
        })
    }

    /// Uses the caller's ray caster instead of `photon_scene::Accel`. It is built once per scene, from vertices and
    /// triangles in normalised space.
    ///
    /// A hit whose `t` is negative or not finite, whose triangle does not exist, or whose `u` or `v` is not between 0 and 1,
    /// a panic of the caster, and what [`RayCaster::take_error`] returns, are errors of the pass
    /// ([`Error::Backend`]). Hits beyond the end of a ray do not count.
    #[must_use]
    pub fn with_caster<F>(mut self, make: F) -> Self
    where
        F: Fn(&SceneView<'_>) -> Result<Box<dyn RayCaster>> + Send + 'static,
    {
        self.make_caster = Some(Box::new(make));
        self
    }

    /// The number of threads in the pool.
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

/// The condition under which the present pass is abandoned, if there is one.
#[derive(Debug, Default)]
pub(crate) struct Stop(pub(crate) Option<StopCondition>);

impl Stop {
    /// Ends a stage, on any thread, if the condition is met.
    pub(crate) fn check(&self) -> Result<()> {
        self.0.as_ref().map_or(Ok(()), StopCondition::check)
    }
}

/// A typed buffer.
#[derive(Debug)]
pub struct CpuBuffer<T> {
    pub(crate) data: Vec<T>,
    /// Truncated photon records; if present, `data` is empty.
    pub(crate) short: Option<Rows>,
    pub(crate) label: &'static str,
    pub(crate) capacity: u64,
    pub(crate) needed: u64,
}

impl<T: Copy> CpuBuffer<T> {
    /// The elements; empty if the photons are stored truncated ([`photon_core::Backend::alloc_photons`]).
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

    /// Makes it `needed` default elements, or as many as `fit`.
    pub(crate) fn reset(&mut self, needed: usize, fit: usize)
    where
        T: Default,
    {
        self.clear();
        self.needed = needed as u64;
        self.data.resize(fit, T::default());
    }

    /// Appends as many elements as fit, and counts all of them in `needed`.
    pub(crate) fn append(&mut self, more: &[T]) {
        let room = (self.capacity - self.data.len() as u64).min(more.len() as u64) as usize;
        self.data.extend_from_slice(&more[..room]);
        self.needed += more.len() as u64;
    }
}

impl<T> CpuBuffer<T> {
    /// The format in which it stores photons.
    pub(crate) fn photon_format(&self) -> PhotonFormat {
        self.short.as_ref().map_or(PhotonFormat::Full, Rows::photon_format)
    }

    /// Checks that the format is [`PhotonFormat::Full`].
    pub(crate) fn check_full(&self) -> Result<()> {
        self.photon_format().check_full(self.label)
    }
}

impl CpuBuffer<Photon> {
    /// Appends as many photons as fit, truncated to the format, and counts all of them in `needed`.
    pub(crate) fn append_photons(&mut self, more: &[Photon]) {
        let room = (self.capacity - self.len() as u64).min(more.len() as u64) as usize;
        match &mut self.short {
            None => self.data.extend_from_slice(&more[..room]),
            Some(rows) => rows.append(&more[..room]),
        }
        self.needed += more.len() as u64;
    }

    /// The photon at `index`. A truncated record has direction 0; a mono photon has its power in every channel.
    #[inline]
    pub(crate) fn photon(&self, index: usize) -> Photon {
        match &self.short {
            None => self.data[index],
            Some(rows) => rows.get(index),
        }
    }
}
