//! The facts of a first pass, and a renderer whose settings are decided by them.

use std::time::Instant;

use super::Pipeline;
use super::small_pass::SmallPass;
use crate::backend::stages::View;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::{Film, FilmPixel, Layer};
use crate::scene::SceneView;
use crate::scene::media::MediaFeatures;
use crate::scene::solids::Solids;
use crate::settings::rule::{Circumstances, Decision, FirstPass, Fixed, VISIBLE_CAUSTIC};
use crate::settings::{Direct, Estimator, Settings};

/// Pixels and paths of the first pass on a CPU. A share of 5 % of so many pixels has a standard error of 0.3 %.
const PIXELS: f64 = 4096.0;
const PATHS: f64 = 16384.0;

impl<B: TransportBackend> Pipeline<B> {
    /// Makes a renderer whose settings are decided by the facts of a first pass: [`Settings::for_time`]. `seconds` are those for
    /// everything, from this call on; `None` for a number of passes, or an error. Afterwards it renders, bit by bit, as one of
    /// [`Pipeline::new`] with [`Decision::settings`]: the first pass has other random numbers, and is in no film.
    ///
    /// `None`, and the settings are those that were given, if nothing is left to decide: all is fixed, radii are not derived,
    /// irradiance is precomputed on request, or no surface that scatters light diffusely is seen.
    ///
    /// # Errors
    /// Those of [`Pipeline::new`], and of a pass.
    pub fn for_time(
        on: B,
        scene: &SceneView<'_>,
        view: View,
        settings: &Settings,
        (seconds, fixed): (Option<f64>, Fixed),
    ) -> Result<(Self, Option<Decision>)> {
        let begun = Instant::now();
        // Much of the light is that of media, which gathering does not change.
        let scatters = Solids::of(scene).features().contains(MediaFeatures::SCATTERING);
        let fixed = Fixed { indirect: fixed.indirect || scatters, ..fixed };
        let is_derived = matches!(settings.estimator, Estimator::Radius { radius: None });
        if fixed == Fixed::ALL || !is_derived || settings.irradiance_every.is_some() {
            return Ok((Self::new(on, scene, view, settings.clone())?, None));
        }
        let pixels = u64::from(view.width) * u64::from(view.height);
        let within = Circumstances { seconds, pixels, is_gpu: on.is_gpu(), fixed };
        let begin = settings.for_first_pass(&within);
        let mut pipeline = Self::new(on, scene, view, begin.clone())?;
        let left = || seconds.map_or(f64::INFINITY, |seconds| seconds - begun.elapsed().as_secs_f64());
        let Some(mut first) = pipeline.first_pass(!fixed.camera_samples, left)? else {
            return Ok((pipeline.with_settings(scene, settings.clone())?, None));
        };
        let stored = pipeline.maps.iter().map(|slot| slot.capacity).max().unwrap_or(0);
        let of_path = stored.max(1) as f64 / f64::from(pipeline.settings.photons);
        first.most_paths = Some((pipeline.on.most_photons() as f64 / of_path) as u32);
        first.seconds_left = left();
        let decided = settings.for_time(&within, &first);
        let Settings { camera_samples, shadow_rays, .. } = decided;
        if (Settings { camera_samples, shadow_rays, ..begin }) == decided {
            pipeline.set_samples(camera_samples, shadow_rays)?;
        } else {
            pipeline = pipeline.with_settings(scene, decided.clone())?;
        }
        Ok((pipeline, Some(Decision { settings: decided, first })))
    }

    /// Renders a pass up to three times, each into a film of its own: with other random numbers, and with other ones for shadow rays
    /// alone. On a GPU these are whole passes, which take milliseconds, but for rays of a query beyond a few; otherwise they have
    /// few pixels and paths. `samples`: whether there may be several camera samples, which are then timed too. There is one alone if
    /// two further ones take more than a quarter of the seconds that are `left`. `None` if no surface is seen.
    fn first_pass(&mut self, samples: bool, left: impl Fn() -> f64) -> Result<Option<FirstPass>> {
        let (small, paths) = self.telling_size(PIXELS, PATHS);
        let begun = left();
        let again = self.small_pass(small, paths, (1, 0), false)?;
        let after = left();
        let compile = self.setup.get(Stage::Compile) + again.compile;
        // Without a limit this is not a number, and the comparison false.
        let seconds = begun - after - again.compile;
        if 2.0 * seconds > after / 4.0 {
            let facts = again.facts(self.settings.shadow_rays, compile);
            return Ok(facts.map(|facts| FirstPass { lacks_noise: true, ..facts }));
        }
        let with_other_shadow_rays = self.small_pass(small, paths, (0, 1), false)?;
        let small = self.small_pass(small, paths, (0, 0), samples)?;
        let [sampled, map_noise] = noise(&small.film, &again.film, self.settings.direct);
        let [shadow_noise, _] = noise(&small.film, &with_other_shadow_rays.film, self.settings.direct);
        let compile = compile + with_other_shadow_rays.compile + small.compile;
        Ok(small.facts(self.settings.shadow_rays, compile).map(|facts| FirstPass {
            camera_noise: (sampled - shadow_noise).max(0.0),
            shadow_noise: shadow_noise * small.shadow_rays.powf(1.5),
            map_noise,
            ..facts
        }))
    }
}

impl SmallPass {
    /// Facts of a pass with so many shadow rays of a query, without its noise. `None` if no surface is seen.
    fn facts(&self, shadow_rays: u32, compile_seconds: f64) -> Option<FirstPass> {
        let Self { whole, camera, sample_shadow_rays, gather_ray, .. } = *self;
        let shadow_rays = f64::from(shadow_rays);
        shares(&self.film).map(|shares| FirstPass {
            once_seconds: whole.total() - sample_shadow_rays - camera,
            camera_seconds: camera,
            shadow_ray_seconds: sample_shadow_rays / shadow_rays,
            alone_seconds: whole.total() - whole.shadow_rays,
            alone_ray_seconds: whole.shadow_rays / shadow_rays,
            photon_seconds: whole.photons,
            other_seconds: whole.total() - whole.photons,
            gather_ray_seconds: gather_ray,
            compile_seconds,
            ..shares
        })
    }
}

/// Relative variance of lit pixels, from two passes: by the light of camera samples, and by light that is read from maps.
///
/// The variance is half the mean squared difference. Relative to the sum of both passes, no pixel counts more than 1, so that rare
/// bright ones do not decide alone.
fn noise(one: &Film, other: &Film, direct: Direct) -> [f64; 2] {
    let is_sampled = |layer: Layer| layer == Layer::Emission || (layer == Layer::Direct && direct == Direct::Nee);
    let (mut sum, mut count) = ([0.0; 2], 0_u32);
    for (a, b) in one.pixels.iter().zip(&other.pixels) {
        let (mut all, mut gaps) = (0.0, [0.0; 2]);
        for layer in Layer::ALL {
            let (a, b) = (grey(a, layer), grey(b, layer));
            all += a + b;
            gaps[usize::from(!is_sampled(layer))] += a - b;
        }
        if all > 0.0 {
            count += 1;
            sum.iter_mut().zip(gaps).for_each(|(sum, gap)| *sum += 2.0 * (gap / all).powi(2));
        }
    }
    sum.map(|sum| sum / f64::from(count.max(1)))
}

fn grey(pixel: &FilmPixel, layer: Layer) -> f64 {
    pixel.layers[layer as usize].iter().sum()
}

/// The shares of kinds of light; `None` if no pixel shows a surface. Each lit pixel counts the same, so that bright ones do not
/// decide alone.
fn shares(film: &Film) -> Option<FirstPass> {
    let lit = |pixel: &&FilmPixel| pixel.hits > 0 && Layer::ALL.iter().any(|&layer| grey(pixel, layer) > 0.0);
    let (mut sum, mut count) = (FirstPass::default(), 0_u32);
    for pixel in film.pixels.iter().filter(lit) {
        let all: f64 = Layer::ALL.iter().map(|&layer| grey(pixel, layer)).sum();
        let share = |layer: Layer| grey(pixel, layer) / all;
        sum.direct += share(Layer::Direct);
        sum.indirect += share(Layer::Indirect);
        sum.caustic_pixels += f64::from(u8::from(share(Layer::Caustic) >= VISIBLE_CAUSTIC));
        count += 1;
    }
    let (all, lit) = (film.pixels.len() as f64, f64::from(count));
    (count > 0).then(|| FirstPass {
        caustic_pixels: sum.caustic_pixels / all,
        direct: sum.direct / lit,
        indirect: sum.indirect / lit,
        ..sum
    })
}
