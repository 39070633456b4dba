//! Standard error, whose reader may leave and whose disk may be full at any time: neither ends a render.

use std::borrow::Cow;
use std::fmt;
use std::io::Write;

/// Prints a line on standard error, formatted as by [`format!`]; a failure to write is ignored.
macro_rules! say {
    ($($text:tt)*) => { $crate::stderr::line(::std::format_args!($($text)*)) };
}

/// Writes a line to standard error at once, if that is possible.
pub fn line(text: fmt::Arguments<'_>) {
    // In one call, so that lines of threads do not mix.
    let _ = std::io::stderr().lock().write_all(format!("{}\n", harmless(&text.to_string())).as_bytes());
}

/// Writes text with commands for the terminal, in which nothing comes from elsewhere, such as a picture of coloured characters.
pub fn commands(text: &str) {
    let _ = std::io::stderr().lock().write_all(format!("{text}\n").as_bytes());
}

/// The text without characters that a terminal obeys, which names of files may contain.
fn harmless(text: &str) -> Cow<'_, str> {
    let is_unsafe = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    if !text.contains(is_unsafe) {
        return Cow::Borrowed(text);
    }
    let escaped = |c: char| if is_unsafe(c) { c.escape_default().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(escaped).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_do_not_command_the_terminal() {
        assert_eq!(harmless("wrote a\u{1b}[31m.png\u{9b}\r"), "wrote a\\u{1b}[31m.png\\u{9b}\\r");
        assert_eq!(harmless("two\nlines\tof é"), "two\nlines\tof é");
    }
}
