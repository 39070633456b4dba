//! `photonmap render` on one device, without a film file: whole passes.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photon_core::{Budget, Event, Outcome, Render, render};

use crate::args::RenderArgs;
use crate::command::picture;
use crate::fault::Fault;
use crate::forecast_text::{error_line, forecast_lines};
use crate::progress::{Limit, Progress};
use crate::watch::{Said, Watch, Watching};

/// Renders passes on one device until the budget of the options is spent, or `stop` is set.
///
/// # Errors
/// [`Fault`] if rendering fails.
pub(super) fn run(
    args: &RenderArgs,
    photons: u32,
    renderer: &mut dyn Render,
    started: Instant,
    (watch, stop): (&mut Watch, &'static AtomicBool),
) -> Result<Outcome, Fault> {
    // The requested time is that of the whole program.
    let limit = args.settings.budget.time.map(|time| Duration::try_from_secs_f64(time).unwrap_or(Duration::MAX));
    // If loading took all of it, a picture may still take a tenth.
    let time = limit.map(|time| time.saturating_sub(started.elapsed() + writing(args)).max(time / 10));
    let mut plan = args.settings.plan(time);
    // A GPU makes these few passes in less time than it takes to compile a kernel, which may happen in any of them.
    let quick = args.settings.quick_look().filter(|_| renderer.facts().backend == "cpu");
    if let Some(limit) = quick {
        plan.most_time = Some(limit.saturating_sub(started.elapsed() + writing(args)));
    }
    // The same total number of photons, if the memory limit makes passes smaller.
    let each = renderer.facts().photons;
    if each < photons {
        say!("memory: {each} paths a pass fit the limit");
        let more = |passes: u32| passes.saturating_mul(photons.div_ceil(each)).min(u32::MAX - 1);
        // A range is what it says.
        if let (Budget::Passes(passes), 0) = (&mut plan.until, plan.first) {
            *passes = more(*passes);
        }
        plan.most_passes = plan.most_passes.map(more);
    }
    let progress = RefCell::new(Progress::new(match (plan.until, time) {
        (Budget::Error { .. }, Some(time)) => Limit::Time(time),
        (Budget::Time(time), _) if plan.most_passes.is_none() => Limit::Time(time),
        (Budget::Passes(passes), _) => Limit::Passes(passes),
        (Budget::Photons(all), _) => {
            Limit::Passes(u32::try_from(all.div_ceil(u64::from(each.max(1)))).unwrap_or(u32::MAX))
        }
        _ => plan.most_passes.map_or(Limit::Open, Limit::Passes),
    }));
    let mut forecast_shown = false;
    let inner = |event: &Event<'_>| {
        match event {
            Event::PassDone(pass) => progress.borrow_mut().passes(pass.index + 1 - plan.first),
            Event::Forecast(forecast) if !std::mem::replace(&mut forecast_shown, true) => {
                progress.borrow().say(&forecast_lines(forecast, photons));
            }
            Event::Warning(text) => progress.borrow().say(&format!("warning: {text}")),
            _ => {}
        }
        if stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut say = |said: Said<'_>| progress.borrow().print(said);
    let outcome = render(renderer, plan, &mut Watching { watch, inner, say: &mut say, stop });
    progress.into_inner().finish();
    let outcome = outcome?;
    if quick.is_some() && outcome.passes < plan.passes() && !outcome.cancelled {
        let (made, all) = (outcome.passes, plan.passes());
        say!(
            "a first look: {made} of {all} passes, since more would take longer than two seconds; --passes {all} makes all"
        );
    }
    if let Some(reached) = &outcome.reached {
        say!("{}", error_line("result", reached));
    }
    Ok(outcome)
}

/// Microseconds per pixel to write an EXR file, all of whose layers are compressed: 0.85 were measured on one core, 0.5 on two.
const EXR: f64 = 1.0;
/// The same for a PNG file, of which 0.23 were measured.
const PNG: f64 = 0.25;
/// Microseconds per pixel of denoising; 4.6 were measured on two cores.
const DENOISED: f64 = 5.0;

/// Estimated time to denoise and write the pictures.
fn writing(args: &RenderArgs) -> Duration {
    let (width, height) = args.settings.picture.size;
    let pixels = f64::from(width) * f64::from(height);
    let of_file = |path: &PathBuf| if picture::is_exr(path) { EXR } else { PNG };
    // Without an output there is a PNG file.
    let each = args.files.output.iter().map(of_file).sum::<f64>().max(PNG);
    let denoising = if args.files.denoise { DENOISED } else { 0.0 };
    Duration::from_secs_f64(1e-6 * pixels * (each + denoising))
}

#[cfg(test)]
mod tests {
    use backend_cpu::Cpu;
    use clap::Parser as _;
    use photon_core::{Pipeline, Settings, View};

    use super::*;
    use crate::command::picture::Look;
    use crate::exposure::Exposure;

    #[test]
    fn writing_takes_time_for_each_file() {
        let seconds = |options: &[&str]| {
            let args = RenderArgs::try_parse_from([&["render", "cornell", "--size", "1000x2000"], options].concat());
            writing(&args.unwrap()).as_secs_f64()
        };
        for (options, expected) in
            [(&[][..], 0.5), (&["-o", "a.png"], 0.5), (&["-o", "a.exr"], 2.0), (&["-o", "a.exr", "-o", "b.png"], 2.5)]
        {
            assert!((seconds(options) - expected).abs() < 1e-9, "{options:?}");
        }
    }

    /// A first look ends before its four passes if the time is over, but not before the first.
    #[test]
    fn a_first_look_has_fewer_passes_if_they_take_long() {
        let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
        let settings = Settings { photons: 100, ..Settings::default() };
        let passes = |options: &[&str], ago: u64| {
            let args = RenderArgs::try_parse_from([&["render", "cornell", "--preset", "preview"], options].concat());
            let args = args.unwrap();
            let on = Cpu::with_threads(1).unwrap();
            let mut renderer = Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
            let look = Look { transparent: false, exposure: Exposure::Stops(0.0), tonemap: args.files.tonemap };
            let mut watch = Watch::start(&args.watch, look, "").unwrap();
            let started = Instant::now().checked_sub(Duration::from_secs(ago)).unwrap();
            static STOP: AtomicBool = AtomicBool::new(false);
            run(&args, 100, &mut renderer, started, (&mut watch, &STOP)).unwrap().passes
        };
        assert_eq!(passes(&[], 10), 1);
        assert_eq!(passes(&["--passes", "4"], 10), 4);
    }

    /// A pass for which there is no time has fewer rays and the same brightness; where there is time, no bit changes.
    #[test]
    fn passes_are_lowered_to_the_time_and_not_otherwise() {
        let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 32, 32).unwrap(), width: 32, height: 32 };
        let pipeline = |shadow_rays: u32| {
            let settings = Settings { photons: 20_000, shadow_rays, ..Settings::default() };
            Pipeline::new(Cpu::with_threads(1).unwrap(), &scene.view(), view, settings).unwrap()
        };
        let passed = |renderer: &mut dyn Render| {
            renderer.pass(0, &mut ()).unwrap();
            renderer.film().unwrap()
        };
        let hour = Duration::from_secs(3600);
        let (mut plain, mut timed) = (pipeline(4), pipeline(4));
        assert_eq!(timed.lower(hour).unwrap(), None);
        let plain = passed(&mut plain);
        assert!(passed(&mut timed).pixels == plain.pixels);

        // Four million shadow rays take nearly all of a pass, of which there is time for a tenth.
        let mut many = pipeline(4096);
        let begun = Instant::now();
        passed(&mut many);
        let time = begun.elapsed() / 10;
        many.restart(&scene.view(), 1).unwrap();
        let text = many.lower(time).unwrap().unwrap();
        let rays = many.facts().shadow_rays;
        assert!(rays < 2048 && text.contains(&format!("{rays} shadow rays instead of 4096")), "{text}");
        let lowered = passed(&mut many);
        // Not in the middle of a film.
        assert_eq!(many.lower(Duration::ZERO).unwrap(), None);
        many.restart(&scene.view(), 1).unwrap();
        assert_eq!((many.facts().shadow_rays, many.facts().photons), (4096, 20_000));
        // The mean difference of pixels, in its standard errors.
        let differences: Vec<f64> = lowered
            .pixels
            .iter()
            .zip(&plain.pixels)
            .map(|(a, b)| {
                let sum = |pixel: &photon_core::FilmPixel| pixel.layers.iter().flatten().sum::<f64>();
                sum(a) - sum(b)
            })
            .collect();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
        assert!(mean.abs() <= 4.5 * (variance / count).sqrt(), "{mean} {variance}");
    }
}
