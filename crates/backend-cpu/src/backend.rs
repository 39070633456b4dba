//! Implements [`Backend`], the operations that every backend provides: buffers, maps, timings, memory.

use std::time::Instant;

use photon_core::{
    Backend, Element, Error, Fill, IndexKind, MapStages, Photon, PhotonFormat, Result, Stage, StageTimings, memory,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::map::rows::Rows;
use crate::map::{CpuBuilder, CpuMap};
use crate::stages::estimate::CpuEstimator;

impl Backend for Cpu {
    type Buffer<T: Element> = CpuBuffer<T>;
    type PhotonMap = CpuMap;

    fn name(&self) -> &'static str {
        "cpu"
    }

    fn device(&self) -> String {
        format!("{} threads, {}", self.threads(), std::env::consts::ARCH)
    }

    fn alloc<T: Element>(&mut self, label: &'static str, capacity: u64) -> Result<CpuBuffer<T>> {
        let data = memory::with_capacity(usize::try_from(capacity).unwrap_or(usize::MAX), label)?;
        self.note_memory(label, capacity.saturating_mul(size_of::<T>() as u64));
        Ok(CpuBuffer { data, short: None, label, capacity, needed: 0 })
    }

    fn alloc_photons(
        &mut self,
        label: &'static str,
        capacity: u64,
        photon_format: PhotonFormat,
    ) -> Result<CpuBuffer<Photon>> {
        let count = usize::try_from(capacity).unwrap_or(usize::MAX);
        let Some(rows) = Rows::with_capacity(photon_format, count, label)? else {
            return self.alloc(label, capacity);
        };
        self.note_memory(label, capacity.saturating_mul(photon_format.bytes()));
        Ok(CpuBuffer { data: Vec::new(), short: Some(rows), label, capacity, needed: 0 })
    }

    fn upload<T: Element>(&mut self, label: &'static str, data: &[T]) -> Result<CpuBuffer<T>> {
        let mut buffer = self.alloc(label, data.len() as u64)?;
        buffer.append(data);
        Ok(buffer)
    }

    fn download<T: Element>(&mut self, from: &CpuBuffer<T>, to: &mut Vec<T>) -> Result<()> {
        let Fill { needed, capacity, .. } = self.fill(from)?;
        if needed > capacity {
            return Err(Error::CapacityExceeded { label: from.label, needed, capacity });
        }
        from.check_full()?;
        to.clear();
        memory::reserve(to, from.data.len(), from.label)?;
        to.extend_from_slice(&from.data);
        Ok(())
    }

    fn fill<T: Element>(&mut self, buffer: &CpuBuffer<T>) -> Result<Fill> {
        Ok(Fill { length: buffer.len() as u64, needed: buffer.needed, capacity: buffer.capacity })
    }

    fn clear<T: Element>(&mut self, buffer: &mut CpuBuffer<T>) -> Result<()> {
        buffer.clear();
        Ok(())
    }

    fn map_stages(&mut self, index: IndexKind) -> Result<MapStages<Self>> {
        Ok(MapStages { builder: Box::new(CpuBuilder::new(index)), estimator: Box::new(CpuEstimator) })
    }

    fn mark(&mut self, stage: Option<Stage>) {
        let now = Instant::now();
        if let Some((running, since)) = self.running.take() {
            self.timings.add(running, (now - since).as_secs_f64());
        }
        self.running = stage.map(|stage| (stage, now));
    }

    fn timings(&mut self) -> Result<StageTimings> {
        self.mark(None);
        Ok(std::mem::take(&mut self.timings))
    }
}
