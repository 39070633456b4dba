//! What must not be shared with a forked child process: threads, and devices.
//!
//! A child has none of its parent's threads, so that work given to a thread pool of the parent never ends. Pools are
//! therefore made for each process. A driver of a GPU is in an undefined state in the child.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Failure;

/// Pools by process and number of threads; 0 stands for all cores.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// The first process that opened a GPU; 0 for none.
static GPU_PROCESS: AtomicU32 = AtomicU32::new(0);

/// The thread pool of this process with so many threads; 0 stands for all cores.
///
/// The lock is only held with the interpreter's, with which Python forks: no child finds it locked.
pub(crate) fn pool(_py: Python<'_>, threads: usize) -> Result<Arc<ThreadPool>, Failure> {
    if threads > 4096 {
        return Err(Failure::input(format!("workers is {threads}, but must be -1 (all cores) or at most 4096")));
    }
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if pools.iter().any(|(of, ..)| *of != process) {
        // Dropping a pool of the parent would wait for threads that do not exist here.
        std::mem::forget(std::mem::take(&mut *pools));
    }
    if let Some((_, _, pool)) = pools.iter().find(|(_, known, _)| *known == threads) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(|n| format!("photonmap-{n}")).build();
    let pool = Arc::new(pool.map_err(|why| Failure::device(format!("threads cannot be started: {why}")))?);
    pools.push((process, threads, Arc::clone(&pool)));
    Ok(pool)
}

/// Checks that a GPU may be opened or used here, and notes that it was.
pub(crate) fn enter_gpu() -> Result<(), Failure> {
    let process = std::process::id();
    match GPU_PROCESS.compare_exchange(0, process, Ordering::SeqCst, Ordering::SeqCst) {
        Ok(_) => Ok(()),
        Err(first) if first == process => Ok(()),
        Err(_) => Err(Failure::fork(
            "the GPU was used before this process was forked, and a forked process cannot use it: start processes by \
             multiprocessing.get_context(\"spawn\") or \"forkserver\", or use device=\"cpu\"",
        )),
    }
}

/// A value that is only used and dropped in the process that made it. In a forked child it is left as it is.
#[derive(Debug)]
pub(crate) struct Local<T> {
    process: u32,
    value: Option<T>,
}

impl<T> Local<T> {
    pub(crate) fn new(value: T) -> Self {
        Self { process: std::process::id(), value: Some(value) }
    }

    /// The value; `what` it is, for the error.
    pub(crate) fn get(&mut self, what: &str) -> Result<&mut T, Failure> {
        let here = self.process == std::process::id();
        self.value.as_mut().filter(|_| here).ok_or_else(|| {
            Failure::fork(format!("{what} was made before this process was forked; make it in this process"))
        })
    }
}

impl<T> Drop for Local<T> {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            std::mem::forget(self.value.take());
        }
    }
}
