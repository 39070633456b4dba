//! Standard output, whose reader may close it at any time.

use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::fault::Fault;

/// Whether an option names standard output in place of a file.
#[must_use]
pub fn is_meant(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes to standard output. A reader that has closed its end, such as `head`, is not an error.
///
/// # Errors
/// [`Fault::Failure`] for any other reason why it cannot be written.
pub fn write(bytes: &[u8]) -> Result<(), Fault> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(why) if why.kind() != ErrorKind::BrokenPipe => {
            Err(Fault::failure(format!("standard output cannot be written: {why}")))
        }
        _ => Ok(()),
    }
}
