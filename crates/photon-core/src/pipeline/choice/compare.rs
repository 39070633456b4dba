//! The candidates of a choice, with what trials say about each.

use super::super::Pipeline;
use super::bias::reference;
use super::forecast::{
    GAIN_OF_CAUSTICS, GAIN_WITHOUT_CAUSTICS, Gain, Model, Trial, variance, weights, weights_of_mean, with_gather_rays,
};
use super::trials::widest;
use super::{Candidate, Choice, Goal, Open};
use crate::backend::TransportBackend;
use crate::backend::stages::View;
use crate::error::Result;
use crate::scene::SceneView;
use crate::scene::camera::Camera;
use crate::settings::{Area, Bandwidth};

/// Pictures of trials have this fraction of the width and of the height.
const REDUCTION: u32 = 5;

/// Least width and height of these pictures, if the picture has as many.
const MIN_SIZE: u32 = 40;

/// Camera paths of the whole picture, and then passes with each of the settings, are timed too if they take less than this part of
/// the time: small pictures do not fill a GPU. They do fill the cores of a CPU, where it would only cost time.
const TIMED_PART: f64 = 0.04;

/// Factors on radii that are tried, and those that may be chosen.
const TRIED_FACTORS: [f64; 3] = [0.7, 1.4, 2.0];
const POSSIBLE_FACTORS: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];

/// Those that may be chosen where photons are aimed and less than [`FEW_PIXELS`] of all pixels have caustics: the trials then do
/// not show the bias of wide radii.
const FACTORS_FOR_FEW: [f64; 3] = [0.5, 0.7, 1.0];

/// A smaller share of the pixels is few.
const FEW_PIXELS: f64 = 0.05;

/// Numbers of gather rays that are tried, and those that may be chosen.
const TRIED_RAYS: [u32; 2] = [1, 16];
const POSSIBLE_RAYS: [u32; 3] = [1, 4, 16];

/// [`TIMED_PART`] with final gathering, whose passes of the whole picture take long.
const TIMED_PART_OF_RAYS: f64 = 0.01;

/// Multiples of the number of paths that may be chosen.
const MULTIPLES: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];

/// Times that are tried for an error: from the first to the last second, each so many times the one before.
const SHORTEST: f64 = 0.05;
const LONGEST: f64 = 1e6;
const STEP: f64 = 1.2;

/// What two passes of a small picture, with the same settings of estimates and of gather rays, gave and took.
struct Measured {
    /// For each setting of the estimates.
    trials: Vec<Trial>,
    /// For each number of gather rays, or once without any: the radiance of each pixel in the two passes without that by photons
    /// at visible points.
    sampled: Vec<[Vec<f64>; 2]>,
    /// The same with photons at the visible points of each pass, by the [`widest`] setting.
    all: Vec<[Vec<f64>; 2]>,
    /// Seconds of the gather rays of a pass, for each number of them.
    gathering: Vec<f64>,
    /// The mean radiance of each pixel without that by photons at visible points.
    others: Vec<f64>,
    /// The share of the pixels that have caustics.
    caustic_share: f64,
    /// Seconds of a pass until there are photon maps: fixed, and proportional to the number of paths.
    photons: [f64; 2],
    /// Seconds of a pass for camera paths and direct light, which those of the trials contain.
    look: f64,
}

impl Measured {
    /// Small pictures do not fill a GPU: from the time that the whole picture takes for camera paths follow the others.
    fn rescale(&mut self, look: f64) {
        let part = if self.look > 0.0 { (look / self.look).clamp(0.0, 1.0) } else { 1.0 };
        self.trials.iter_mut().for_each(|trial| trial.seconds *= part);
        self.gathering.iter_mut().for_each(|seconds| *seconds *= part);
        self.look *= part;
    }
}

/// What the trials say about one kind of areas with one number of gather rays.
struct Compared {
    gather_rays: Option<u32>,
    area: Area,
    model: Model,
}

/// What can be forecast from trials, for any time.
pub(super) struct Comparison {
    compared: Vec<Compared>,
    /// Multiples of the number of paths, and factors on radii, that may be chosen.
    multiples: Vec<f64>,
    factors: &'static [f64],
    /// The present kind of radii, and what radii per pixel gain if they may be chosen instead.
    bandwidth: Bandwidth,
    per_pixel: Option<Gain>,
    /// The present number of paths, and seconds of a pass that are proportional to it.
    photons: u32,
    pub(super) photon_seconds: f64,
    /// Seconds of the preparation that another number of paths takes.
    setup: f64,
}

impl Comparison {
    /// The candidates for so many seconds of passes, by increasing error.
    pub(super) fn candidates(&self, seconds: f64) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for &Compared { gather_rays, area, ref model } in &self.compared {
            for &more in &self.multiples {
                let photons = (more * f64::from(self.photons)).min(f64::from(u32::MAX)) as u32;
                // Another number takes another pilot and other buffers; scene and kernels are kept.
                let seconds = if more == 1.0 { seconds } else { (seconds - self.setup).max(0.0) };
                let candidate = |bandwidth, radius_factor, [seconds, error, direct_error]: [f64; 3]| Candidate {
                    photons,
                    area,
                    radius_factor,
                    bandwidth,
                    gather_rays,
                    seconds,
                    error,
                    direct_error,
                };
                // Radii per pixel that were given are not compared with shared ones, and are forecast as if they were shared.
                let present = |&factor| candidate(self.bandwidth, factor, model.forecast(more, factor, seconds));
                candidates.extend(self.factors.iter().map(present));
                if let Some(gain) = self.per_pixel {
                    // They grow where light is smooth, even if shared ones may not be wider.
                    let forecast = model.forecast_per_pixel(more, &POSSIBLE_FACTORS, seconds, gain);
                    candidates.push(candidate(Bandwidth::PerPixel, 1.0, forecast));
                }
            }
        }
        candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
        candidates
    }

    /// The seconds of passes for this goal.
    pub(super) fn seconds(&self, goal: Goal) -> f64 {
        match goal {
            Goal::Time(seconds) => seconds,
            // The first has the present kind of areas.
            Goal::Passes(passes) => self.compared.first().map_or(0.0, |each| each.model.seconds_of(passes)),
            Goal::Error { error, most_seconds } => {
                let longest = LONGEST.min(most_seconds);
                let is_reached =
                    |seconds: &f64| self.candidates(*seconds).first().is_some_and(|best| best.error <= error * error);
                let mut times = std::iter::successors(Some(SHORTEST), |time| Some(STEP * time));
                times.by_ref().take_while(|time| *time < longest).find(is_reached).unwrap_or(longest)
            }
        }
    }
}

impl<B: TransportBackend> Pipeline<B> {
    /// What trials say about the settings that are `open`, and the seconds of passes for the goal.
    pub(super) fn compare(
        &mut self,
        scene: &SceneView<'_>,
        goal: Goal,
        (open, derived): (Open, bool),
    ) -> Result<(Comparison, f64)> {
        let areas: &[Area] = match (open.area, self.stages.area.is_some()) {
            (true, _) => &[Area::Surface, Area::Disc],
            (false, true) => &[Area::Surface],
            (false, false) => &[Area::Disc],
        };
        // Radii tell the bias, even if none may be chosen.
        let tried: &[f64] = if derived { &TRIED_FACTORS } else { &[1.0] };
        let settings: Vec<(Area, f64)> =
            areas.iter().flat_map(|&area| tried.iter().map(move |&factor| (area, factor))).collect();
        let (rays, timed_part): (&[u32], f64) =
            if open.gather_rays { (&TRIED_RAYS, TIMED_PART_OF_RAYS) } else { (&[], TIMED_PART) };
        let mut measured = self.measure(scene, rays, &settings)?;
        let mut comparison = self.comparison(&measured, &settings, areas, open);
        let mut seconds = comparison.seconds(goal);
        if measured.look < TIMED_PART * seconds {
            measured.rescale(self.time_look()?);
            comparison = self.comparison(&measured, &settings, areas, open);
            seconds = comparison.seconds(goal);
        }
        let all = measured.trials.iter().map(|trial| trial.seconds).chain(measured.gathering.iter().copied());
        if measured.photons[1] + all.sum::<f64>() < timed_part * seconds {
            let timed = self.time_whole(rays, &settings)?;
            measured.photons = timed.photons;
            measured.look = timed.look;
            measured.gathering = timed.gathering;
            let trials = measured.trials.iter_mut().zip(timed.shown);
            trials.for_each(|(trial, seconds)| trial.seconds = timed.look + seconds);
            comparison = self.comparison(&measured, &settings, areas, open);
            seconds = comparison.seconds(goal);
        }
        Ok((comparison, seconds))
    }

    fn comparison(&self, measured: &Measured, settings: &[(Area, f64)], areas: &[Area], open: Open) -> Comparison {
        let Measured { trials, sampled, all, gathering, others, caustic_share, photons, look } = measured;
        let (now, is_aimed) = (f64::from(self.settings.photons), self.stages.aimed.is_some());
        let multiples = MULTIPLES
            .iter()
            .filter(|&&more| more == 1.0 || open.photons && more * now >= f64::from(Choice::MIN_PHOTONS));
        let mut comparison = Comparison {
            compared: Vec::new(),
            multiples: multiples.copied().collect(),
            factors: if open.radius_factor { possible_factors(is_aimed, *caustic_share) } else { &[1.0] },
            bandwidth: self.settings.bandwidth,
            per_pixel: open.bandwidth.then(|| gain(is_aimed, *caustic_share)),
            photons: self.settings.photons,
            photon_seconds: photons[1],
            setup: self.setup.without_scene(),
        };
        let Some(least) = trials.first() else { return comparison };
        let weights = weights(least, others);
        let reference = reference(trials);
        // The variance of a pass that is not by photons: that of photons at the same visible points is subtracted. The difference of
        // two variances is uncertain; it is not less than without photons.
        let noise_of = |sampled: &[Vec<f64>; 2], all: &[Vec<f64>; 2]| {
            let weights = weights_of_mean(all);
            let by_photons = widest(settings).map_or(0.0, |widest| variance(&trials[widest].passes, &weights));
            (variance(all, &weights) - by_photons).max(variance(sampled, &weights))
        };
        let noise: Vec<f64> = sampled.iter().zip(all).map(|(sampled, all)| noise_of(sampled, all)).collect();
        // Numbers of gather rays, that variance, and the seconds of the rays.
        let by_rays: Vec<(Option<u32>, [f64; 2])> = match (noise.as_slice(), gathering.as_slice()) {
            (&[few, many], &[fast, slow]) if open.gather_rays => {
                let tried = [(TRIED_RAYS[0], [few, fast]), (TRIED_RAYS[1], [many, slow])];
                POSSIBLE_RAYS.iter().map(|&rays| (Some(rays), with_gather_rays(tried, rays))).collect()
            }
            _ => noise.iter().map(|&noise| (None, [noise, 0.0])).collect(),
        };
        for (&(gather_rays, [noise, gathering]), &area) in
            by_rays.iter().flat_map(|each| areas.iter().map(move |area| (each, area)))
        {
            let of_area: Vec<&Trial> = trials.iter().filter(|trial| trial.area == area).collect();
            let photons = [photons[0] + gathering, photons[1]];
            let model = Model::new(&of_area, &reference, noise, &weights, (photons, *look), self.settings.alpha);
            comparison.compared.push(Compared { gather_rays, area, model });
        }
        comparison
    }

    /// Renders the trials: two passes of a small picture.
    fn measure(&mut self, scene: &SceneView<'_>, rays: &[u32], settings: &[(Area, f64)]) -> Result<Measured> {
        let whole = self.view;
        let small = reduced(whole);
        let mut film = self.on.film(scene, small.width, small.height)?;
        if self.settings.errors {
            self.on.keep_errors(&mut film)?;
        }
        std::mem::swap(&mut self.film, &mut film);
        self.view = small;
        let both = self.tried(0, rays, settings).and_then(|first| Ok([first, self.tried(1, rays, settings)?]));
        std::mem::swap(&mut self.film, &mut film);
        self.view = whole;
        drop(film);
        let [first, second] = both?;
        // Memory is again reported for the film of the picture.
        self.on.abandon_pass(&mut self.film)?;
        let pixels = |view: View| f64::from(view.width) * f64::from(view.height);
        let more = pixels(whole) / pixels(small);
        // The lesser of two times: other programs only add to them. Until the whole picture is timed, the time for photons is
        // taken to be proportional to the number of paths.
        let (photons, look) = ([0.0, first.photons.min(second.photons)], first.look.min(second.look));
        let gathering =
            (0..rays.len()).map(|number| first.gathering(number).min(second.gathering(number)) * more).collect();
        let numbers = 0..rays.len().max(1);
        let sampled = numbers.clone().map(|number| [first.sampled(number), second.sampled(number)]).collect();
        let all = numbers.map(|number| [first.all(number), second.all(number)]).collect();
        let others = first.others(&second);
        let caustic_share = 0.5 * (first.caustic_share + second.caustic_share);
        let trials = settings
            .iter()
            .zip(first.shown.into_iter().zip(second.shown))
            .map(|(&(area, factor), ((one, once), (two, again)))| Trial {
                area,
                factor,
                passes: [one, two],
                seconds: (look + once.min(again)) * more,
            })
            .collect();
        Ok(Measured { trials, sampled, all, gathering, others, caustic_share, photons, look: look * more })
    }
}

/// The factors on radii that may be chosen, by whether photons are aimed and the share of the pixels that have caustics.
fn possible_factors(is_aimed: bool, caustic_share: f64) -> &'static [f64] {
    if is_aimed && caustic_share < FEW_PIXELS { &FACTORS_FOR_FEW } else { &POSSIBLE_FACTORS }
}

/// What radii per pixel gain, by the same. Aimed photons count as caustics: those may be too small to be seen in a trial.
fn gain(is_aimed: bool, caustic_share: f64) -> Gain {
    if is_aimed || caustic_share >= FEW_PIXELS { GAIN_OF_CAUSTICS } else { GAIN_WITHOUT_CAUSTICS }
}

/// The view of a small picture, whose pixels have the size of those of the whole one and lie apart: as many of them contain an
/// edge, and as much bias of either sign cancels within them.
fn reduced(whole: View) -> View {
    let reduced = |length: u32| (length / REDUCTION).max(MIN_SIZE).min(length);
    let (width, height) = (reduced(whole.width), reduced(whole.height));
    let [x, y] = whole.camera.pixel_margin;
    let margin = |few: u32, all: u32, present: f32| {
        if few == all { present } else { 0.5 - (0.5 - present) * few as f32 / all as f32 }
    };
    let pixel_margin = [margin(width, whole.width, x), margin(height, whole.height, y)];
    View { camera: Camera { pixel_margin, ..whole.camera }, width, height }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_do_not_grow_for_caustics_that_few_pixels_show() {
        assert_eq!(possible_factors(true, 0.049), [0.5, 0.7, 1.0]);
        for (is_aimed, caustic_share) in [(false, 0.049), (true, 0.05)] {
            assert_eq!(possible_factors(is_aimed, caustic_share), POSSIBLE_FACTORS);
        }
    }

    #[test]
    fn radii_per_pixel_gain_more_from_caustics() {
        let gains = [(true, 0.0), (false, 0.05), (false, 0.049)].map(|(is_aimed, share)| gain(is_aimed, share));
        assert_eq!(gains, [GAIN_OF_CAUSTICS, GAIN_OF_CAUSTICS, GAIN_WITHOUT_CAUSTICS]);
    }

    #[test]
    fn pixels_of_small_pictures_are_as_wide_as_before() {
        let view = |width, height, pixel_margin| View {
            camera: Camera { right: [0.5, 0.0, 0.0], pixel_margin, ..Camera::default() },
            width,
            height,
        };
        let small = reduced(view(500, 100, [0.0; 2]));
        assert_eq!([small.width, small.height, small.camera.right[0].to_bits()], [100, 40, 0.5_f32.to_bits()]);
        // Of a pixel's width four fifths are margins, of its height three fifths.
        let [across, down] = small.camera.pixel_margin;
        assert!((across - 0.4).abs() < 1e-6 && (down - 0.3).abs() < 1e-6);
        assert!(small.camera.check().is_ok());
        // The margins of the picture remain.
        let [across, _] = reduced(view(500, 100, [0.25, 0.0])).camera.pixel_margin;
        assert!((across - 0.45).abs() < 1e-6);
        let tiny = view(30, 20, [0.0, 0.1]);
        assert_eq!(reduced(tiny), tiny);
    }
}
