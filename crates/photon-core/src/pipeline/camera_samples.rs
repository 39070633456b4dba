//! Camera samples of a pass after the first: camera paths and direct light alone.

use super::Pipeline;
use super::photons::Sent;
use crate::backend::observer::{Event, Observer};
use crate::backend::stages::Pass;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::Layer;
use crate::scene::layout::Query;
use crate::settings::Direct;

/// Labels of memory.
const QUERIES: &str = "queries of camera samples";
const SEGMENTS: &str = "segments of camera samples";

impl<B: TransportBackend> Pipeline<B> {
    /// Adds the other camera samples of pass `index` to the light of the first, and averages: emission seen by the camera and
    /// direct light of shadow rays. What the first has read from the maps counts in full. If the observer stops it, which cuts
    /// the pass, there are fewer samples. Returns the number of camera paths of all samples that were truncated; `None` if there
    /// is one sample.
    pub(super) fn other_samples(
        &mut self,
        index: u32,
        sent: &mut Sent,
        observer: &mut dyn Observer,
    ) -> Result<Option<u64>> {
        let total = self.settings.camera_samples;
        let mut taken = 1;
        while taken < total {
            sent.stop |= observer.on_event(&Event::Samples { pass: index, taken, total }).is_break();
            if sent.stop {
                (sent.cut, sent.lacks_samples) = (true, true);
                if self.passes > 0 {
                    // It is abandoned: the film keeps its number of samples.
                    return Ok(None);
                }
                break;
            }
            let next = self.together.min(total - taken);
            self.camera_samples(index, taken, next)?;
            taken += next;
        }
        if taken == 1 {
            return Ok(None);
        }
        self.on.mark(Some(Stage::Film));
        let averaged: &[Layer] = match self.settings.direct {
            Direct::Nee => &[Layer::Emission, Layer::Direct],
            Direct::Photons | Direct::None => &[Layer::Emission],
        };
        self.on.average_samples(&mut self.film, averaged, taken)?;
        self.on.mark(None);
        self.stages.eye.truncated(&mut self.on).map(Some)
    }

    /// Traces the camera paths of `samples` samples of pass `index` together, and their shadow rays.
    pub(super) fn camera_samples(&mut self, index: u32, sample: u32, samples: u32) -> Result<()> {
        let pass = Pass { sample, samples, ..Pass::new(&self.settings, index) };
        if samples == 1 {
            return self.camera_rays(pass);
        }
        self.make_room(samples)?;
        self.swap_samples();
        let traced = self.camera_rays(pass).and_then(|()| {
            self.on.mark(Some(Stage::Film));
            self.on.add_samples(&mut self.film, samples)
        });
        self.on.mark(None);
        self.swap_samples();
        traced
    }

    /// Allocates queries and segments for as many camera samples, if there is less room.
    fn make_room(&mut self, samples: u32) -> Result<()> {
        if samples <= self.sample_room {
            return Ok(());
        }
        self.free_samples();
        let of_one = self.on.fill(&self.queries)?.capacity;
        self.sample_queries = Some(self.on.alloc(QUERIES, of_one * u64::from(samples))?);
        if let Some(segments) = &self.segments {
            let of_one = self.on.fill(segments)?.capacity;
            self.sample_segments = Some(self.on.alloc(SEGMENTS, of_one * u64::from(samples))?);
        }
        self.sample_room = samples;
        Ok(())
    }

    /// Frees the queries and segments of several samples.
    fn free_samples(&mut self) {
        (self.sample_room, self.sample_queries, self.sample_segments) = (0, None, None);
    }

    /// Takes other numbers of camera samples and shadow rays from now on.
    ///
    /// # Errors
    /// Errors of the backend.
    pub(super) fn set_samples(&mut self, camera_samples: u32, shadow_rays: u32) -> Result<()> {
        (self.settings.camera_samples, self.settings.shadow_rays) = (camera_samples, shadow_rays);
        self.asked_rays[..2].copy_from_slice(&[camera_samples, shadow_rays]);
        if camera_samples == 1 && self.sample_room > 0 {
            self.free_samples();
            // So that the report of memory has them no more.
            self.on.alloc::<Query>(QUERIES, 0)?;
            if self.segments.is_some() {
                self.on.alloc::<Query>(SEGMENTS, 0)?;
            }
        }
        Ok(())
    }

    /// Exchanges the queries and segments of one camera sample for those of several, or back.
    fn swap_samples(&mut self) {
        if let Some(queries) = &mut self.sample_queries {
            std::mem::swap(&mut self.queries, queries);
            std::mem::swap(&mut self.segments, &mut self.sample_segments);
        }
    }

    /// Traces the camera paths of the samples of `pass`, and their shadow rays.
    fn camera_rays(&mut self, pass: Pass) -> Result<()> {
        self.camera_paths(pass)?;
        self.direct_light(pass, pass.sample)?;
        self.on.mark(None);
        Ok(())
    }

    /// Adds the light of shadow rays from the queries of a camera sample, and from its segments in media, if there are any. They
    /// have the random numbers of camera sample `shadow_sample`.
    pub(super) fn direct_light(&mut self, pass: Pass, shadow_sample: u32) -> Result<()> {
        let shadows = Pass { sample: shadow_sample, ..pass };
        let rays = self.settings.shadow_rays;
        if let (Some(media), Some(segments), Direct::Nee) =
            (&mut self.stages.media, &self.segments, self.settings.direct)
        {
            self.on.mark(Some(Stage::Direct));
            media.direct.light(&mut self.on, &self.scene, shadows, segments, rays, &mut self.film)?;
        }
        if let Some(direct) = &mut self.stages.direct {
            self.on.mark(Some(Stage::Direct));
            direct.light(&mut self.on, &self.scene, shadows, &self.queries, rays, &mut self.film)?;
        }
        Ok(())
    }
}
