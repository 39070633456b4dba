//! Settings by a rule from facts of a first pass, for a time, a preset or a target error.

use std::fmt;

use crate::radius::bandwidth;
use crate::settings::preset::Preset;
use crate::settings::{Area, Bandwidth, Direct, Estimator, Indirect, Settings};

/// Paths of the first pass on a CPU, and of a number of passes. With fewer, camera paths and shadow rays take most of a pass; with
/// more, a short render has too few passes to smooth these.
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

/// Shadow rays of a query of a number of passes where direct light exceeds indirect light: of its variance a quarter remains of that with two, and as they start
/// at one point, they take less time than as many camera paths.
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
    /// Number of paths up to which memory is no matter; `None`: any.
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
    /// Relative variance of a pixel by the choice of a camera path, mean over the pixels that show a surface.
    pub camera_noise: f64,
    /// Relative variance by the choice of a shadow ray.
    pub shadow_noise: f64,
    /// Relative variance of the light that is read from the maps once in a pass.
    pub map_noise: f64,
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
    /// A pass takes `a + n (c + r s)` seconds and has the variance `m + (v + w/r)/n`, whose product is least with `r² = c w / (s v)`
    /// and `n² = a (v + w/r) / ((c + r s) m)`. With n = 1, c and v are those of the whole pass without shadow rays. At most as
    /// many samples as let a few passes end in time.
    fn samples_and_rays(&self, samples: Option<u32>, rays: Option<u32>) -> (u32, u32) {
        let Self { camera_seconds: camera, shadow_ray_seconds: ray, camera_noise, shadow_noise, map_noise, .. } = *self;
        let once = self.once_seconds;
        // NaN, if there is nothing to weigh: the least.
        let number = |square: f64| square.sqrt().clamp(1.0, MOST).max(1.0).round() as u32;
        let best_rays = |seconds: f64, ray: f64, noise: f64| match rays {
            Some(rays) => rays,
            None => number(seconds * shadow_noise / (ray * noise)),
        };
        let rays_of_sample = best_rays(camera, ray, camera_noise);
        let sample = camera + f64::from(rays_of_sample) * ray;
        let in_time = (self.seconds_left / f64::from(Preset::Preview.passes()) - once) / sample;
        let found = match samples {
            Some(samples) => samples,
            None => {
                let noise = camera_noise + shadow_noise / f64::from(rays_of_sample);
                number(once * noise / (sample * map_noise)).min(number(in_time.max(0.0).powi(2)))
            }
        };
        let alone = || best_rays(self.alone_seconds, self.alone_ray_seconds, map_noise + camera_noise);
        let rays = if found > 1 { rays_of_sample } else { alone() };
        (found, rays)
    }
}

impl FirstPass {
    /// Seconds of a pass with these settings that do not belong to photons.
    fn seconds_of_others(&self, settings: &Settings) -> f64 {
        let [samples, rays, gather_rays] =
            [settings.camera_samples, settings.shadow_rays, settings.gather_rays].map(f64::from);
        let seen = if settings.camera_samples == 1 {
            self.alone_seconds + rays * self.alone_ray_seconds
        } else {
            self.once_seconds + samples * (self.camera_seconds + rays * self.shadow_ray_seconds)
        };
        let gathered = if settings.indirect == Indirect::Gather { gather_rays * self.gather_ray_seconds } else { 0.0 };
        (seen - self.photon_seconds).max(self.other_seconds) + gathered
    }

    /// Factor on the number of paths of a pass that is to take `each` seconds, and `others` without photons. There are fewer paths if
    /// they do not fit; but where the rest of a pass takes longer than they do, fewer hardly help.
    ///
    /// On a GPU there are more, as long as they do not take longer than the rest: half as many passes with twice the paths have
    /// smaller radii and the same noise. On a CPU, whose passes are few, noise is all that is seen.
    fn photon_share(&self, each: f64, others: f64, is_gpu: bool) -> f64 {
        let fewer = (each - others).max(others) / self.photon_seconds;
        let more = if is_gpu { others.min(each - others) / self.photon_seconds } else { 1.0 };
        match (fewer < 1.0, more >= 2.0 && more.is_finite()) {
            (true, _) => fewer,
            // A power of two, so that renders seldom differ.
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
    /// everywhere. For a number of passes, there are more shadow rays where direct light exceeds indirect light. Within a time,
    /// camera samples and shadow rays are as many as remove most noise in it, final gathering is taken where indirect light
    /// dominates, if there is time enough for it and for compiling its kernels, and paths are fewer if hardly a pass would fit, and
    /// more on a GPU where the rest of a pass takes longer.
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
        if within.seconds.is_none() {
            if !fixed.shadow_rays && settings.direct == Direct::Nee && first.direct > first.indirect {
                settings.shadow_rays = settings.shadow_rays.max(SHADOW_RAYS);
            }
            return settings;
        }
        let gathering = f64::from(settings.gather_rays) * first.gather_ray_seconds;
        let passes = GATHERING_PASSES * (first.photon_seconds + first.other_seconds + gathering);
        let is_enough = first.compile_seconds + passes <= first.seconds_left;
        let may = settings.indirect == Indirect::Map && !(fixed.bandwidth && settings.bandwidth == Bandwidth::PerPixel);
        if !fixed.indirect && may && first.indirect >= MOST_INDIRECT && is_enough {
            settings.set_bandwidth(false, self.errors);
            settings.indirect = Indirect::Gather;
        }
        let has_many = !fixed.camera_samples && settings.indirect != Indirect::Gather;
        let has_rays = !fixed.shadow_rays && settings.direct == Direct::Nee;
        let samples = (!has_many).then_some(settings.camera_samples);
        let rays = (!has_rays).then_some(settings.shadow_rays);
        (settings.camera_samples, settings.shadow_rays) = first.samples_and_rays(samples, rays);
        if !fixed.photons {
            let each = if settings.indirect == Indirect::Gather {
                (first.seconds_left - first.compile_seconds) / GATHERING_PASSES
            } else {
                first.seconds_left / f64::from(Preset::Preview.passes())
            };
            let share = first.photon_share(each, first.seconds_of_others(&settings), is_gpu);
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
mod tests {
    use super::*;

    const OPEN: Fixed = Fixed {
        photons: false,
        area: false,
        bandwidth: false,
        indirect: false,
        shadow_rays: false,
        camera_samples: false,
    };

    fn within(seconds: Option<f64>, is_gpu: bool, fixed: Fixed) -> Circumstances {
        Circumstances { seconds, pixels: 512 * 512, is_gpu, fixed }
    }

    /// Paths, radii per pixel, final gathering, and shadow rays.
    fn decided(first: FirstPass, within: &Circumstances) -> (u32, bool, bool, u32) {
        let settings = Settings::default().for_time(within, &first);
        settings.validate().unwrap();
        assert_eq!(settings.area, Area::Surface);
        let per_pixel = settings.bandwidth == Bandwidth::PerPixel;
        assert_eq!(settings.errors, per_pixel, "statistics are kept for radii per pixel alone");
        (settings.photons, per_pixel, settings.indirect == Indirect::Gather, settings.shadow_rays)
    }

    #[test]
    fn each_fact_decides_its_setting() {
        let (cpu, gpu) = (within(Some(60.0), false, OPEN), within(Some(60.0), true, OPEN));
        let plain = FirstPass { direct: 0.4, indirect: 0.6, seconds_left: 60.0, ..FirstPass::default() };
        let caustics = FirstPass { caustic_pixels: 0.05, ..plain };
        let lit = FirstPass { direct: 0.61, ..plain };
        let indirect = FirstPass { indirect: 0.7, direct: 0.3, ..plain };
        // A pass with 16 rays takes 1.6 s: 32 of them and the kernels fit, or just not.
        let dear = FirstPass { photon_seconds: 0.1, other_seconds: 0.1, gather_ray_seconds: 1.4 / 16.0, ..indirect };
        for (first, on_cpu, on_gpu) in [
            (plain, (65_536, false, false, 1), (400_000, true, false, 1)),
            (caustics, (65_536, true, false, 1), (400_000, true, false, 1)),
            // Eight passes take 60 s, or a little longer.
            (FirstPass { other_seconds: 7.5, ..caustics }, (65_536, true, false, 1), (400_000, true, false, 1)),
            (FirstPass { other_seconds: 7.6, ..caustics }, (65_536, false, false, 1), (400_000, true, false, 1)),
            (indirect, (65_536, false, true, 1), (400_000, false, true, 1)),
            // 32 passes leave a quarter of a second for more paths, which take a tenth.
            (dear, (65_536, false, true, 1), (800_000, false, true, 1)),
            (FirstPass { compile_seconds: 9.0, ..dear }, (65_536, false, false, 1), (400_000, true, false, 1)),
        ] {
            assert_eq!(decided(first, &cpu), on_cpu, "{first:?}");
            assert_eq!(decided(first, &gpu), on_gpu, "{first:?}");
        }
        // Within a time, shadow rays depend on noise, of which there is none here.
        let rays = |first, is_gpu| decided(first, &within(None, is_gpu, OPEN)).3;
        assert_eq!([rays(plain, false), rays(lit, false), rays(lit, true)], [2, 8, 8]);
        // A number of passes has no time that final gathering could pay in.
        assert!(!decided(indirect, &within(None, false, OPEN)).2);
        let fixed = within(Some(60.0), true, Fixed::ALL);
        assert_eq!(
            Settings::default().for_time(&fixed, &FirstPass { caustic_pixels: 1.0, ..indirect }),
            Settings::default()
        );
    }

    #[test]
    fn camera_samples_and_shadow_rays_balance_time_and_noise() {
        let found = |first: FirstPass, fixed: Fixed| {
            let of = |within: &Circumstances| {
                let found = Settings { shadow_rays: 3, ..Settings::default() }.for_time(within, &first);
                (found.camera_samples, found.shadow_rays)
            };
            assert_eq!(of(&within(None, false, OPEN)), (1, 3), "a number of passes has no time to save");
            of(&within(Some(9.0), false, fixed))
        };
        // Seconds of what is done once, of a camera path and of a shadow ray; noise of the three.
        let first = |[once_seconds, camera_seconds, shadow_ray_seconds]: [f64; 3], [map, camera, shadow]: [f64; 3]| {
            let noise =
                FirstPass { map_noise: map, camera_noise: camera, shadow_noise: shadow, ..FirstPass::default() };
            let (alone_seconds, alone_ray_seconds) = (once_seconds + camera_seconds, shadow_ray_seconds);
            let alone = FirstPass { alone_seconds, alone_ray_seconds, ..noise };
            FirstPass { once_seconds, camera_seconds, shadow_ray_seconds, seconds_left: 1e9, ..alone }
        };
        let open = |seconds, noise| found(first(seconds, noise), OPEN);
        // A sample has 4 rays and takes 8 s; its variance is 2.
        assert_eq!(open([400.0, 4.0, 1.0], [1.0, 1.0, 4.0]), (10, 4));
        let some = first([400.0, 4.0, 1.0], [1.0, 1.0, 4.0]);
        assert_eq!(found(some, Fixed { camera_samples: true, ..OPEN }), (1, 28), "√(404 · 4 / 2)");
        assert_eq!(found(some, Fixed { shadow_rays: true, ..OPEN }), (12, 3), "√(400 · 7/3 / 7)");
        assert_eq!(found(some, Fixed { shadow_rays: true, camera_samples: true, ..OPEN }), (1, 3));
        // One sample: all noise is of maps, or of what shadow rays find.
        assert_eq!(open([9.0, 1.0, 1.0], [1.0, 0.0, 0.0]), (1, 1));
        assert_eq!(open([9.0, 1.0, 1.0], [1.0, 0.0, 10.0]), (1, 10));
        // Many: no noise is of maps; and as many as there is time for, in as many passes as of a preview.
        assert_eq!(open([9.0, 1.0, 1.0], [0.0, 1.0, 0.0]), (64, 1));
        let passes = f64::from(Preset::Preview.passes());
        let short = FirstPass { seconds_left: 19.0 * passes, ..first([9.0, 1.0, 1.0], [0.0, 1.0, 0.0]) };
        assert_eq!(found(short, OPEN), (5, 1));
        // Nothing at all.
        assert_eq!(open([0.0; 3], [0.0; 3]), (1, 1));
    }

    #[test]
    fn paths_are_fewer_in_small_pictures_and_short_times() {
        let few = Circumstances { pixels: 100, ..within(Some(9.0), false, OPEN) };
        assert_eq!(Settings::default().for_first_pass(&few).photons, 400);
        assert_eq!(Settings::default().for_first_pass(&Circumstances { is_gpu: true, ..few }).photons, 3200);
        let photons = |photon_seconds, other_seconds, seconds_left| {
            let first = FirstPass { photon_seconds, other_seconds, seconds_left, ..FirstPass::default() };
            decided(first, &within(Some(9.0), false, OPEN)).0
        };
        assert_eq!(photons(1.5, 0.5, 8.0), 65_536);
        assert_eq!(photons(1.5, 0.5, 5.0), 32_768);
        // Where the rest of a pass takes longer, fewer paths do not help.
        assert_eq!(photons(1.5, 1.5, 0.0), 65_536);
        assert_eq!(photons(2.0, 0.5, -1.0), 16_384);
        assert_eq!(photons(0.0, 0.0, 0.0), 65_536);
    }

    #[test]
    fn paths_are_more_on_a_gpu_whose_time_goes_elsewhere() {
        let photons = |photon_seconds, other_seconds, seconds_left, is_gpu| {
            let first = FirstPass { photon_seconds, other_seconds, seconds_left, ..FirstPass::default() };
            decided(first, &within(Some(9.0), is_gpu, OPEN)).0
        };
        assert_eq!(photons(0.1, 0.9, 60.0, true), 8 * 400_000);
        assert_eq!(photons(0.1, 0.9, 60.0, false), 65_536);
        assert_eq!(photons(0.1, 0.19, 60.0, true), 400_000);
        assert_eq!(photons(1e-9, 0.9, 60.0, true), 32 * 512 * 512);
        let few = FirstPass {
            most_paths: Some(500_000),
            photon_seconds: 0.1,
            other_seconds: 0.9,
            seconds_left: 60.0,
            ..FirstPass::default()
        };
        assert_eq!(decided(few, &within(Some(9.0), true, OPEN)).0, 500_000);
        // Four passes still fit: 0.8 s remain of each for photons, or less than nothing.
        assert_eq!(photons(0.1, 1.0, 7.2, true), 8 * 400_000);
        assert_eq!(photons(0.1, 1.0, 5.0, true), 2 * 400_000);
        assert_eq!(photons(0.1, 5.0, 8.0, true), 400_000);
        // Time for camera samples and their shadow rays belongs to the rest: 1 + 8 samples of 0.1 + 2 · 0.05 s.
        let first = FirstPass {
            photon_seconds: 0.1,
            once_seconds: 1.1,
            camera_seconds: 0.1,
            shadow_ray_seconds: 0.05,
            ..FirstPass::default()
        };
        let settings = Settings { camera_samples: 8, shadow_rays: 2, ..Settings::default() };
        assert!((first.seconds_of_others(&settings) - 2.6).abs() < 1e-12);
    }

    #[test]
    fn radii_per_pixel_need_an_estimator_that_has_them() {
        let first = FirstPass { caustic_pixels: 1.0, ..FirstPass::default() };
        let of = |settings: Settings| settings.for_time(&within(None, true, OPEN), &first).bandwidth;
        assert_eq!(of(Settings::default()), Bandwidth::PerPixel);
        let knn = Estimator::Knn { k: 50, max_radius: None };
        for other in [
            Settings { estimator: knn, ..Settings::default() },
            Settings { indirect: Indirect::Gather, ..Settings::default() },
            Settings { memory: Some(1 << 30), ..Settings::default() },
        ] {
            assert_eq!(of(other), Bandwidth::Shared);
        }
    }

    #[test]
    fn people_read_settings_and_reasons() {
        let first = FirstPass { caustic_pixels: 0.08, direct: 0.3, indirect: 0.7, ..FirstPass::default() };
        let settings = Settings { photons: 1000, indirect: Indirect::Gather, ..Settings::default() };
        let text = Decision { settings, first }.to_string();
        assert_eq!(text.lines().count(), 2, "{text}");
        assert!(
            text.contains("1000 paths and 1 camera sample a pass") && text.contains("16 final-gather rays"),
            "{text}"
        );
        assert!(text.contains("8 % of the pixels show caustics") && text.contains("30 % is direct, 70 %"), "{text}");
    }
}
