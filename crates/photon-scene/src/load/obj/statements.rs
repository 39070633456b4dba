//! Statements of an OBJ file, and the references in them.

use std::borrow::Cow;

/// The statements of a file, each with the number of its first line: a backslash at the end joins a line with the next.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (Cow<'_, str>, usize)> {
    let begun = |line: &'_ str| line.trim_end().strip_suffix('\\').map(str::len);
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(end) = begun(line) else {
            return Some((Cow::Borrowed(line), index + 1));
        };
        let mut joined = line[..end].to_owned();
        for (_, line) in lines.by_ref() {
            joined.push(' ');
            match begun(line) {
                Some(end) => joined.push_str(&line[..end]),
                None => {
                    joined.push_str(line);
                    break;
                }
            }
        }
        Some((Cow::Owned(joined), index + 1))
    })
}

/// Converts a reference, from 1 or backwards from -1, to an index from 0; `None` if it is out of range.
pub(super) fn resolve(word: &str, before: usize, all: usize) -> Option<usize> {
    let number: i64 = word.parse().ok()?;
    let index = if number > 0 { number - 1 } else { (before as i64).checked_add(number)? };
    usize::try_from(index).ok().filter(|&index| number != 0 && index < all)
}
