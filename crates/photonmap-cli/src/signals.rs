//! Signals: those that ask for an end, and those whose default would end the program in the middle of a write.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::fault::{Fault, INTERRUPTED};

/// The flag that is set by Ctrl-C, SIGTERM and SIGHUP. A process has one handler, which later renders share.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Whether there is nothing to write yet.
static LOADING: AtomicBool = AtomicBool::new(false);

/// Installs the handler. Until [`stop`] is called, a signal ends the program at once, with a line: loading a scene and preparing a
/// device may take long, and leave nothing to write.
///
/// # Errors
/// [`Fault::Failure`] if the system refuses the handler.
pub fn end_while_loading() -> Result<(), Fault> {
    static INSTALLED: Mutex<bool> = Mutex::new(false);
    let mut installed = INSTALLED.lock().unwrap_or_else(PoisonError::into_inner);
    *FIRST.lock().unwrap_or_else(PoisonError::into_inner) = None;
    REQUESTED.store(false, Ordering::SeqCst);
    LOADING.store(true, Ordering::SeqCst);
    if !*installed {
        system::keep_ignoring_hangups(|| ctrlc::set_handler(on_signal)).map_err(Fault::failure)?;
        *installed = true;
    }
    Ok(())
}

/// From now on, the first signal sets the flag that is returned, to request the picture so far.
pub fn stop() -> &'static AtomicBool {
    LOADING.store(false, Ordering::SeqCst);
    &REQUESTED
}

/// Ends the program at the next signal without a line: why it ends is said already.
pub fn end_silently() {
    SILENT.store(true, Ordering::SeqCst);
}

static SILENT: AtomicBool = AtomicBool::new(false);

/// The time of the first signal.
static FIRST: Mutex<Option<Instant>> = Mutex::new(None);

/// Signals so soon after the first one are the same request: `timeout` and systemd send two.
const SAME_REQUEST: Duration = Duration::from_secs(1);

/// Handles a signal, on a thread of its own. A second one, at least [`SAME_REQUEST`] later, ends the program even if there is
/// something to write.
fn on_signal() {
    if SILENT.load(Ordering::SeqCst) {
        system::exit(INTERRUPTED.into());
    }
    if LOADING.load(Ordering::SeqCst) {
        say!("interrupted while loading; nothing was written");
        system::exit(INTERRUPTED.into());
    }
    let first = *FIRST.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(Instant::now);
    if REQUESTED.swap(true, Ordering::SeqCst) && first.elapsed() >= SAME_REQUEST {
        say!("interrupted again; what was not written yet is lost");
        system::exit(INTERRUPTED.into());
    }
}

/// Lets a write beyond the limit on file sizes fail as on a full disk, with an error that names the file.
pub fn ignore_file_size_limit() {
    system::ignore_file_size_limit();
}

#[cfg(unix)]
mod system {
    #![expect(unsafe_code, reason = "dispositions of signals, and the end, of the whole process")]

    use nix::libc;
    use nix::sys::signal::{SigHandler, Signal, signal};

    /// Calls `set_handlers`, but leaves SIGHUP ignored if it was, as `nohup` wishes.
    pub(super) fn keep_ignoring_hangups<T>(set_handlers: impl FnOnce() -> T) -> T {
        // SAFETY: ignoring a signal runs no code.
        let before = unsafe { signal(Signal::SIGHUP, SigHandler::SigIgn) };
        let result = set_handlers();
        if matches!(before, Ok(SigHandler::SigIgn)) {
            // SAFETY: as above.
            let _ = unsafe { signal(Signal::SIGHUP, SigHandler::SigIgn) };
        }
        result
    }

    /// Ends the process without the functions that drivers have registered for its end, which must not run while other threads
    /// are in these drivers.
    pub(super) fn exit(code: i32) -> ! {
        // SAFETY: it does not return.
        unsafe { libc::_exit(code) }
    }

    pub(super) fn ignore_file_size_limit() {
        // SAFETY: ignoring a signal runs no code.
        let _ = unsafe { signal(Signal::SIGXFSZ, SigHandler::SigIgn) };
    }
}

#[cfg(not(unix))]
mod system {
    pub(super) fn keep_ignoring_hangups<T>(set_handlers: impl FnOnce() -> T) -> T {
        set_handlers()
    }

    pub(super) fn exit(code: i32) -> ! {
        std::process::exit(code)
    }

    pub(super) fn ignore_file_size_limit() {}
}
