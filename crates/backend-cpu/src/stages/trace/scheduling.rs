//! How paths are distributed over threads: the two methods of Lin and Wang 2010.

use std::sync::atomic::{AtomicUsize, Ordering};

use photon_core::PhotonRay;
use rayon::prelude::*;

use super::{BLOCK, TraceOutput, Walk};
use crate::cpu::Cpu;

/// Static scheduling, the paper's first method: each thread traces a fixed share of the paths.
pub(super) fn share_statically(on: &Cpu, walk: &Walk<'_>, rays: &[PhotonRay]) -> Vec<TraceOutput> {
    let quota = rays.len().div_ceil(on.threads()).max(1);
    on.pool.install(|| rays.par_chunks(quota).with_max_len(1).map(|chunk| walk.trace_all(chunk)).collect())
}

/// Dynamic scheduling, the paper's second method: threads take blocks from a shared counter until none is left. The
/// blocks are then put back in order, so that the result does not depend on which thread traced which.
pub(super) fn share_dynamically(on: &Cpu, walk: &Walk<'_>, rays: &[PhotonRay]) -> Vec<TraceOutput> {
    let next = AtomicUsize::new(0);
    let threads = on.threads();
    let mut outputs: Vec<(usize, TraceOutput)> = on.pool.install(|| {
        (0..threads)
            .into_par_iter()
            .with_max_len(1)
            .flat_map_iter(|_| {
                let next = &next;
                std::iter::from_fn(move || {
                    let block = next.fetch_add(1, Ordering::Relaxed);
                    let start = block * BLOCK;
                    let end = (start + BLOCK).min(rays.len());
                    (start < rays.len()).then(|| (block, walk.trace_all(&rays[start..end])))
                })
            })
            .collect()
    });
    outputs.sort_unstable_by_key(|(block, _)| *block);
    outputs.into_iter().map(|(_, output)| output).collect()
}
