//! Standard error, whose reader may leave and whose disk may be full at any time: neither ends a render.

use std::fmt;
use std::io::Write;

/// Prints a line on standard error, formatted as by [`format!`]; a failure to write is ignored.
macro_rules! say {
    ($($text:tt)*) => { $crate::stderr::line(::std::format_args!($($text)*)) };
}

/// Writes a line to standard error at once, if that is possible.
pub fn line(text: fmt::Arguments<'_>) {
    // In one call, so that lines of threads do not mix.
    let _ = std::io::stderr().lock().write_all(format!("{text}\n").as_bytes());
}
