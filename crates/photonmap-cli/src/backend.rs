//! Selection of a backend: the CPU or a Vulkan device, and the reason for it.

use backend_cpu::Cpu;
use backend_vulkan::{Options, Vulkan, gpu};
use clap::ValueEnum;
use photon_scene::CompressedTree;

use crate::fault::Fault;

/// The choices of `--backend`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BackendName {
    /// A GPU if there is a suitable one, else the CPU.
    Auto,
    /// The cores of the CPU.
    Cpu,
    /// A Vulkan device; the environment variable PHOTON_VK_DEVICE selects one of several.
    Vulkan,
}

/// A backend that was opened.
#[expect(missing_debug_implementations, reason = "a pool of threads")]
pub enum Chosen {
    /// The cores of the CPU.
    Cpu(Cpu),
    /// A GPU.
    Vulkan(Box<Vulkan>),
}

/// Opens the backend `name`, and reports on standard error which one was chosen if there was a choice.
///
/// # Errors
/// [`Fault::Input`] where Vulkan is requested and not available, with what is missing and what to do.
pub fn open(name: BackendName, threads: Option<usize>) -> Result<Chosen, Fault> {
    open_quietly(name, threads).map(Opened::report)
}

/// A backend that was opened, and the line that says which, if there was a choice.
#[expect(missing_debug_implementations, reason = "a pool of threads")]
pub struct Opened {
    chosen: Chosen,
    line: Option<String>,
}

impl Opened {
    /// Gives a GPU the tree of the scene that it will render, and the seconds that it took.
    #[must_use]
    pub fn with_tree(self, tree: CompressedTree, seconds: f64) -> Self {
        match self.chosen {
            Chosen::Vulkan(on) => Self { chosen: Chosen::Vulkan(Box::new(on.with_tree(tree, seconds))), ..self },
            Chosen::Cpu(_) => self,
        }
    }

    /// Without a report.
    #[must_use]
    pub fn silent(self) -> Chosen {
        self.chosen
    }

    /// Reports on standard error which one was chosen.
    #[must_use]
    pub fn report(self) -> Chosen {
        if let Some(line) = self.line {
            say!("{line}");
        }
        self.chosen
    }
}

/// As [`open`], without the report.
///
/// # Errors
/// As [`open`].
pub fn open_quietly(name: BackendName, threads: Option<usize>) -> Result<Opened, Fault> {
    let vulkan = |on: Vulkan, why: &str| Opened {
        line: Some(format!("backend: vulkan on {}, {why}", device(&on))),
        chosen: Chosen::Vulkan(Box::new(on)),
    };
    if threads == Some(0) {
        return Err(Fault::input("--threads is 0, but at least 1 is needed"));
    }
    match name {
        BackendName::Cpu => Ok(Opened { chosen: cpu(threads)?, line: None }),
        BackendName::Vulkan => Ok(vulkan(self::vulkan()?, "as requested")),
        BackendName::Auto => match suitable_gpu() {
            Ok(on) => Ok(vulkan(on, "since that is a GPU")),
            Err(why) => Ok(Opened { chosen: cpu(threads)?, line: Some(format!("backend: cpu, since {why}")) }),
        },
    }
}

/// Opens the Vulkan devices of `--device`, at least one; `all` is all suitable GPUs. A device that is listed twice is opened
/// twice.
///
/// # Errors
/// [`Fault::Input`] naming the device that is unknown or not suitable.
pub fn open_devices(wanted: &[String]) -> Result<Vec<Vulkan>, Fault> {
    let all = || gpu::gpus().map_err(|why| Fault::Input(format!("--device all: {why}")));
    let wanted = if wanted == ["all"] { all()? } else { wanted.to_vec() };
    wanted.iter().map(|device| open_device(device)).collect()
}

/// Opens a Vulkan device by its index or a part of its name.
///
/// # Errors
/// [`Fault::Input`] naming the device that is unknown or not suitable.
pub fn open_device(wanted: &str) -> Result<Vulkan, Fault> {
    let on = device_named(wanted)?;
    say!("{}", requested(&on));
    Ok(on)
}

/// As [`open_device`], without the report.
///
/// # Errors
/// As [`open_device`].
pub fn open_device_quietly(wanted: &str) -> Result<Opened, Fault> {
    let on = device_named(wanted)?;
    Ok(Opened { line: Some(requested(&on)), chosen: Chosen::Vulkan(Box::new(on)) })
}

fn requested(on: &Vulkan) -> String {
    format!("backend: vulkan on {}, as requested", device(on))
}

fn device_named(wanted: &str) -> Result<Vulkan, Fault> {
    let mut options = Options::default();
    options.disk_cache = true;
    options.device = Some(wanted.to_owned());
    Vulkan::with_options(&options).map_err(|error| Fault::Input(format!("--device {wanted}: {}", gpu::why_not(&error))))
}

fn cpu(threads: Option<usize>) -> Result<Chosen, Fault> {
    Ok(Chosen::Cpu(match threads {
        Some(threads) => Cpu::with_threads(threads)?,
        None => Cpu::new()?,
    }))
}

/// The device that the library prefers, or that the user selected; includes software drivers.
///
/// # Errors
/// [`Fault::Input`]: no loader, no driver, or no suitable device with what each lacks.
pub fn vulkan() -> Result<Vulkan, Fault> {
    let mut options = Options::default();
    options.disk_cache = true;
    Vulkan::with_options(&options).map_err(|error| Fault::Input(format!("--backend vulkan: {}", gpu::why_not(&error))))
}

/// A device that is not a software driver, or why there is none.
fn suitable_gpu() -> Result<Vulkan, String> {
    gpu::prefers_gpu()?;
    Vulkan::new().map_err(|error| gpu::why_not(&error))
}

fn device(on: &Vulkan) -> String {
    let limits = on.limits();
    format!("{} ({})", limits.name, limits.driver)
}

/// One line for each device that Vulkan lists.
///
/// # Errors
/// [`Fault::Input`] if there is no loader or no driver.
pub fn list() -> Result<Vec<String>, Fault> {
    gpu::list().map_err(Fault::Input)
}
