//! Compilation of kernels by all cores, into one pipeline cache.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use ash::vk;

use super::cache::DiskCache;
use super::logical::Device;
use super::module::Module;
use super::specialize::specialize;

/// A kernel to be compiled.
#[derive(Debug)]
pub(super) struct Job {
    module: &'static Module,
    constants: Vec<(u32, u32)>,
    progress: Mutex<Progress>,
    done: Condvar,
}

#[derive(Clone, Copy, Debug)]
enum Progress {
    Waiting,
    Begun,
    Done(Result<vk::Pipeline, vk::Result>),
}

/// Threads that compile kernels in the order in which they were requested. They end when nothing is left.
#[derive(Debug)]
pub(super) struct Compiler {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    most_threads: usize,
}

#[derive(Debug)]
struct Shared {
    device: Arc<Device>,
    layout: vk::PipelineLayout,
    /// Used by all threads at a time: it was made without `VK_PIPELINE_CACHE_CREATE_EXTERNALLY_SYNCHRONIZED_BIT`.
    cache: vk::PipelineCache,
    disk: Option<DiskCache>,
    queue: Mutex<Queue>,
}

#[derive(Debug, Default)]
struct Queue {
    jobs: VecDeque<Arc<Job>>,
    /// Number of threads at work.
    working: usize,
    /// Whether the cache has something that the file does not have.
    is_fresh: bool,
    /// Whether the file is written as soon as nothing is left to compile.
    saves_when_done: bool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Job {
    /// The pipeline, if it is compiled.
    pub(super) fn made(&self) -> Option<Result<vk::Pipeline, vk::Result>> {
        match *lock(&self.progress) {
            Progress::Done(made) => Some(made),
            _ => None,
        }
    }

    /// Whether it was still waiting, and is the caller's to compile.
    fn begin(&self) -> bool {
        let mut progress = lock(&self.progress);
        let waited = matches!(*progress, Progress::Waiting);
        if waited {
            *progress = Progress::Begun;
        }
        waited
    }
}

impl Compiler {
    pub(super) fn new(
        device: &Arc<Device>,
        layout: vk::PipelineLayout,
        cache: vk::PipelineCache,
        disk: Option<DiskCache>,
    ) -> Self {
        let shared = Shared { device: device.clone(), layout, cache, disk, queue: Mutex::default() };
        let most_threads = thread::available_parallelism().map_or(1, usize::from);
        Self { shared: Arc::new(shared), threads: Vec::new(), most_threads }
    }

    /// Begins to compile a kernel.
    pub(super) fn add(&mut self, module: &'static Module, constants: Vec<(u32, u32)>) -> Arc<Job> {
        let progress = Mutex::new(Progress::Waiting);
        let job = Arc::new(Job { module, constants, progress, done: Condvar::new() });
        let mut queue = lock(&self.shared.queue);
        queue.jobs.push_back(job.clone());
        if queue.working < self.most_threads {
            let shared = self.shared.clone();
            // Without a thread, whoever waits for the kernel compiles it.
            if let Ok(thread) = thread::Builder::new().name("kernels".to_owned()).spawn(move || shared.work()) {
                queue.working += 1;
                self.threads.retain(|thread| !thread.is_finished());
                self.threads.push(thread);
            }
        }
        job
    }

    /// Writes the cache file as soon as nothing is left to compile.
    pub(super) fn save_when_done(&mut self) {
        lock(&self.shared.queue).saves_when_done = true;
    }

    /// Waits for a kernel. The calling thread compiles it if no other has begun.
    pub(super) fn wait(&self, job: &Job) -> Result<vk::Pipeline, vk::Result> {
        if job.begin() {
            self.shared.make(job);
        }
        let mut progress = lock(&job.progress);
        loop {
            match *progress {
                Progress::Done(made) => return made,
                _ => progress = job.done.wait(progress).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    /// Ends the threads, without what they have not begun, and writes the cache file if it lacks anything.
    pub(super) fn finish(&mut self) {
        lock(&self.shared.queue).jobs.clear();
        for thread in self.threads.drain(..) {
            // It has not panicked: nothing in it does.
            let _ = thread.join();
        }
        let is_fresh = lock(&self.shared.queue).is_fresh;
        if is_fresh {
            self.shared.save();
        }
    }
}

impl Shared {
    fn work(&self) {
        loop {
            let mut queue = lock(&self.queue);
            if let Some(job) = queue.jobs.pop_front() {
                drop(queue);
                if job.begin() {
                    self.make(&job);
                }
                continue;
            }
            if queue.working == 1 && queue.is_fresh && queue.saves_when_done {
                (queue.is_fresh, queue.saves_when_done) = (false, false);
                drop(queue);
                self.save();
                continue;
            }
            queue.working -= 1;
            return;
        }
    }

    fn make(&self, job: &Job) {
        let made = self.compile(job);
        // Before anybody who waits can drop the cache.
        lock(&self.queue).is_fresh |= made.is_ok();
        *lock(&job.progress) = Progress::Done(made);
        job.done.notify_all();
    }

    fn compile(&self, job: &Job) -> Result<vk::Pipeline, vk::Result> {
        let (device, module) = (&self.device, job.module);
        #[cfg(test)]
        device.injection.compile()?;
        let words = if device.limits.keeps_denormals { module.words_that_keep_denormals() } else { module.words() };
        let words = specialize(&words, &job.constants);
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the backend's own SPIR-V, validated when it was committed.
        let shader = unsafe { device.raw.create_shader_module(&info, None) }?;
        device.name(shader, module.name);
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(shader)
            .name(c"main");
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout)];
        // SAFETY: everything the structures point to outlives the call.
        let made = unsafe { device.raw.create_compute_pipelines(self.cache, &info, None) };
        // SAFETY: a pipeline does not need its module once it is created.
        unsafe { device.raw.destroy_shader_module(shader, None) };
        let pipeline = made.map_err(|(_, result)| result)?[0];
        device.name(pipeline, module.name);
        Ok(pipeline)
    }

    /// Adds the cache to the file.
    fn save(&self) {
        let Some(disk) = &self.disk else { return };
        disk.update(|others| {
            let raw = &self.device.raw;
            let info = vk::PipelineCacheCreateInfo::default().initial_data(others);
            // SAFETY: the device is alive; the driver validates the header of the data.
            let all = unsafe { raw.create_pipeline_cache(&info, None) }.ok()?;
            // SAFETY: this thread alone knows the new cache; the other may be in use.
            let merged = unsafe { raw.merge_pipeline_caches(all, &[self.cache]) };
            // SAFETY: as above.
            let data = unsafe { raw.get_pipeline_cache_data(if merged.is_ok() { all } else { self.cache }) };
            // SAFETY: nothing uses it any more.
            unsafe { raw.destroy_pipeline_cache(all, None) };
            data.ok()
        });
    }
}
