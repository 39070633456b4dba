//! Selection of a backend: the CPU or a Vulkan device, and the reason for it.

use backend_cpu::Cpu;
use backend_vulkan::{Candidate, Options, Vulkan};
use clap::ValueEnum;
use photon_core::Render;
use photon_scene::CompressedTree;

use crate::fault::{Fault, chain};

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

/// The environment variable that selects a device.
const DEVICE: &str = "PHOTON_VK_DEVICE";

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
        BackendName::Auto => match gpu() {
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
    let all = || gpus().map_err(|why| Fault::Input(format!("--device all: {why}")));
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
    Vulkan::with_options(&options).map_err(|error| Fault::Input(format!("--device {wanted}: {}", why_not(&error))))
}

/// Indices of all suitable devices that are not software drivers, at least one.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn gpus() -> Result<Vec<String>, String> {
    let found = backend_vulkan::devices().map_err(|error| why_not(&error))?;
    worth_it(&found.iter().map(Summary::from).collect::<Vec<_>>())?;
    let suitable = found.iter().filter(|device| device.lacks.is_empty() && device.kind != SOFTWARE);
    Ok(suitable.map(|device| device.index.to_string()).collect())
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
    Vulkan::with_options(&options).map_err(|error| Fault::Input(format!("--backend vulkan: {}", why_not(&error))))
}

/// A device that is not a software driver, or why there is none.
fn gpu() -> Result<Vulkan, String> {
    prefers_gpu()?;
    Vulkan::new().map_err(|error| why_not(&error))
}

/// Whether the device that the library prefers, or that the user selected, is a GPU and no software driver; none is opened.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn prefers_gpu() -> Result<(), String> {
    let found = backend_vulkan::devices().map_err(|error| why_not(&error))?;
    worth_it(&found.iter().map(Summary::from).collect::<Vec<_>>())?;
    let preferred = backend_vulkan::preferred().map_err(|error| why_not(&error))?;
    // The user may have selected a software device.
    if preferred.kind == SOFTWARE {
        return Err(format!("{DEVICE} selects {}, which is a software driver", preferred.name));
    }
    Ok(())
}

/// Opens the device that the user selected by PHOTON_VK_DEVICE, of whatever kind, else a GPU: without a selection never a
/// software driver, which is slower than the cores of the CPU.
///
/// # Errors
/// The devices in words, and what each lacks.
pub fn requested_gpu() -> Result<Vulkan, String> {
    if std::env::var_os(DEVICE).is_none_or(|value| value.is_empty()) {
        prefers_gpu()?;
    }
    Vulkan::new().map_err(|error| chain(&error))
}

const SOFTWARE: &str = "software";

/// The properties of a candidate that determine the choice.
struct Summary<'a> {
    name: &'a str,
    kind: &'a str,
    lacks: &'a [String],
}

impl<'a> From<&'a Candidate> for Summary<'a> {
    fn from(candidate: &'a Candidate) -> Self {
        Self { name: &candidate.name, kind: candidate.kind, lacks: &candidate.lacks }
    }
}

/// Whether some device is expected to be faster than the CPU.
fn worth_it(found: &[Summary<'_>]) -> Result<(), String> {
    if found.iter().any(|device| device.lacks.is_empty() && device.kind != SOFTWARE) {
        return Ok(());
    }
    let why = |device: &Summary<'_>| {
        if device.lacks.is_empty() {
            format!("{} is a software driver", device.name)
        } else {
            format!("{} lacks {}", device.name, device.lacks.join(", "))
        }
    };
    let all: Vec<String> = found.iter().map(why).collect();
    Err(match all.as_slice() {
        [] => "Vulkan lists no device".to_owned(),
        all => format!("no Vulkan device is a suitable GPU: {}", all.join("; ")),
    })
}

/// Why Vulkan is not available, and what to do about it.
fn why_not(error: &photon_core::Error) -> String {
    let photon_core::Error::NoDevice { rejected } = error else { return chain(error) };
    let hint =
        format!("update its driver, select another by {DEVICE} (`photonmap devices` lists them), or use --backend cpu");
    if rejected.is_empty() {
        return format!("Vulkan lists no device: {hint}");
    }
    let each: Vec<String> = rejected.iter().map(|(name, why)| format!("{name} {why}")).collect();
    format!("no suitable Vulkan device; there are: {}; {hint}", each.join("; "))
}

fn device(on: &Vulkan) -> String {
    let limits = on.limits();
    format!("{} ({})", limits.name, limits.driver)
}

/// The devices of renderers, in words.
#[must_use]
pub fn names(renderers: &[Box<dyn Render>]) -> String {
    let all: Vec<String> = renderers.iter().map(|renderer| renderer.facts().device).collect();
    match all.as_slice() {
        [device] => device.clone(),
        [first, others @ ..] if others.iter().all(|other| other == first) => format!("{} × {first}", all.len()),
        _ => all.join(", "),
    }
}

/// One line for each device that Vulkan lists.
///
/// # Errors
/// [`Fault::Input`] if there is no loader or no driver.
pub fn list() -> Result<Vec<String>, Fault> {
    let found = backend_vulkan::devices().map_err(|error| Fault::Input(why_not(&error)))?;
    let line = |device: &Candidate| {
        let (major, minor) = device.version;
        let verdict =
            if device.lacks.is_empty() { "suitable".to_owned() } else { format!("lacks {}", device.lacks.join(", ")) };
        format!("{}: {}, {}, Vulkan {major}.{minor}, {verdict}", device.index, device.name, device.kind)
    };
    Ok(found.iter().map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_suitable_gpu_is_worth_leaving_the_processor() {
        let lack = ["bufferDeviceAddress".to_owned()];
        let soft = || Summary { name: "Soft", kind: SOFTWARE, lacks: &[] };
        let old = || Summary { name: "Old", kind: "discrete GPU", lacks: &lack };
        let new = || Summary { name: "New", kind: "integrated GPU", lacks: &[] };
        assert!(worth_it(&[soft(), old(), new()]).is_ok());
        let why = worth_it(&[soft(), old()]).unwrap_err();
        assert!(why.contains("Soft is a software driver") && why.contains("Old lacks bufferDeviceAddress"), "{why}");
        assert!(worth_it(&[]).unwrap_err().contains("no device"));
    }

    #[test]
    fn each_rejected_device_is_named_with_what_it_lacks() {
        let rejected = vec![("Old".to_owned(), "lacks timelineSemaphore".to_owned())];
        let text = why_not(&photon_core::Error::NoDevice { rejected });
        assert!(text.contains("Old lacks timelineSemaphore") && text.contains("--backend cpu"), "{text}");
    }
}
