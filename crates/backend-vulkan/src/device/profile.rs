//! Seconds per stage, by device timestamps.

use std::sync::Arc;

use ash::vk;
use photon_core::{Result, Stage, StageTimings};

use super::fault::during;
use super::logical::Device;
use super::recorder::Recorder;

/// Maximum number of marks between two readings; if there are more, a reading is taken in between.
const MARKS: u32 = 512;

/// Timestamps at the beginning and end of stages.
#[derive(Debug)]
pub(crate) struct Profile {
    device: Arc<Device>,
    /// `None` if the queue does not support timestamps.
    pool: Option<vk::QueryPool>,
    /// The stage that begins at each timestamp.
    marks: Vec<Option<Stage>>,
    current: Option<Stage>,
    sums: StageTimings,
}

impl Profile {
    pub(crate) fn new(device: &Arc<Device>) -> Result<Self> {
        let pool = if device.limits.timestamp_period > 0.0 {
            let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(MARKS);
            // SAFETY: the device is alive.
            let pool = unsafe { device.raw.create_query_pool(&info, None) }.map_err(during("a query pool"))?;
            device.name(pool, "timestamps");
            // SAFETY: no command uses it yet.
            unsafe { device.raw.reset_query_pool(pool, 0, MARKS) };
            Some(pool)
        } else {
            None
        };
        Ok(Self { device: device.clone(), pool, marks: Vec::new(), current: None, sums: StageTimings::default() })
    }

    /// Commands recorded from now on belong to `stage`.
    pub(crate) fn mark(&mut self, recorder: &mut Recorder, stage: Option<Stage>) -> Result<()> {
        let Some(pool) = self.pool else { return Ok(()) };
        if stage == self.current {
            return Ok(());
        }
        if self.marks.len() as u32 + 1 >= MARKS {
            self.collect(recorder)?;
        }
        recorder.label(stage.map(Stage::name))?;
        recorder.stamp(pool, self.marks.len() as u32)?;
        self.marks.push(stage);
        self.current = stage;
        Ok(())
    }

    /// Adds time that the host spent on a stage.
    pub(crate) fn add(&mut self, stage: Stage, seconds: f64) {
        self.sums.add(stage, seconds);
    }

    /// Seconds per stage since the last call.
    pub(crate) fn take(&mut self, recorder: &mut Recorder) -> Result<StageTimings> {
        self.mark(recorder, None)?;
        self.collect(recorder)?;
        Ok(std::mem::take(&mut self.sums))
    }

    fn collect(&mut self, recorder: &mut Recorder) -> Result<()> {
        let Some(pool) = self.pool else { return recorder.wait() };
        recorder.wait()?;
        let mut ticks = vec![0_u64; self.marks.len()];
        if ticks.is_empty() {
            return Ok(());
        }
        // SAFETY: all these queries were written by completed commands.
        unsafe {
            self.device
                .raw
                .get_query_pool_results(pool, 0, &mut ticks, vk::QueryResultFlags::TYPE_64)
                .map_err(during("reading timestamps"))?;
            self.device.raw.reset_query_pool(pool, 0, MARKS);
        }
        for (pair, stage) in ticks.windows(2).zip(&self.marks) {
            if let Some(stage) = stage {
                let seconds = pair[1].saturating_sub(pair[0]) as f64 * self.device.limits.timestamp_period * 1e-9;
                self.sums.add(*stage, seconds);
            }
        }
        self.marks.clear();
        let current = self.current.take();
        if current.is_some() {
            self.mark(recorder, current)?;
        }
        Ok(())
    }
}

impl Drop for Profile {
    fn drop(&mut self) {
        if let Some(pool) = self.pool {
            // SAFETY: after the wait the pool is not in use; a lost device uses nothing.
            unsafe {
                let _ = self.device.raw.device_wait_idle();
                self.device.raw.destroy_query_pool(pool, None);
            }
        }
    }
}
