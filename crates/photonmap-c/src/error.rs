//! Statuses, and the text of the last error of each thread.

use std::cell::RefCell;
use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};

use photon_image::fault::{Fault as Failure, chain};
use photonmap::Error;
use photonmap::film::FilmFileError;
use photonmap::scene::SceneError;

use crate::pointer;

/// Version of this interface. It is raised by changes that break compiled programs; functions, constants and fields at the
/// end of structs may be added without.
pub const PM_ABI: u32 = 1;

/// What a call returns. Except for PM_STATUS_OK, pm_last_error() has words, a handle that should have been made is NULL,
/// and arrays and structs of the caller are as they were.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PmStatus {
    /// Success.
    Ok = 0,
    /// An argument is NULL, of the wrong size, not finite or out of range.
    InvalidArgument = 1,
    /// A scene has an invalid value, or no triangles, or no camera of that name.
    InvalidScene = 2,
    /// The settings are no valid JSON, or a setting is unknown or out of range.
    InvalidSettings = 3,
    /// A file cannot be read or written, or its content is invalid.
    File = 4,
    /// Not enough memory, or more than the settings allow.
    OutOfMemory = 5,
    /// There is no suitable GPU, no driver, or no denoiser.
    NoDevice = 6,
    /// The progress function stopped the render. The film contains the passes that were finished.
    Cancelled = 7,
    /// The ray caster reported an error, or returned something invalid. The film contains the passes before.
    Caster = 8,
    /// Films do not fit together: another scene, view or settings, a pass in both, or a pass that was cut short.
    Film = 9,
    /// The device or its driver failed.
    Device = 10,
    /// A defect of the library. Free the handles of the call, and do not use them otherwise.
    Internal = 11,
}

/// A status with its words.
#[derive(Debug)]
pub(crate) struct Fault {
    status: PmStatus,
    text: String,
}

pub(crate) type Result<T = (), E = Fault> = std::result::Result<T, E>;

impl Fault {
    pub(crate) fn new(status: PmStatus, text: impl ToString) -> Self {
        Self { status, text: text.to_string() }
    }

    /// The same with another status.
    pub(crate) fn with_status(self, status: PmStatus) -> Self {
        Self { status, ..self }
    }

    #[cfg(test)]
    pub(crate) fn status(&self) -> PmStatus {
        self.status
    }

    #[cfg(test)]
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    pub(crate) fn argument(text: impl ToString) -> Self {
        Self::new(PmStatus::InvalidArgument, text)
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        let status = match &error {
            Error::InvalidSetting { .. } => PmStatus::InvalidSettings,
            Error::InvalidInput { .. } => PmStatus::InvalidArgument,
            Error::InvalidScene { .. } | Error::NoTriangles | Error::NoLight | Error::NoReceiver => {
                PmStatus::InvalidScene
            }
            Error::OutOfMemory { .. } | Error::AllocationTooLarge { .. } | Error::OverMemory { .. } => {
                PmStatus::OutOfMemory
            }
            Error::NoDevice { .. } | Error::UnknownDevice { .. } => PmStatus::NoDevice,
            Error::Cancelled => PmStatus::Cancelled,
            Error::PassTwice { .. } | Error::CutPass => PmStatus::Film,
            Error::Backend { backend: "cpu: tracing rays" | "ray caster", .. } => PmStatus::Caster,
            _ => PmStatus::Device,
        };
        Self::new(status, chain(&error))
    }
}

impl From<SceneError> for Fault {
    fn from(error: SceneError) -> Self {
        let file = matches!(
            error,
            SceneError::Read { .. }
                | SceneError::Content { .. }
                | SceneError::OtherKind { .. }
                | SceneError::UnknownFormat { .. }
        );
        let status = match error {
            _ if file => PmStatus::File,
            SceneError::PictureSize { .. } => PmStatus::InvalidArgument,
            SceneError::Memory { .. } | SceneError::OutOfMemory(_) => PmStatus::OutOfMemory,
            _ => PmStatus::InvalidScene,
        };
        Self::new(status, error)
    }
}

impl From<FilmFileError> for Fault {
    fn from(error: FilmFileError) -> Self {
        let film = matches!(error, FilmFileError::OtherKey { .. } | FilmFileError::NotStorable { .. });
        Self::new(if film { PmStatus::Film } else { PmStatus::File }, chain(&error))
    }
}

impl From<Failure> for Fault {
    fn from(error: Failure) -> Self {
        Self::new(PmStatus::File, error)
    }
}

thread_local! {
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs a call of the interface: its error, or a panic, becomes the status and the text of this thread.
pub(crate) fn call(body: impl FnOnce() -> Result) -> PmStatus {
    let result = catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message");
        Err(Fault::new(PmStatus::Internal, format!("a defect of the library, please report it: {text}")))
    });
    let (status, text) = match result {
        Ok(()) => return PmStatus::Ok,
        Err(Fault { status, text }) => (status, text),
    };
    // While the thread ends, its text may be gone.
    let _ = LAST.try_with(|last| *last.borrow_mut() = text);
    status
}

/// As [`call`], for functions that return a text's length; 0 after an error.
pub(crate) fn length(body: impl FnOnce() -> Result<usize>) -> usize {
    let mut length = 0;
    call(|| {
        length = body()?;
        Ok(())
    });
    length
}

/// Frees a handle.
pub(crate) fn free(body: impl FnOnce()) {
    call(|| {
        body();
        Ok(())
    });
}

/// The version of the interface that the library has: the same as PM_ABI of the header that a program was compiled with,
/// or the program does not fit the library.
#[unsafe(no_mangle)]
pub extern "C" fn pm_abi() -> u32 {
    PM_ABI
}

/// The version of the library, such as "0.1.0". Static; not to be freed.
#[unsafe(no_mangle)]
pub extern "C" fn pm_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Copies what the last call on this thread that failed had to say: what is wrong, and what would be valid. UTF-8, ended
/// by a zero, cut to `room` bytes. Calls that succeed do not change it.
///
/// `text` may be NULL if `room` is 0. Returns the length of the whole text without the zero; 0 if no call has failed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pm_last_error(text: *mut c_char, room: usize) -> usize {
    LAST.try_with(|last| {
        // SAFETY: the caller's buffer has `room` bytes.
        unsafe { pointer::copy_text(&last.borrow(), text, room) }
    })
    .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_status_with_words() {
        assert_eq!(call(|| std::panic::resume_unwind(Box::new("broken"))), PmStatus::Internal);
        assert!(LAST.with(|last| last.borrow().contains("broken")));
        assert_eq!(call(|| Err(Fault::argument("k is 0"))), PmStatus::InvalidArgument);
        assert_eq!(call(|| Ok(())), PmStatus::Ok);
        assert_eq!(LAST.with(|last| last.borrow().clone()), "k is 0");
        assert_eq!(length(|| Ok(3)), 3);
        assert_eq!(length(|| Err(Fault::argument(""))), 0);
    }

    #[test]
    fn errors_of_the_ray_caster_have_their_own_status() {
        let of = |backend| Fault::from(Error::Backend { backend, source: "broken".into() });
        let fault = of("cpu: tracing rays");
        assert_eq!(fault.status, PmStatus::Caster);
        assert!(fault.text.contains("broken"), "{}", fault.text);
        assert_eq!(of("cpu: starting threads").status, PmStatus::Device);
        assert_eq!(Fault::from(Error::CutPass).status, PmStatus::Film);
    }
}
