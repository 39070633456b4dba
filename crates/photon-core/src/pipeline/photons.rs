//! Photons of a pass: emitted, traced, stored.

use super::Pipeline;
use crate::backend::observer::{Event, Observer};
use crate::backend::stages::{Batch, Deposits, MediaDeposits, Pass};
use crate::backend::tally::Tally;
use crate::backend::{Stage, TransportBackend};
use crate::error::{Error, Result};
use crate::requirements::map_kind::PerMap;
use crate::requirements::map_place::MapPlace;

/// The paths that were emitted.
#[derive(Clone, Debug, Default)]
pub(super) struct Sent {
    /// Number of paths that were not aimed.
    pub(super) paths: u32,
    /// Number of aimed paths; `None` if the others fill the caustic map too.
    pub(super) aimed: Option<u32>,
    pub(super) tally: Tally,
    pub(super) aimed_tally: Tally,
    /// Whether the observer stopped it before all were emitted, or between camera samples.
    pub(super) cut: bool,
    /// Whether it was stopped between camera samples.
    pub(super) lacks_samples: bool,
    /// Whether the observer asked to stop, perhaps after the last path.
    pub(super) stop: bool,
}

impl Sent {
    /// Number of paths that filled each map.
    pub(super) fn per_map(&self) -> PerMap<u64> {
        per_map(self.paths, self.aimed).map(u64::from)
    }
}

/// Number of paths that fill each map, if some are aimed.
pub(super) fn per_map(others: u32, aimed: Option<u32>) -> PerMap<u32> {
    PerMap::from_fn(|kind| aimed.filter(|_| kind.is_aimed()).unwrap_or(others))
}

impl<B: TransportBackend> Pipeline<B> {
    /// Fills the photon buffers with the photons of `paths` paths and the corresponding aimed ones. If the
    /// observer stops it, there are fewer paths, but some of each kind.
    pub(super) fn emit_and_trace(&mut self, index: u32, paths: u32, observer: &mut dyn Observer) -> Result<Sent> {
        // An observer may ask to stop only once: after the last batch, or in an attempt that is repeated.
        let mut stop = false;
        loop {
            for photons in self.maps.iter_mut().filter_map(|slot| slot.photons.as_mut()) {
                self.on.clear(photons)?;
            }
            let mut sent = Sent { paths, ..Sent::default() };
            let total = paths.saturating_add(self.aimed_paths(paths).unwrap_or(0));
            if self.needs_others() {
                sent.paths = self.send(index, false, paths, (0, total), &mut stop, observer)?;
                sent.tally = self.stages.tracer.take_tally(&mut self.on)?;
                sent.cut = sent.paths < paths;
            }
            // If a pass is cut short, the share of aimed paths is unchanged.
            if let Some(aimed) = self.aimed_paths(sent.paths) {
                let traced = self.send(index, true, aimed, (sent.paths, total), &mut stop, observer)?;
                sent.aimed = Some(traced);
                sent.cut |= traced < aimed;
                if let Some(stages) = &mut self.stages.aimed {
                    sent.aimed_tally = stages.tracer.take_tally(&mut self.on)?;
                }
            }
            self.forget_repeated_tallies()?;
            if !self.grow_if_needed()? {
                sent.stop = stop;
                return Ok(sent);
            }
        }
    }

    /// Emits and traces paths of one kind, batch by batch, and returns their number; `before` and `total`
    /// are for the observer. `stop`: whether the observer asked to stop, which ends it after a batch.
    fn send(
        &mut self,
        index: u32,
        aimed: bool,
        paths: u32,
        (before, total): (u32, u32),
        stop: &mut bool,
        observer: &mut dyn Observer,
    ) -> Result<u32> {
        let mut traced = 0;
        while traced < paths {
            let end = traced.saturating_add(self.batch).min(paths);
            self.send_batch(index, aimed, traced..end)?;
            traced = end;
            let event = Event::Photons { pass: index, traced: before.saturating_add(traced), total };
            *stop |= observer.on_event(&event).is_break();
            if *stop {
                break;
            }
        }
        Ok(traced)
    }

    /// Emits and traces one batch, and appends its photons.
    pub(super) fn send_batch(&mut self, index: u32, aimed: bool, paths: std::ops::Range<u32>) -> Result<()> {
        let pass = Pass::new(&self.settings, index);
        let batch = Batch { pass, paths };
        let stages = &mut self.stages;
        let aims = stages.aimed.is_some();
        let [mut deposits, mut reflected]: [Deposits<'_, B>; 2] = Default::default();
        let mut in_media = MediaDeposits::<B>::default();
        for slot in &mut self.maps {
            // A map is filled by one kind of paths, never by both.
            if (aims && slot.kind.is_aimed()) == aimed {
                let target = match slot.place {
                    MapPlace::Surface => &mut deposits[slot.kind],
                    MapPlace::Reflection => &mut reflected[slot.kind],
                    MapPlace::Medium => &mut in_media.inside[slot.kind],
                    MapPlace::FromMedium => &mut in_media.onto_surfaces,
                };
                *target = slot.photons.as_mut();
            }
        }
        let (emitter, tracer) = match &mut stages.aimed {
            Some(stages) if aimed => (&mut stages.emitter, &mut stages.tracer),
            _ => (&mut stages.emitter, &mut stages.tracer),
        };
        self.on.mark(Some(Stage::Emit));
        emitter.emit(&mut self.on, &self.scene, &batch, &mut self.rays)?;
        self.on.mark(Some(Stage::Trace));
        tracer.trace(&mut self.on, &self.scene, &batch, &self.rays, deposits, in_media)?;
        if let Some(caustics) = stages.gloss_caustics.as_mut().filter(|_| reflected.values().any(Option::is_some)) {
            let none = MediaDeposits::default();
            caustics.tracer.trace(&mut self.on, &self.scene, &batch, &self.rays, reflected, none)?;
        }
        self.on.mark(None);
        Ok(())
    }

    /// Discards the counts of paths that are traced once more, and are in a tally already.
    pub(super) fn forget_repeated_tallies(&mut self) -> Result<()> {
        if let Some(caustics) = &mut self.stages.gloss_caustics {
            caustics.tracer.take_tally(&mut self.on)?;
        }
        Ok(())
    }

    /// Whether a buffer overflowed and was replaced by one large enough to repeat the pass.
    fn grow_if_needed(&mut self) -> Result<bool> {
        let mut grew = false;
        for slot in &mut self.maps {
            let Some(photons) = &slot.photons else { continue };
            let fill = self.on.fill(photons)?;
            if fill.needed > fill.capacity {
                if self.settings.photon_capacity.is_some() || self.settings.memory.is_some() {
                    let label = slot.label();
                    return Err(Error::CapacityExceeded { label, needed: fill.needed, capacity: fill.capacity });
                }
                slot.allocate(&mut self.on, fill.needed + fill.needed / 8, self.required.photon_format)?;
                grew = true;
            }
        }
        Ok(grew)
    }
}
