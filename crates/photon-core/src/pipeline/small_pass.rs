//! A pass of few pixels, paths and rays, which tells how long a whole one takes, and about the light in the picture.

use super::Pipeline;
use crate::backend::stages::View;
use crate::backend::{Stage, StageTimings, TransportBackend};
use crate::error::Result;
use crate::film::Film;
use crate::radius::radii;
use crate::settings::{Estimator, Settings};

/// Most shadow rays, and most final-gather rays, of a query.
const RAYS: u32 = 8;

/// Most paths of a small pass on a GPU.
const WHOLE: f64 = 1_048_576.0;

/// Results of a small pass.
pub(super) struct SmallPass {
    pub(super) film: Film,
    /// Expected seconds of a whole pass with one camera sample.
    pub(super) whole: Seconds,
    /// Expected seconds of the camera paths of the whole picture, and of their shadow rays, of one camera sample among
    /// [`crate::TransportBackend::samples_together`].
    pub(super) camera: f64,
    pub(super) sample_shadow_rays: f64,
    /// Shadow rays of a query.
    pub(super) shadow_rays: f64,
    /// Seconds of kernels that were compiled.
    pub(super) compile: f64,
    /// Expected seconds of one final-gather ray for each pixel: a ray and an estimate where it lands.
    pub(super) gather_ray: f64,
}

/// Seconds of a pass, by what they are proportional to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seconds {
    /// To the number of paths.
    pub(super) photons: f64,
    /// To the number of shadow rays.
    pub(super) shadow_rays: f64,
    /// To the number of final-gather rays.
    pub(super) gather_rays: f64,
    /// To none of them.
    pub(super) others: f64,
}

impl Seconds {
    pub(super) fn total(&self) -> f64 {
        self.photons + self.shadow_rays + self.gather_rays + self.others
    }
}

impl<B: TransportBackend> Pipeline<B> {
    /// View and paths of a small pass: of about so many pixels, and of so many paths or those of the settings, if these are fewer.
    /// On a GPU, where few take as long as many, the whole picture and at most 2²⁰ paths.
    pub(super) fn telling_size(&self, pixels: f64, paths: f64) -> (View, u32) {
        let (small, paths) = if self.on.is_gpu() { (self.view, WHOLE) } else { (reduced(self.view, pixels), paths) };
        // Many more may be aimed.
        (small, (paths as u32).min(self.settings.photons).min(self.paths_of(4.0 * paths)))
    }

    /// The number of paths that are not aimed, such that all are about `most` in number.
    fn paths_of(&self, most: f64) -> u32 {
        let paths = f64::from(self.settings.photons);
        let all = paths + f64::from(self.aimed_paths(self.settings.photons).unwrap_or(0));
        (paths * (most / all).min(1.0)).max(1.0) as u32
    }

    /// Renders pass `index` with `paths` paths and the pixels of `small` with random numbers of its own, into a film of its own;
    /// shadow rays have those of camera sample `shadows`. Photons that are
    /// searched for in derived radii are as many for an estimate as in a whole pass. With `samples`, further camera samples are
    /// timed too; otherwise they are taken to last as long as the first.
    pub(super) fn small_pass(
        &mut self,
        small: View,
        paths: u32,
        (index, shadows): (u32, u32),
        samples: bool,
    ) -> Result<SmallPass> {
        let (whole, settings) = (self.view, self.settings.clone());
        let count = |view: View| f64::from(view.width) * f64::from(view.height);
        let pixels = count(whole) / count(small);
        let more = f64::from(settings.photons) / f64::from(paths);
        let [shadow, gather] = [settings.shadow_rays, settings.gather_rays].map(|rays| rays.min(RAYS));
        let is_fixed = matches!(settings.estimator, Estimator::Radius { radius: Some(_) });
        let mut film = self.on.film(self.units, small.width, small.height)?;
        if settings.errors {
            self.on.keep_errors(&mut film)?;
        }
        std::mem::swap(&mut self.film, &mut film);
        self.view = small;
        self.settings = Settings { seed: !settings.seed, shadow_rays: shadow, gather_rays: gather, ..settings.clone() };
        let before: Vec<f32> = self.maps.iter().map(|slot| slot.radius).collect();
        if !is_fixed {
            let wider = more.sqrt() as f32;
            self.maps.iter_mut().for_each(|slot| slot.radius = radii::scaled(slot.radius, wider));
        }
        let rendered = self.rendered(paths, (index, shadows), samples);
        self.maps.iter_mut().zip(before).for_each(|(slot, radius)| slot.radius = radius);
        (self.view, self.settings) = (whole, settings);
        std::mem::swap(&mut self.film, &mut film);
        drop(film);
        self.recover()?;
        // Memory is again reported for the film of the picture.
        self.on.abandon_pass(&mut self.film)?;
        let (film, seconds, [camera, shadow_rays_of_sample, compile]) = rendered?;
        let of = |stages: &[Stage]| stages.iter().map(|&stage| seconds.get(stage)).sum::<f64>();
        let traced = of(&[Stage::Emit, Stage::Trace, Stage::Build]);
        let estimated = pixels * of(&[Stage::Estimate]);
        let of_rays = |seconds: f64, all: u32, few: u32| pixels * seconds * f64::from(all) / f64::from(few.max(1));
        let [direct, direct_of_sample] = [seconds.get(Stage::Direct), shadow_rays_of_sample]
            .map(|seconds| of_rays(seconds, self.settings.shadow_rays, shadow));
        let gathered = of_rays(seconds.get(Stage::Gather), self.settings.gather_rays, gather);
        // In a given radius, there are more photons with more paths.
        let denser = if is_fixed { more } else { 1.0 };
        Ok(SmallPass {
            film,
            whole: Seconds {
                photons: traced * more + if is_fixed { estimated * more } else { 0.0 },
                shadow_rays: direct,
                gather_rays: gathered * denser,
                others: pixels * of(&[Stage::Eye, Stage::Film]) + if is_fixed { 0.0 } else { estimated },
            },
            camera: pixels * camera,
            sample_shadow_rays: direct_of_sample,
            shadow_rays: f64::from(shadow),
            compile,
            gather_ray: pixels * of(&[Stage::Eye, Stage::Estimate]),
        })
    }

    /// Pass `index` of so many paths into the present film; its seconds, and those of the camera paths and shadow rays of one
    /// sample among several, if these are asked for, and all seconds of compiling.
    fn rendered(
        &mut self,
        paths: u32,
        (index, shadows): (u32, u32),
        samples: bool,
    ) -> Result<(Film, StageTimings, [f64; 3])> {
        self.on.timings()?;
        let sent = self.emit_and_trace(index, paths, &mut ())?;
        let (queries, _) = self.look(index, shadows)?;
        self.estimate(index, &sent, queries)?;
        self.on.end_pass(&mut self.film)?;
        let seconds = self.on.timings()?;
        let film = self.on.read_film(&self.film)?;
        let [eye, direct, compile] = [Stage::Eye, Stage::Direct, Stage::Compile].map(|stage| seconds.get(stage));
        if !samples || self.together == 1 {
            return Ok((film, seconds, [eye, direct, compile]));
        }
        self.camera_samples(index, 1, self.together)?;
        let several = self.on.timings()?;
        let [eye, direct] = [Stage::Eye, Stage::Direct].map(|stage| several.get(stage) / f64::from(self.together));
        Ok((film, seconds, [eye, direct, compile + several.get(Stage::Compile)]))
    }
}

/// The view with at most so many pixels.
pub(super) fn reduced(whole: View, pixels: f64) -> View {
    let part = (pixels / (f64::from(whole.width) * f64::from(whole.height))).sqrt().min(1.0);
    let side = |length: u32| ((f64::from(length) * part) as u32).clamp(1, pixels as u32);
    View { width: side(whole.width), height: side(whole.height), ..whole }
}
