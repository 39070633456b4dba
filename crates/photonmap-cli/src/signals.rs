//! Signals: those that ask for an end, and those whose default would end the program in the middle of a write.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::fault::{Fault, INTERRUPTED};

/// A flag that is set by Ctrl-C, SIGTERM and SIGHUP. A process has one, which later renders share.
///
/// # Errors
/// [`Fault::Failure`] if the system refuses the handler.
pub fn stop() -> Result<Arc<AtomicBool>, Fault> {
    static FLAG: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);
    let mut flag = FLAG.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(stop) = &*flag {
        stop.store(false, Ordering::SeqCst);
        return Ok(Arc::clone(stop));
    }
    let stop = Arc::new(AtomicBool::new(false));
    let heard = Arc::clone(&stop);
    let handler = move || {
        // The first signal requests the picture so far; the second ends the program at once.
        if heard.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED.into());
        }
    };
    system::keep_ignoring_hangups(|| ctrlc::set_handler(handler)).map_err(Fault::failure)?;
    *flag = Some(Arc::clone(&stop));
    Ok(stop)
}

/// Lets a write beyond the limit on file sizes fail as on a full disk, with an error that names the file.
pub fn ignore_file_size_limit() {
    system::ignore_file_size_limit();
}

#[cfg(unix)]
mod system {
    #![expect(unsafe_code, reason = "dispositions of signals, of the whole process")]

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

    pub(super) fn ignore_file_size_limit() {}
}
