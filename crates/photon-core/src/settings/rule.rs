//! Settings by a rule from facts of a first pass, for a time, a preset or a target error.

use std::fmt;

use crate::radius::bandwidth;
use crate::settings::preset::Preset;
use crate::settings::{Area, Bandwidth, Direct, Estimator, Indirect, Settings};

/// Paths of the first pass on a CPU, and of a number of passes. With fewer, camera paths and shadow rays take most of a pass;
/// with more, a short render has too few passes to smooth these.
const PATHS: u32 = 65_536;

/// Likewise on a GPU, which traces fewer of them in hardly less time: they would not fill its lanes.
const PATHS_OF_GPU: u32 = 400_000;

/// Most paths for each pixel of a picture. The density of photons then allows radii of half a pixel, the least that are derived.
const PATHS_PER_PIXEL: u64 = 4;

/// Likewise on a GPU, where they cost hardly more. Radii are then smaller: at 128 × 128 pixels, glasses of milk and of wine, wax
/// and mist have 0.34 to 0.7 times the error of that with 4.
const PATHS_PER_PIXEL_OF_GPU: u64 = 32;

/// Share of a pixel's light from which its caustic is visible: noise of it then exceeds that of all other light.
pub(crate) const VISIBLE_CAUSTIC: f64 = 0.2;

/// Share of the pixels with visible caustics from which radii per pixel pay on a CPU. Error statistics add a third to the time of
/// an estimate everywhere, and halve the error at caustics, which is tens of times that of other pixels.
const CAUSTIC_PIXELS: f64 = 0.05;

/// Share of indirect light from which it dominates: twice all other light. Each of its two parts, the noise of other light and the
/// cost of more rays, then weighs less than the blotches of maps.
const MOST_INDIRECT: f64 = 2.0 / 3.0;

/// Shadow rays of a query of a number of passes where direct light exceeds indirect light: their variance is about
/// `(2/8)^(3/2)` of that of two, and as they start at one point, they take less time than as many camera paths.
const SHADOW_RAYS: u32 = 8;

/// Most camera samples of a pass, and most shadow rays of a query: with as many, a pass takes hardly less time for each of them, and
/// a first picture is not late.
const MOST: f64 = 64.0;

/// Least number of passes for final gathering: the noise of its rays falls with the number of passes, and is then below the
/// blotches of a map, whose radii shrink slower.
const GATHERING_PASSES: f64 = 32.0;

/// Settings that the caller has fixed; the rule decides about the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
// Exhaustive: a caller decides about each.
pub struct Fixed {
    /// [`Settings::photons`].
    pub photons: bool,
    /// [`Settings::area`].
    pub area: bool,
    /// [`Settings::bandwidth`].
    pub bandwidth: bool,
    /// [`Settings::indirect`] and [`Settings::gather_rays`].
    pub indirect: bool,
    /// [`Settings::shadow_rays`].
    pub shadow_rays: bool,
    /// [`Settings::camera_samples`].
    pub camera_samples: bool,
}

impl Fixed {
    /// All of them.
    pub const ALL: Self =
        Self { photons: true, area: true, bandwidth: true, indirect: true, shadow_rays: true, camera_samples: true };

    /// Those whose fields of [`Settings`] are given, by name.
    #[must_use]
    pub fn given(is_given: impl Fn(&str) -> bool) -> Self {
        Self {
            photons: is_given("photons"),
            area: is_given("area"),
            bandwidth: is_given("bandwidth"),
            indirect: is_given("indirect"),
            shadow_rays: is_given("shadow_rays"),
            camera_samples: is_given("camera_samples"),
        }
    }
}

/// Circumstances of a render on which the rule depends.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: a caller decides about each.
pub struct Circumstances {
    /// Seconds for everything that is left to do; `None` for a number of passes, or an error.
    pub seconds: Option<f64>,
    /// Pixels of the picture.
    pub pixels: u64,
    /// Whether a GPU renders: [`crate::TransportBackend::is_gpu`].
    pub is_gpu: bool,
    /// What is not decided.
    pub fixed: Fixed,
}

/// Facts that the rule needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FirstPass {
    /// Share of the pixels that show caustics.
    pub caustic_pixels: f64,
    /// Share of direct light in the light of a pixel, mean over the pixels that show a surface.
    pub direct: f64,
    /// Share of light that was scattered diffusely before, likewise.
    pub indirect: f64,
    /// Most paths for which memory suffices anyway; `None`: any number.
    pub most_paths: Option<u32>,
    /// Expected seconds of a pass of the whole picture that are proportional to its paths.
    pub photon_seconds: f64,
    /// The other seconds of such a pass.
    pub other_seconds: f64,
    /// Its seconds without those of one camera sample among several.
    pub once_seconds: f64,
    /// Expected seconds of one camera path for each pixel, without shadow rays, in a sample among several.
    pub camera_seconds: f64,
    /// Expected seconds of one shadow ray for each query, likewise.
    pub shadow_ray_seconds: f64,
    /// Expected seconds of a pass with one camera sample, without shadow rays.
    pub alone_seconds: f64,
    /// Expected seconds of one shadow ray for each query in such a pass.
    pub alone_ray_seconds: f64,
    /// Relative variance of a pixel by the choice of a camera path, mean over the lit pixels.
    pub camera_noise: f64,
    /// Relative variance by the choice of shadow rays, times the power 3/2 of their number.
    pub shadow_noise: f64,
    /// Relative variance of the light that is read from the maps once in a pass.
    pub map_noise: f64,
    /// Whether there was no time to measure these three, which are 0 then.
    pub lacks_noise: bool,
    /// Expected seconds of one final-gather ray for each pixel: a ray and an estimate where it lands.
    pub gather_ray_seconds: f64,
    /// Seconds of compiling the kernels that are in use: about those that final gathering takes.
    pub compile_seconds: f64,
    /// Seconds that are left for the render after it; infinite without a limit.
    pub seconds_left: f64,
}

impl FirstPass {
    /// The numbers of camera samples n of a pass and shadow rays r of a query for the least variance in a time, where they are not
    /// given.
    ///
    /// A pass takes `a + n (c + r s)` seconds and has at most the variance `m + v/n`, where `v` is that of a camera path plus
    /// `w r^(−3/2)`: what evenly spread points leave of an integrand with edges. The product is least with
    /// `n² = a v / ((c + r s) m)`, and r by [`Self::best_rays`]. With n = 1, c and v are those of the whole pass. At most as many
    /// samples as let a few passes end in time.
    fn samples_and_rays(&self, samples: Option<u32>, rays: Option<u32>) -> (u32, u32) {
        let Self { camera_seconds: camera, shadow_ray_seconds: ray, camera_noise, map_noise, .. } = *self;
        let once = self.once_seconds;
        let best_rays =
            |seconds: f64, ray: f64, noise: f64| rays.unwrap_or_else(|| self.best_rays(seconds, ray, noise));
        let rays_of_sample = best_rays(camera, ray, camera_noise);
        let sample = camera + f64::from(rays_of_sample) * ray;
        let in_time = (self.seconds_left / f64::from(Preset::Preview.passes()) - once) / sample;
        let found = match samples {
            Some(samples) => samples,
            None => {
                let noise = camera_noise + self.shadow_noise * f64::from(rays_of_sample).powf(-1.5);
                number((once * noise / (sample * map_noise)).sqrt()).min(number(in_time))
            }
        };
        let alone = || best_rays(self.alone_seconds, self.alone_ray_seconds, map_noise + camera_noise);
        let rays = if found > 1 { rays_of_sample } else { alone() };
        (found, rays)
    }

    /// The number of shadow rays r for which `(c + r s) (v + w r^(−3/2))` is least, with `seconds` c, `ray` s and `noise` v: the
    /// fixed point of `r^(5/2) = w (3 c + r s) / (2 s v)`. Each step takes the ratio to it to the power 2/5 or less.
    fn best_rays(&self, seconds: f64, ray: f64, noise: f64) -> u32 {
        let mut rays = 1.0_f64;
        for _ in 0..16 {
            let power = self.shadow_noise * (3.0 * seconds + rays * ray) / (2.0 * ray * noise);
            rays = power.powf(0.4).clamp(1.0, MOST);
        }
        number(rays)
    }
}

/// The nearest permitted number; the least of them if there is nothing to weigh, so that `found` is not a number.
fn number(found: f64) -> u32 {
    if found > 1.0 { found.min(MOST).round() as u32 } else { 1 }
}

impl FirstPass {
    /// Seconds of a pass with these settings that do not belong to photons, nor to final gathering that is
    /// taken only now.
    fn seconds_of_others(&self, settings: &Settings) -> f64 {
        let [samples, rays] = [settings.camera_samples, settings.shadow_rays].map(f64::from);
        let seen = if settings.camera_samples == 1 {
            self.alone_seconds + rays * self.alone_ray_seconds
        } else {
            self.once_seconds + samples * (self.camera_seconds + rays * self.shadow_ray_seconds)
        };
        (seen - self.photon_seconds).max(self.other_seconds)
    }

    /// Factor on the number of paths of a pass that is to take `each` seconds, and takes `others` without photons: a power of two,
    /// so that renders seldom differ. There are fewer paths, by the nearest of them, if they do not fit; but where the rest of a pass
    /// takes longer than they do, fewer hardly help.
    ///
    /// If their number may rise, as on a GPU, there are more, as long as they do not take longer than the rest: half as many
    /// passes with twice the paths have smaller radii and the same noise. On a CPU, whose passes are few, noise is all that is
    /// seen.
    fn photon_share(&self, each: f64, others: f64, may_rise: bool) -> f64 {
        let fewer = ((each - others).max(others) / self.photon_seconds).log2().round();
        let more = if may_rise { others.min(each - others) / self.photon_seconds } else { 1.0 };
        match (fewer < 0.0, more >= 2.0 && more.is_finite()) {
            (true, _) => fewer.exp2(),
            (false, true) => more.log2().floor().exp2(),
            (false, false) => 1.0,
        }
    }
}

/// Most paths of a pass of a picture.
fn most_photons(within: &Circumstances) -> u32 {
    let of_pixel = if within.is_gpu { PATHS_PER_PIXEL_OF_GPU } else { PATHS_PER_PIXEL };
    of_pixel.saturating_mul(within.pixels).clamp(1, u64::from(u32::MAX)) as u32
}

/// Settings that were decided by the rule, and the facts. Displayed as two lines of plain text.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Decision {
    /// All settings.
    pub settings: Settings,
    /// The facts.
    pub first: FirstPass,
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Settings { photons, area, bandwidth, camera_samples, shadow_rays, indirect, gather_rays, .. } =
            &self.settings;
        let area = match area {
            Area::Surface => "areas on surfaces",
            Area::Disc => "areas of discs",
        };
        let radii = match bandwidth {
            Bandwidth::PerPixel => "radii of each pixel",
            Bandwidth::Shared => "shared radii",
        };
        let samples = if *camera_samples == 1 { "camera sample" } else { "camera samples" };
        let rays = if *shadow_rays == 1 { "shadow ray" } else { "shadow rays" };
        write!(
            f,
            "settings: {photons} paths and {camera_samples} {samples} a pass, {area}, {radii}, {shadow_rays} {rays}"
        )?;
        if *indirect == Indirect::Gather {
            write!(f, ", {gather_rays} final-gather rays")?;
        }
        let [caustic, direct, indirect] =
            [self.first.caustic_pixels, self.first.direct, self.first.indirect].map(|share| 100.0 * share);
        write!(
            f,
            "\nbecause {caustic:.0} % of the pixels show caustics; of the light {direct:.0} % is direct, {indirect:.0} % indirect"
        )
    }
}

impl Settings {
    /// Settings of the first pass, whose facts decide the others.
    #[must_use]
    pub fn for_first_pass(&self, within: &Circumstances) -> Self {
        let Circumstances { is_gpu, fixed, .. } = *within;
        let mut settings = self.clone();
        if !fixed.area && !matches!(settings.estimator, Estimator::Paper(_)) {
            settings.area = Area::Surface;
        }
        if !fixed.photons {
            settings.photons = most_photons(within).min(if is_gpu { PATHS_OF_GPU } else { PATHS });
        }
        if !fixed.bandwidth {
            settings.set_bandwidth(is_gpu, self.errors);
        }
        if !fixed.camera_samples {
            settings.camera_samples = 1;
        }
        settings
    }

    /// Settings by the facts of the first pass with [`Settings::for_first_pass`].
    ///
    /// Radii are those of each pixel where caustics are visible, unless the time ends before they are updated, and on a GPU
    /// everywhere. For a number of passes, and in a time in which noise is not measured, there are more shadow rays where direct
    /// light exceeds indirect light. Otherwise, camera samples and shadow rays are as many as remove most noise in the time. Within
    /// a time, final gathering is taken where indirect light dominates, if there is time enough for it and for compiling its
    /// kernels, and paths are fewer if hardly a pass would fit, and more on a GPU where the rest of a pass takes longer.
    /// Decisions depend on shares of the light, but for those within a time, which depend on seconds too.
    #[must_use]
    pub fn for_time(&self, within: &Circumstances, first: &FirstPass) -> Self {
        let Circumstances { is_gpu, fixed, .. } = *within;
        let mut settings = self.for_first_pass(within);
        if !fixed.bandwidth {
            // Before their first update they only take longer; on a GPU, so would compiling the kernels of shared radii.
            let first_update = f64::from(bandwidth::FIRST) * (first.photon_seconds + first.other_seconds);
            let is_updated = within.seconds.is_none() || first_update <= first.seconds_left;
            let pays = is_gpu || (is_updated && first.caustic_pixels >= CAUSTIC_PIXELS);
            settings.set_bandwidth(pays, self.errors);
        }
        let has_rays = !fixed.shadow_rays && settings.direct == Direct::Nee;
        let by_shares = within.seconds.is_none() || first.lacks_noise;
        if by_shares && has_rays && first.direct > first.indirect {
            settings.shadow_rays = settings.shadow_rays.max(SHADOW_RAYS);
        }
        if within.seconds.is_none() {
            return settings;
        }
        let gathering = f64::from(settings.gather_rays) * first.gather_ray_seconds;
        let passes = GATHERING_PASSES * (first.photon_seconds + first.other_seconds + gathering);
        let is_enough = first.compile_seconds + passes <= first.seconds_left;
        let may = settings.indirect == Indirect::Map && !(fixed.bandwidth && settings.bandwidth == Bandwidth::PerPixel);
        let begins_gathering = !fixed.indirect && may && first.indirect >= MOST_INDIRECT && is_enough;
        if begins_gathering {
            settings.set_bandwidth(false, self.errors);
            settings.indirect = Indirect::Gather;
        }
        let has_many = !fixed.camera_samples && settings.indirect != Indirect::Gather;
        if !by_shares {
            let samples = (!has_many).then_some(settings.camera_samples);
            let rays = (!has_rays).then_some(settings.shadow_rays);
            (settings.camera_samples, settings.shadow_rays) = first.samples_and_rays(samples, rays);
        }
        if !fixed.photons {
            let (each, gathering) = if begins_gathering {
                ((first.seconds_left - first.compile_seconds) / GATHERING_PASSES, gathering)
            } else {
                (first.seconds_left / f64::from(Preset::Preview.passes()), 0.0)
            };
            let others = first.seconds_of_others(&settings) + gathering;
            // With a limit on memory, the first pass may have had fewer than asked for.
            let share = first.photon_share(each, others, is_gpu && settings.memory.is_none());
            let most = most_photons(within).min(first.most_paths.unwrap_or(u32::MAX)).max(settings.photons);
            settings.photons = (f64::from(settings.photons) * share).clamp(1.0, f64::from(most)) as u32;
        }
        settings
    }

    /// Radii of each pixel if `per_pixel` and the other settings allow it, with error estimates, which are otherwise those that
    /// were `asked` for.
    fn set_bandwidth(&mut self, per_pixel: bool, asked: bool) {
        let may = matches!(self.estimator, Estimator::Radius { .. }) && self.indirect != Indirect::Gather;
        // The plan for a limit on memory is that of the settings that were given.
        let per_pixel = per_pixel && may && self.memory.is_none();
        self.bandwidth = if per_pixel { Bandwidth::PerPixel } else { Bandwidth::Shared };
        self.errors = asked || per_pixel;
    }
}

#[cfg(test)]
mod tests;
