//! The stages of one pass in their order, and its report.

use std::ops::ControlFlow;

use super::{PILOT_PASS, Pipeline};
use crate::backend::observer::{Event, Observer, PassReport};
use crate::backend::{Stage, TransportBackend};
use crate::error::{Error, Result};
use crate::film::pass_set::PassSet;
use crate::pipeline::photons::Sent;
use crate::pipeline::render::PassEnd;
use crate::radius::radii;
use crate::requirements::map_kind::PerMap;
use crate::requirements::map_place::MapPlace;

impl<B: TransportBackend> Pipeline<B> {
    /// One pass into the film, in which it counts once it has succeeded.
    pub(super) fn whole_pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd> {
        if index == PILOT_PASS {
            return Err(Error::InvalidSetting {
                name: "pass",
                value: index.to_string(),
                hint: "passes are numbered from 0 to 2^32 - 2",
            });
        }
        if self.lacks_samples {
            return Err(Error::InvalidSetting {
                name: "pass",
                value: "after a first one with fewer camera samples".into(),
                hint: "take its film first: passes of a film have the same number",
            });
        }
        let this = PassSet::of(self.settings.seed, index..index + 1);
        if let Some((seed, passes)) = self.contains.overlap(&this) {
            return Err(Error::PassTwice { seed, passes });
        }
        let condition = observer.stop_condition();
        self.on.stop_when(condition.clone());
        let made = self.light_of_pass(index, observer);
        self.on.stop_when(None);
        let Made { sent, queries, truncated_camera_paths } = match made {
            Ok(Some(made)) => made,
            // The contributions of earlier passes are kept.
            Ok(None) => return self.abandon(),
            Err(Error::Cancelled) if condition.is_some_and(|condition| condition.is_met()) => return self.abandon(),
            Err(error) => {
                self.on.abandon_pass(&mut self.film)?;
                return Err(error);
            }
        };
        self.on.mark(Some(Stage::Film));
        self.on.end_pass(&mut self.film)?;
        self.on.mark(None);
        self.passes += 1;
        self.contains.merge(&this)?;
        self.cut |= sent.cut;
        self.lacks_samples |= sent.lacks_samples;
        self.schedule.add(index);
        self.update_own_radii()?;
        let mut radius = PerMap::default();
        for slot in self.maps.iter().filter(|slot| slot.place == MapPlace::Surface) {
            let normalised = radii::gather(&self.settings, slot.radius, index).radius_scale;
            radius[slot.kind] = Some(self.units.length_to_user(normalised));
        }
        let report = PassReport {
            index,
            paths: u64::from(sent.paths),
            tally: sent.tally,
            aimed: sent.aimed_tally,
            truncated_camera_paths,
            radius,
            queries,
            seconds: self.on.timings()?,
        };
        self.tally.add(&report);
        let stop = observer.on_event(&Event::PassDone(&report)) == ControlFlow::Break(()) || sent.stop;
        Ok(if stop { PassEnd::Last(report) } else { PassEnd::Done(report) })
    }

    /// Photons, camera paths and estimates of a pass. `None`: the observer stopped it, and the film has other passes. If the
    /// first pass is cut short, it is a valid pass with fewer paths or camera samples.
    fn light_of_pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<Option<Made>> {
        let mut sent = self.emit_and_trace(index, self.settings.photons, observer)?;
        let has_samples = self.settings.camera_samples > 1;
        if self.passes > 0 && (sent.cut || sent.stop && has_samples) {
            return Ok(None);
        }
        let (queries, truncated) = self.look(index, 0)?;
        let gathered = self.estimate(index, &sent, queries)?;
        let samples = self.other_samples(index, &mut sent, observer)?;
        if sent.cut && self.passes > 0 {
            return Ok(None);
        }
        let truncated_camera_paths = samples.unwrap_or(truncated) + gathered;
        Ok(Some(Made { sent, queries, truncated_camera_paths }))
    }

    /// Discards what was rendered of a pass.
    fn abandon(&mut self) -> Result<PassEnd> {
        self.on.abandon_pass(&mut self.film)?;
        // Waits, so that a device has the memory of lost maps back before others are allocated.
        self.on.timings()?;
        self.recover()?;
        Ok(PassEnd::Cancelled)
    }
}

/// A pass whose light is in the film.
struct Made {
    sent: Sent,
    queries: u64,
    truncated_camera_paths: u64,
}
