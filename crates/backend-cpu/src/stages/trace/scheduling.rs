//! How paths are distributed over threads: the two methods of Lin and Wang 2010.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use photon_core::memory;
use photon_core::{PhotonRay, Result};
use rayon::prelude::*;

use super::{BLOCK, TraceOutput, Walk};
use crate::cpu::Cpu;

/// Photons and tallies of the threads, in the order of the paths.
type Outputs = Result<Vec<TraceOutput>>;

/// Label of the memory for these lists.
const BLOCKS: &str = "blocks of photons";

/// Static scheduling, the paper's first method: each thread traces a fixed share of the paths.
pub(super) fn share_statically(on: &Cpu, walk: &Walk<'_>, rays: &[PhotonRay]) -> Outputs {
    let quota = rays.len().div_ceil(on.threads()).max(1);
    let mut outputs = memory::with_capacity(rays.len().div_ceil(quota), BLOCKS)?;
    on.pool.install(|| {
        let traced = rays.par_chunks(quota).with_max_len(1).map(|chunk| walk.trace_all(chunk));
        traced.collect_into_vec(&mut outputs);
    });
    Ok(outputs)
}

/// Dynamic scheduling, the paper's second method: threads take blocks from a shared counter until none is left. The
/// blocks are then put back in order, so that the result does not depend on which thread traced which.
pub(super) fn share_dynamically(on: &Cpu, walk: &Walk<'_>, rays: &[PhotonRay]) -> Outputs {
    let blocks = rays.len().div_ceil(BLOCK);
    let outputs = Mutex::new(memory::with_capacity(blocks, BLOCKS)?);
    let next = AtomicUsize::new(0);
    let stop = &on.stop;
    on.pool.broadcast(|_| {
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            let start = block * BLOCK;
            if start >= rays.len() || stop.check().is_err() {
                break;
            }
            let output = walk.trace_all(&rays[start..(start + BLOCK).min(rays.len())]);
            outputs.lock().unwrap_or_else(PoisonError::into_inner).push((block, output));
        }
    });
    let mut outputs = outputs.into_inner().unwrap_or_else(PoisonError::into_inner);
    // Some blocks may be missing.
    stop.check()?;
    outputs.sort_unstable_by_key(|(block, _)| *block);
    Ok(memory::collected(outputs.into_iter().map(|(_, output)| output), BLOCKS)?)
}
