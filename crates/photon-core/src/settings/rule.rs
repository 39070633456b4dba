//! Settings by a rule from facts of a first pass, for a time, a preset or a target error.

use std::fmt;

use crate::settings::preset::Preset;
use crate::settings::{Area, Bandwidth, Direct, Estimator, Indirect, Settings};

/// Paths of a pass on a CPU. With fewer, camera paths and shadow rays take most of a pass; with more, a short render has too few
/// passes to smooth these.
const PATHS: u32 = 65_536;

/// Paths of a pass on a GPU, which traces fewer of them in hardly less time: they would not fill its lanes.
const PATHS_OF_GPU: u32 = 400_000;

/// Most paths for each pixel of a picture. The density of photons then allows radii of half a pixel, the least that are derived.
const PATHS_PER_PIXEL: u64 = 4;

/// Share of a pixel's light from which its caustic is visible: noise of it then exceeds that of all other light.
pub(crate) const VISIBLE_CAUSTIC: f64 = 0.2;

/// Share of the pixels with visible caustics from which radii per pixel pay on a CPU. Error statistics add a third to the time of
/// an estimate everywhere, and halve the error at caustics, which is tens of times that of other pixels.
const CAUSTIC_PIXELS: f64 = 0.05;

/// Share of indirect light from which it dominates: twice all other light. Each of its two parts, the noise of other light and the
/// cost of more rays, then weighs less than the blotches of maps.
const MOST_INDIRECT: f64 = 2.0 / 3.0;

/// Shadow rays of a query where direct light exceeds indirect light: of its variance a quarter remains of that with two, and as they start
/// at one point, they take less time than as many camera paths.
const SHADOW_RAYS: u32 = 8;

/// Most camera samples of a pass. The photons of a pass of which they take as long as half a sample are then less than a hundredth of
/// it, and a first picture is not late.
const MOST_CAMERA_SAMPLES: f64 = 64.0;

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
    /// Expected seconds of a pass of the whole picture that are proportional to its paths.
    pub photon_seconds: f64,
    /// The other seconds of such a pass.
    pub other_seconds: f64,
    /// Expected seconds of each further camera sample of the whole picture: camera paths and shadow rays.
    pub camera_sample_seconds: f64,
    /// Relative variance of a pixel by the light that camera samples find, mean over the pixels that show a surface; it is that of
    /// one sample.
    pub camera_noise: f64,
    /// The same by the light that is read from the maps once in a pass.
    pub map_noise: f64,
    /// Expected seconds of one final-gather ray for each pixel: a ray and an estimate where it lands.
    pub gather_ray_seconds: f64,
    /// Seconds of compiling the kernels that are in use: about those that final gathering takes.
    pub compile_seconds: f64,
    /// Seconds that are left for the render after it; infinite without a limit.
    pub seconds_left: f64,
}

impl FirstPass {
    /// The number of camera samples n in a pass for the least variance in a time: a pass takes `a + n s` seconds and has the
    /// variance `m + c/n`, whose product is least with `n² = a c / (s m)`. At most as many as let a few passes end in time.
    fn camera_samples(&self) -> u32 {
        let Self { camera_sample_seconds: sample, camera_noise, map_noise, .. } = *self;
        let once = (self.photon_seconds + self.other_seconds - sample).max(0.0);
        if !(camera_noise > 0.0 && sample > 0.0) {
            return 1;
        }
        let best = (once * camera_noise / (sample * map_noise)).sqrt();
        let in_time = (self.seconds_left / f64::from(Preset::Preview.passes()) - once) / sample;
        // NaN if there is no other work and no other noise.
        if best.is_nan() { 1 } else { best.min(in_time).clamp(1.0, MOST_CAMERA_SAMPLES).round() as u32 }
    }
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
        write!(
            f,
            "settings: {photons} paths and {camera_samples} {samples} a pass, {area}, {radii}, {shadow_rays} shadow rays"
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
        let Circumstances { pixels, is_gpu, fixed, .. } = *within;
        let mut settings = self.clone();
        if !fixed.area && !matches!(settings.estimator, Estimator::Paper(_)) {
            settings.area = Area::Surface;
        }
        if !fixed.photons {
            let most = if is_gpu { PATHS_OF_GPU } else { PATHS };
            let each = PATHS_PER_PIXEL.saturating_mul(pixels).clamp(1, u64::from(u32::MAX)) as u32;
            settings.photons = most.min(each);
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
    /// Radii are those of each pixel where caustics are visible, and on a GPU everywhere. Where direct light exceeds indirect light there are
    /// more shadow rays. Within a time, camera samples are as many as remove most noise in it, final gathering is taken where indirect light dominates, if there is time enough for it and for
    /// compiling its kernels, and paths are fewer if hardly a pass would fit. Decisions depend on shares of the light, but for the
    /// last three, which depend on seconds too.
    #[must_use]
    pub fn for_time(&self, within: &Circumstances, first: &FirstPass) -> Self {
        let Circumstances { is_gpu, fixed, .. } = *within;
        let mut settings = self.for_first_pass(within);
        if !fixed.bandwidth {
            settings.set_bandwidth(is_gpu || first.caustic_pixels >= CAUSTIC_PIXELS, self.errors);
        }
        if !fixed.shadow_rays && settings.direct == Direct::Nee && first.direct > first.indirect {
            settings.shadow_rays = settings.shadow_rays.max(SHADOW_RAYS);
        }
        if within.seconds.is_none() {
            return settings;
        }
        if !fixed.photons {
            // As many passes as of a preview. Fewer paths hardly help if the rest of a pass takes longer than they do.
            let each = first.seconds_left / f64::from(Preset::Preview.passes());
            let for_photons = (each - first.other_seconds).max(first.other_seconds);
            if for_photons < first.photon_seconds {
                settings.photons = (f64::from(settings.photons) * for_photons / first.photon_seconds).max(1.0) as u32;
            }
        }
        let gathering = f64::from(settings.gather_rays) * first.gather_ray_seconds;
        let passes = GATHERING_PASSES * (first.photon_seconds + first.other_seconds + gathering);
        let is_enough = first.compile_seconds + passes <= first.seconds_left;
        let may = settings.indirect == Indirect::Map && !(fixed.bandwidth && settings.bandwidth == Bandwidth::PerPixel);
        if !fixed.indirect && may && first.indirect >= MOST_INDIRECT && is_enough {
            settings.set_bandwidth(false, self.errors);
            settings.indirect = Indirect::Gather;
        } else if !fixed.camera_samples && settings.indirect != Indirect::Gather {
            settings.camera_samples = first.camera_samples();
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
            (plain, (65_536, false, false, 2), (400_000, true, false, 2)),
            (caustics, (65_536, true, false, 2), (400_000, true, false, 2)),
            (lit, (65_536, false, false, 8), (400_000, true, false, 8)),
            (indirect, (65_536, false, true, 2), (400_000, false, true, 2)),
            (dear, (65_536, false, true, 2), (400_000, false, true, 2)),
            (FirstPass { compile_seconds: 9.0, ..dear }, (65_536, false, false, 2), (400_000, true, false, 2)),
        ] {
            assert_eq!(decided(first, &cpu), on_cpu, "{first:?}");
            assert_eq!(decided(first, &gpu), on_gpu, "{first:?}");
        }
        // A number of passes has no time that final gathering could pay in.
        assert!(!decided(indirect, &within(None, false, OPEN)).2);
        let fixed = within(Some(60.0), true, Fixed::ALL);
        assert_eq!(
            Settings::default().for_time(&fixed, &FirstPass { caustic_pixels: 1.0, ..indirect }),
            Settings::default()
        );
    }

    #[test]
    fn camera_samples_balance_time_and_noise() {
        let samples = |once: f64, sample: f64, camera_noise, map_noise, seconds_left| {
            let (photon_seconds, other_seconds) = (0.75 * once, 0.25 * once + sample);
            let noise = FirstPass { camera_sample_seconds: sample, camera_noise, map_noise, ..FirstPass::default() };
            let first = FirstPass { photon_seconds, other_seconds, seconds_left, ..noise };
            let of = |within: &Circumstances| Settings::default().for_time(within, &first).camera_samples;
            assert_eq!(of(&within(None, false, OPEN)), 1, "a number of passes has no time to save");
            assert_eq!(of(&within(Some(9.0), false, Fixed { camera_samples: true, ..OPEN })), 1);
            of(&within(Some(9.0), false, OPEN))
        };
        assert_eq!(samples(4.0, 1.0, 9.0, 1.0, 1e9), 6);
        assert_eq!(samples(1.0, 1.0, 1.0, 1.0, 1e9), 1);
        assert_eq!(samples(1.0, 4.0, 1.0, 9.0, 1e9), 1);
        // All noise is of the camera, all of the maps, or there is none.
        assert_eq!(samples(1.0, 1.0, 1.0, 0.0, 1e9), 64);
        assert_eq!(samples(1.0, 1.0, 0.0, 1.0, 1e9), 1);
        assert_eq!(samples(1.0, 1.0, 0.0, 0.0, 1e9), 1);
        // Nothing is done once in a pass.
        assert_eq!(samples(0.0, 1.0, 1.0, 0.0, 1e9), 1);
        // In a short time, a preview's passes have to fit.
        let passes = f64::from(Preset::Preview.passes());
        assert_eq!(samples(4.0, 1.0, 900.0, 1.0, 10.0 * passes), 6);
        assert_eq!(samples(4.0, 1.0, 900.0, 1.0, 0.0), 1);
    }

    #[test]
    fn paths_are_fewer_in_small_pictures_and_short_times() {
        let few = Circumstances { pixels: 100, ..within(Some(9.0), false, OPEN) };
        assert_eq!(Settings::default().for_first_pass(&few).photons, 400);
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
