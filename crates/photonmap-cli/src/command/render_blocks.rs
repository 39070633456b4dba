//! Rendering in blocks of passes: into a film file, or on several devices.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use photon_core::{
    Bandwidth, BlockOutcome, Blocks, Budget, ErrorTarget, Event, Film, Outcome, Render, Settings,
    render_blocks_in_parallel,
};

use crate::args::RenderArgs;
use crate::backend::BackendName;
use crate::fault::Fault;
use crate::forecast_text::{error_line, forecast_lines};
use crate::progress::{Limit, Progress};
use crate::watch::{Said, Watch, Watching};

/// Checks the options, before anything is loaded: what stops a render or changes its passes must not depend on time, nor
/// on passes that are not in the film.
pub(super) fn check(args: &RenderArgs, settings: &Settings) -> Result<(), Fault> {
    let devices = &args.machine.device;
    if devices.iter().any(|device| device.trim().is_empty()) {
        return Err(Fault::input("--device: a name is empty; `photonmap devices` lists devices"));
    }
    if !devices.is_empty() && args.machine.backend == BackendName::Cpu {
        return Err(Fault::input(
            "--device: these are Vulkan devices; give --backend vulkan, or --threads for the CPU",
        ));
    }
    let several = args.machine.several();
    if several && args.machine.memory.is_some() {
        return Err(Fault::input("--memory: is not divided between devices; give fewer --photons, or a single device"));
    }
    let with = match (&args.film.film, args.film.grain) {
        (Some(_), _) => "--film",
        (None, Some(_)) => "--grain",
        (None, None) if several => "several devices",
        (None, None) => return Ok(()),
    };
    let budget = &args.settings.budget;
    if budget.time.is_some() {
        return Err(Fault::input(format!(
            "--time: the passes of blocks must not depend on when they are rendered; with {with}, give --passes or \
             --target-error"
        )));
    }
    if settings.bandwidth == Bandwidth::PerPixel {
        return Err(Fault::input(format!(
            "{}: passes then depend on all passes before them, which is not possible in blocks; with {with}, give \
             --bandwidth shared",
            if args.settings.estimate.bandwidth.is_some() {
                "--bandwidth per-pixel"
            } else {
                "radii per pixel, as of --preset final"
            }
        )));
    }
    blocks(args, settings, settings.photons, devices.len()).map(|_| ())
}

/// Most passes in a block with several devices, a target and no grain: the film is examined after whole blocks, which must
/// not depend on the number of devices.
const TARGET_GRAIN: u32 = 8;

/// The blocks that the options ask for, with this many paths per pass.
pub(super) fn blocks(args: &RenderArgs, settings: &Settings, photons: u32, devices: usize) -> Result<Blocks, Fault> {
    let plan = args.settings.plan(None);
    let has_target = matches!(plan.until, Budget::Error { .. });
    let is_open = has_target && plan.most_passes.is_none();
    let count = match plan.until {
        Budget::Photons(all) => {
            let passes = u32::try_from(all.div_ceil(u64::from(photons.max(1)))).unwrap_or(u32::MAX);
            plan.most_passes.map_or(passes, |most| most.min(passes))
        }
        _ => plan.passes(),
    };
    let count = count.min(u32::MAX - 1 - plan.first);
    let grain = match (args.film.grain, &args.film.film) {
        (Some(grain), _) => grain,
        (None, Some(_)) => 1,
        (None, None) if is_open => TARGET_GRAIN,
        (None, None) if has_target => largest_grain(plan.first, count, TARGET_GRAIN),
        (None, None) => usual_grain(plan.first, count, devices),
    };
    let count = if is_open { count - count % grain.max(1) } else { count };
    let blocks = Blocks::new(plan.first..plan.first + count, grain)?;
    Ok(match plan.until {
        Budget::Error { target, share_of_pixels } => {
            blocks.with_target(ErrorTarget::new(target, share_of_pixels, settings)?)
        }
        _ => blocks,
    })
}

/// The largest grain that divides the passes such that there are two blocks for each device at least, if possible: so the
/// devices finish at about the same time, and few films are copied.
fn usual_grain(first: u32, count: u32, devices: usize) -> u32 {
    let most = count / u32::try_from(2 * devices).unwrap_or(u32::MAX).max(1);
    largest_grain(first, count, most.clamp(1, 4096))
}

/// The largest grain up to `most` that divides the passes.
fn largest_grain(first: u32, count: u32, most: u32) -> u32 {
    let whole = |grain: &u32| first.is_multiple_of(*grain) && count.is_multiple_of(*grain);
    (1..=most).rev().find(whole).unwrap_or(1)
}

/// Passes of blocks must not depend on memory.
pub(super) fn check_memory(photons: u32, settings: &Settings) -> Result<(), Fault> {
    if photons < settings.photons {
        return Err(Fault::input(format!(
            "--memory: only {photons} paths a pass fit the limit; with --film or --grain, give --photons {photons}"
        )));
    }
    Ok(())
}

/// Whether passes are rendered in blocks.
pub(super) fn in_blocks(args: &RenderArgs) -> bool {
    args.film.film.is_some() || args.film.grain.is_some() || args.machine.several()
}

/// Renders all blocks; the film is in memory alone.
pub(super) fn run(
    args: &RenderArgs,
    settings: &Settings,
    renderers: &mut [Box<dyn Render>],
    watch: &mut Watch,
    stop: &'static AtomicBool,
) -> Result<(Outcome, Film), Fault> {
    check_memory(renderers[0].facts().photons, settings)?;
    let blocks = blocks(args, settings, settings.photons, renderers.len())?;
    let mut film = None;
    let BlockOutcome { outcome, unfinished, .. } = remaining(renderers, &blocks, &mut film, (watch, stop), |_, _| ())?;
    Ok((outcome, film.or(unfinished).ok_or(photon_core::Error::Cancelled)?))
}

/// Renders blocks and shows the progress.
pub(super) fn remaining(
    renderers: &mut [Box<dyn Render>],
    blocks: &Blocks,
    film: &mut Option<Film>,
    (watch, stop): (&mut Watch, &'static AtomicBool),
    mut after_block: impl FnMut(&Film, &Progress),
) -> photon_core::Result<BlockOutcome> {
    let passes = blocks.passes();
    let count = passes.end - passes.start;
    // Without --passes, a target has hardly any limit.
    let is_open = blocks.target().is_some() && count > u32::MAX / 2;
    let progress = RefCell::new(Progress::new(if is_open { Limit::Open } else { Limit::Passes(count) }));
    let (mut done, mut forecast_shown) = (0, false);
    let photons = renderers[0].facts().photons;
    let inner = |event: &Event<'_>| {
        match event {
            Event::PassDone(_) => {
                done += 1;
                progress.borrow_mut().passes(done);
            }
            Event::Forecast(forecast) if !forecast.is_reached() && !std::mem::replace(&mut forecast_shown, true) => {
                progress.borrow().say(&forecast_lines(forecast, photons));
            }
            Event::Warning(text) => progress.borrow().say(&format!("warning: {text}")),
            _ => {}
        }
        if stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut say = |said: Said<'_>| progress.borrow().print(said);
    let mut observer = Watching { watch, inner, say: &mut say, stop };
    let mut after_block = |film: &Film| {
        after_block(film, &progress.borrow());
        Ok(())
    };
    let results = match renderers {
        [renderer] => photon_core::render_blocks(&mut **renderer, blocks, film, &mut observer, &mut after_block),
        _ => render_blocks_in_parallel(renderers, blocks, film, &mut observer, &mut after_block),
    };
    progress.into_inner().finish();
    if let Ok(BlockOutcome { outcome: Outcome { reached: Some(reached), .. }, .. }) = &results {
        say!("{}", error_line("result", reached));
    }
    results
}

#[cfg(test)]
mod tests {
    use super::{TARGET_GRAIN, largest_grain, usual_grain};

    #[test]
    fn every_device_gets_two_blocks_if_the_passes_can_be_divided() {
        assert_eq!(
            [(0, 64, 2), (0, 60, 4), (0, 64, 1), (8, 64, 2)].map(|(f, c, d)| usual_grain(f, c, d)),
            [16, 6, 32, 8]
        );
        // A prime number of passes, and fewer than devices.
        assert_eq!([usual_grain(0, 31, 2), usual_grain(0, 2, 8), usual_grain(3, 64, 2)], [1, 1, 1]);
        // With a target it is that of any number of devices.
        assert_eq!([96, 36, 7].map(|count| largest_grain(0, count, TARGET_GRAIN)), [8, 6, 7]);
    }
}
