//! The stages of one pass in their order, and its report.

use std::ops::ControlFlow;

use super::{PILOT_PASS, Pipeline};
use crate::backend::observer::{Event, Observer, PassReport};
use crate::backend::{Stage, TransportBackend};
use crate::error::{Error, Result};
use crate::film::pass_set::PassSet;
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
        let this = PassSet::of(self.settings.seed, index..index + 1);
        if let Some((seed, passes)) = self.contains.overlap(&this) {
            return Err(Error::PassTwice { seed, passes });
        }
        let sent = self.emit_and_trace(index, self.settings.photons, observer)?;
        // If the first pass is cut short, it is a valid pass with fewer photons; a later one is discarded,
        // since the film is valid without it.
        if sent.cut && self.passes > 0 {
            self.on.timings()?;
            return Ok(PassEnd::Cancelled);
        }
        let seen = self.look(index, 0).and_then(|(queries, mut truncated)| {
            let gathered = self.estimate(index, &sent, queries)?;
            truncated = self.other_samples(index)?.unwrap_or(truncated);
            Ok((queries, truncated + gathered))
        });
        let (queries, truncated_camera_paths) = match seen {
            Ok(seen) => seen,
            Err(error) => {
                // The contributions of earlier passes are kept.
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
}
