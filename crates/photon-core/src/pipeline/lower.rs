//! Fewer camera samples, paths and rays of a pass that would take longer than there is time.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use super::Pipeline;
use super::small_pass::Seconds;
use crate::backend::TransportBackend;
use crate::error::Result;
use crate::radius::radii;

/// Paths and pixels of the pass that is timed on a CPU. On few photons and pixels much of the time is that of starting threads: what a whole
/// pass takes is overestimated, which costs little, as there are more passes then.
const PATHS: f64 = 8192.0;
const PIXELS: f64 = 1024.0;

/// Seconds that a pass may take, however little time there is.
const LEAST: f64 = 0.05;

impl<B: TransportBackend> Pipeline<B> {
    /// See [`crate::Render::lower`].
    pub(super) fn lowered(&mut self, time: Duration) -> Result<Option<String>> {
        // Passes of a film are alike.
        if self.passes > 0 {
            return Ok(None);
        }
        let begun = Instant::now();
        let (small, paths) = self.telling_size(PIXELS, PATHS);
        let left = || time.saturating_sub(begun.elapsed()).as_secs_f64();
        let small_pass = self.small_pass(small, paths, (0, 0), self.settings.camera_samples > 1)?;
        let (mut timed, sample) = (small_pass.whole, small_pass.camera + small_pass.sample_shadow_rays);
        // Many photons take longer than in proportion to few, which are in the cache.
        let more = f64::from(self.settings.photons) * (left() / 16.0 / timed.photons).min(1.0);
        if timed.total() > left() / 4.0 && more > 2.0 * f64::from(paths) {
            timed.photons = self.small_pass(small, more as u32, (0, 0), false)?.whole.photons;
        }
        let left = left();
        let most = (left / 2.0).max(LEAST);
        let others = f64::from(self.settings.camera_samples - 1);
        let total = timed.total() + others * sample;
        if total <= most {
            return Ok(None);
        }
        // Further camera samples only remove noise that more passes remove too.
        let fitting = ((most - timed.total()) / sample).clamp(0.0, others) as u32 + 1;
        let shares = shares(&timed, most);
        let lowered = |count: u32, share: f64| ((f64::from(count) * share) as u32).max(1);
        let before = self.settings.clone();
        let settings = &mut self.settings;
        settings.camera_samples = fitting;
        settings.photons = lowered(before.photons, shares.photons);
        settings.shadow_rays = lowered(before.shadow_rays, shares.shadow_rays);
        settings.gather_rays = lowered(before.gather_rays, shares.gather_rays);
        let wider = (f64::from(before.photons) / f64::from(settings.photons)).sqrt() as f32;
        for slot in &mut self.maps {
            if let Some((by_density, least)) = slot.derived {
                slot.derived = Some((by_density * wider, least));
                slot.radius = radii::scaled((by_density * wider).max(least), before.radius_factor as f32);
            }
        }
        let mut text = format!("a pass would take about {total:.1} s, of {left:.1} s that are left; a pass has");
        let mut comma = "";
        for (what, before, now) in [
            ("camera samples", before.camera_samples, self.settings.camera_samples),
            ("paths", before.photons, self.settings.photons),
            ("shadow rays", before.shadow_rays, self.settings.shadow_rays),
            ("final-gather rays", before.gather_rays, self.settings.gather_rays),
        ] {
            if now < before {
                let _ = write!(text, "{comma} {now} {what} instead of {before}");
                comma = ",";
            }
        }
        let least = timed.least(&shares);
        if least > left {
            let _ = write!(text, "{comma} and takes about {least:.1} s even so: fewer pixels take less");
        }
        Ok(Some(text))
    }
}

impl Seconds {
    /// Those of a pass with these shares of its paths and rays.
    fn least(&self, shares: &Self) -> f64 {
        self.photons * shares.photons
            + self.shadow_rays * shares.shadow_rays
            + self.gather_rays * shares.gather_rays
            + self.others
    }
}

/// The shares of paths and rays with which a pass takes `most` seconds: what takes longest is lowered, and what takes less than its
/// part of the time is not. An eighth is for them even where the rest takes all of it.
fn shares(timed: &Seconds, most: f64) -> Seconds {
    let mut parts = [timed.photons, timed.shadow_rays, timed.gather_rays];
    parts.sort_unstable_by(f64::total_cmp);
    let mut left = (most - timed.others).max(most / 8.0);
    let mut cap = left;
    for (index, part) in parts.into_iter().enumerate() {
        cap = left / (parts.len() - index) as f64;
        left -= part.min(cap);
    }
    let share = |part: f64| if part > cap { cap / part } else { 1.0 };
    Seconds {
        photons: share(timed.photons),
        shadow_rays: share(timed.shadow_rays),
        gather_rays: share(timed.gather_rays),
        others: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_longest_is_lowered_to_the_time() {
        let timed = |photons, shadow_rays, gather_rays, others| Seconds { photons, shadow_rays, gather_rays, others };
        let of = |timed: Seconds, most| {
            let shares = shares(&timed, most);
            let parts = [shares.photons, shares.shadow_rays, shares.gather_rays];
            (parts, timed.least(&shares))
        };
        assert_eq!(of(timed(12.0, 0.25, 0.0, 0.75), 2.0), ([1.0 / 12.0, 1.0, 1.0], 2.0));
        assert_eq!(of(timed(8.0, 0.5, 16.0, 1.5), 4.0), ([0.125, 1.0, 0.0625], 4.0));
        assert_eq!(of(timed(8.0, 8.0, 8.0, 1.0), 4.0), ([0.125; 3], 4.0));
        // The picture alone takes longer.
        assert_eq!(of(timed(4.0, 0.0, 0.0, 9.0), 4.0), ([0.125, 1.0, 1.0], 9.5));
    }
}
