//! `photonmap-mpi`: `photonmap render` on the ranks of an MPI job.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::{CommandFactory, FromArgMatches};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};
use photon_core::{
    Bandwidth, Blocks, Budget, Error, ErrorTarget, Event, Film, Observer, Pipeline, Render, Settings, StopCondition,
    View,
};
use photon_film::{FilmFileError, FilmInfo, FilmKey, Maker};
use photon_scene::Scene;
use photonmap_cli::args::{RenderArgs, set};
use photonmap_cli::backend::{self, Chosen};
use photonmap_cli::command::picture::Pictures;
use photonmap_cli::fault::{self, Fault};
use photonmap_cli::forecast_text::error_line;
use photonmap_cli::outputs::Outputs;
use photonmap_cli::{atomic_write, load, signals, stderr};
use photonmap_mpi::{Checkpoints, Outcome, render};

/// As `eprintln!`, which panics if nobody reads standard error.
macro_rules! say {
    ($($text:tt)*) => { stderr::line(format_args!($($text)*)) };
}

const ABOUT: &str = "Render a scene on the ranks of an MPI job, which add their films in a fixed order.

Each rank renders blocks of --grain passes. Passes are given by --passes or \
--target-error; with --film the render is continued, and the film \
is that of `photonmap render` with the same grain, bit by bit, if all devices are of one kind. Start it with mpirun --bind-to \
none, or give --threads: otherwise a rank may be bound to one core.";

fn main() -> ExitCode {
    let Some(universe) = mpi::initialize() else {
        say!("error: MPI is initialised already");
        return ExitCode::FAILURE;
    };
    let world = universe.world();
    let command = RenderArgs::command().name("photonmap-mpi").about(ABOUT).long_about(ABOUT);
    let command = REFUSED.iter().fold(command, |command, (_, id)| command.mut_arg(*id, |arg| arg.hide(true)));
    let matches = command.try_get_matches_from(set::expanded(std::env::args_os()));
    let args = match matches.and_then(|matches| RenderArgs::from_arg_matches(&matches)) {
        Ok(args) => args,
        Err(error) => {
            if world.rank() == 0 {
                // Where nothing can be printed, the exit code remains.
                let _ = error.print();
            }
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(&world, &args) {
        Ok(()) => ExitCode::SUCCESS,
        // All ranks have ended.
        Err(Fault::Interrupted(line)) => {
            say!("{line}");
            ExitCode::from(fault::INTERRUPTED)
        }
        Err(fault) => {
            say!("error: rank {}: {fault}", world.rank());
            // The end of the other ranks may come back as a signal.
            signals::end_silently();
            let code = if matches!(fault, Fault::Input(_)) { 2 } else { 1 };
            // The others may wait for this one.
            world.abort(code)
        }
    }
}

fn run(world: &SimpleCommunicator, args: &RenderArgs) -> Result<(), Fault> {
    signals::ignore_file_size_limit();
    signals::end_while_loading()?;
    let settings = Settings { transparent_background: args.files.transparent, ..args.settings.settings()? };
    check(args, &settings)?;
    let blocks = blocks(args, &settings)?;
    // The files are those of rank 0, which ends all ranks if they cannot be written.
    let checked = if world.rank() == 0 { Pictures::of(args).map(Some) } else { Ok(None) };
    let mut goes_on = checked.is_ok();
    world.process_at_rank(0).broadcast_into(&mut goes_on);
    let pictures = checked?;
    if !goes_on {
        signals::end_silently();
        return Ok(());
    }
    let (scene, _) = load::scene(&args.scene)?;
    let view = args.settings.picture.view(&scene)?;
    let mut renderer = start(world, args, &scene, view, &settings)?;
    let root = (world.rank() == 0).then_some(&args.film.film).and_then(Option::as_ref);
    let stored = root.map_or(Ok(None), |path| stored(path))?;
    // Rank 0 gives its radii to all.
    if let Some((_, info)) = &stored {
        renderer.set_radii(&info.key.radii())?;
    }
    let facts = renderer.facts();
    let key = FilmKey::new(&scene.view(), &view, &settings, &*renderer, blocks.grain());
    let maker =
        |seconds| Maker::new(PROGRAM, facts.backend, &format!("{} ranks, {}", world.size(), facts.device), seconds);
    let mut info = FilmInfo::new(key, &args.scene.scene);
    let mut film = None;
    let mut remaining = Some(blocks.clone());
    if let (Some(path), Some((found, known))) = (root, stored) {
        known.check(&info.key, &info.scene, path)?;
        let named = |error| Fault::input(format!("{}: {error}", path.display()));
        remaining = blocks.remaining(&found.contains, settings.seed).map_err(named)?;
        info.in_order = known.in_order && known.makers.iter().all(|maker| maker.backend == facts.backend);
        (info.makers, film) = (known.makers, Some(found));
    }
    let Some(remaining) = first_of(world, remaining, blocks.target())? else {
        let mut written = Outputs::default();
        match (&pictures, &film) {
            (Some(pictures), Some(film)) => pictures.write(film, &mut written),
            _ => signals::end_silently(),
        }
        if written.any() {
            say!("wrote {written}: all passes were in the film already");
        }
        return written.result();
    };
    let begun = Instant::now();
    let mut file = File { path: root, info, args, begun, written: begun, maker: &maker };
    let identity = (settings.seed, settings.errors);
    let mut observer = UntilSignal(signals::stop());
    let outcome = render(world, &mut *renderer, &remaining, identity, film, &mut observer, &mut file)?;
    // Only rank 0 says that it was interrupted, since mpirun ends all others at the first exit code above 0.
    let Some(pictures) = pictures else { return Ok(()) };
    let Outcome { film, passes, stopped, reached, .. } = outcome;
    let film = film.ok_or(Error::Cancelled)?;
    let mut written = Outputs::default();
    if let Some(path) = root {
        written.file(path, file.write(&film));
    }
    pictures.write(&film, &mut written);
    if let Some(reached) = &reached {
        say!("{}", error_line("result", reached));
    }
    let (ranks, seconds) = (world.size(), begun.elapsed().as_secs_f64());
    let line = format!("wrote {written}: {passes} passes on {ranks} ranks in {seconds:.1} s, {} in all", film.passes);
    if stopped {
        written.keep(Err(Fault::Interrupted(format!("{line}, interrupted"))));
    } else {
        say!("{line}");
    }
    written.result()
}

/// Stops a render, in the middle of a pass, once the flag is set.
struct UntilSignal(&'static AtomicBool);

impl Observer for UntilSignal {
    fn on_event(&mut self, _: &Event<'_>) -> ControlFlow<()> {
        if self.0.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn stop_condition(&self) -> Option<StopCondition> {
        let stop = self.0;
        Some(StopCondition::new(|| stop.load(Ordering::SeqCst)))
    }
}

const PROGRAM: &str = concat!("photonmap-mpi ", env!("CARGO_PKG_VERSION"));

/// Options that need a single process, with their names in [`RenderArgs`].
const REFUSED: [(&str, &str); 8] = [
    ("--time", "time"),
    ("--total-photons", "total_photons"),
    ("--memory", "memory"),
    ("--json", "json"),
    ("--preview", "preview"),
    ("--serve", "serve"),
    ("--tev", "tev"),
    ("--show", "show"),
];

/// Refuses options that need a single process.
fn check(args: &RenderArgs, settings: &Settings) -> Result<(), Fault> {
    let (budget, watch) = (&args.settings.budget, &args.watch);
    let given = [
        budget.time.is_some(),
        budget.total_photons.is_some(),
        args.machine.memory.is_some(),
        args.files.json.is_some(),
        watch.preview.is_some(),
        watch.serve.is_some(),
        watch.tev.is_some(),
        watch.show,
    ];
    let mut refused = REFUSED.iter().zip(given).filter_map(|((option, _), given)| given.then_some(*option));
    let per_pixel = (settings.bandwidth == Bandwidth::PerPixel).then_some("--bandwidth per-pixel");
    match refused.next().or(per_pixel) {
        Some(option) => Err(Fault::input(format!(
            "{option}: is not possible on several ranks; leave it out, and give --passes or --target-error"
        ))),
        None => Ok(()),
    }
}

fn blocks(args: &RenderArgs, settings: &Settings) -> Result<Blocks, Fault> {
    let (plan, grain) = (args.settings.plan(None), args.film.grain.unwrap_or(1));
    let passes = |count: u32| Blocks::new(plan.first..plan.first.saturating_add(count), grain);
    match (plan.until, plan.most_passes) {
        (Budget::Passes(count), _) => Ok(passes(count)?),
        (Budget::Error { target, share_of_pixels }, most) => {
            let count = most.unwrap_or_else(|| plan.passes() - plan.passes() % grain.max(1));
            Ok(passes(count)?.with_target(ErrorTarget::new(target, share_of_pixels, settings)?))
        }
        _ => Err(Fault::input("--passes: is needed, or --target-error")),
    }
}

/// The renderer of this rank: with several devices, each rank of a host takes the next one.
fn start(
    world: &SimpleCommunicator,
    args: &RenderArgs,
    scene: &Scene,
    view: View,
    settings: &Settings,
) -> Result<Box<dyn Render>, Fault> {
    let local = world.split_shared(world.rank()).rank() as usize;
    let devices = &args.machine.device;
    let chosen = if devices.is_empty() {
        backend::open(args.machine.backend, args.machine.threads)?
    } else {
        Chosen::Vulkan(Box::new(backend::open_device(&devices[local % devices.len()])?))
    };
    Ok(match chosen {
        Chosen::Cpu(on) => Box::new(Pipeline::new(on, &scene.view(), view, settings.clone())?),
        Chosen::Vulkan(on) => Box::new(Pipeline::new(*on, &scene.view(), view, settings.clone())?),
    })
}

fn stored(path: &Path) -> Result<Option<(Film, FilmInfo)>, Fault> {
    atomic_write::check(path)?;
    match photon_film::load(path) {
        Err(FilmFileError::Read { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => Ok(None),
        result => Ok(Some(result?)),
    }
}

/// The blocks that remain on rank 0, for all ranks.
fn first_of(
    world: &SimpleCommunicator,
    remaining: Option<Blocks>,
    target: Option<ErrorTarget>,
) -> Result<Option<Blocks>, Fault> {
    let mut words = remaining.map_or([0; 3], |blocks| [blocks.passes().start, blocks.passes().end, blocks.grain()]);
    world.process_at_rank(0).broadcast_into(&mut words);
    let [start, end, grain] = words;
    let with_target = |blocks: Blocks| match target {
        Some(target) => blocks.with_target(target),
        None => blocks,
    };
    Ok(if end > start { Some(with_target(Blocks::new(start..end, grain)?)) } else { None })
}

/// The film file of rank 0.
struct File<'a, M> {
    path: Option<&'a PathBuf>,
    info: FilmInfo,
    args: &'a RenderArgs,
    begun: Instant,
    written: Instant,
    maker: M,
}

impl<M: Fn(f64) -> Maker> File<'_, M> {
    fn write(&mut self, film: &Film) -> Result<(), Fault> {
        let Some(path) = self.path else { return Ok(()) };
        let mut info = self.info.clone();
        info.add_maker(&(self.maker)(self.begun.elapsed().as_secs_f64()));
        Ok(photon_film::save(path, film, &info)?)
    }
}

impl<M: Fn(f64) -> Maker> Checkpoints for File<'_, M> {
    fn due(&mut self) -> bool {
        self.path.is_some() && self.written.elapsed() >= self.args.film.checkpoint
    }

    fn save(&mut self, film: &Film) {
        if let Err(fault) = self.write(film) {
            say!("warning: {fault}; rendering goes on");
        }
        self.written = Instant::now();
    }
}
