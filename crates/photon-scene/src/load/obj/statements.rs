//! Statements of an OBJ file, and the references in them.

use crate::load::group::NONE;
use std::borrow::Cow;

/// The statements of a file, each with the number of its first line: a backslash at the end joins a line with the next, unless
/// it is that of a comment, such as the name of a folder.
pub(in crate::load) fn statements(text: &str) -> impl Iterator<Item = (Cow<'_, str>, usize)> {
    let begun = |line: &'_ str| line.trim_end().strip_suffix('\\').map(str::len);
    let is_comment = |line: &str| parts(line).0 == "#";
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(end) = begun(line).filter(|_| !is_comment(line)) else {
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

/// The keyword of a statement and what follows it; comments have `#`.
pub(in crate::load) fn parts(statement: &str) -> (&str, &str) {
    // Files that were put together have a byte order mark in the middle.
    let statement = statement.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{FEFF}').trim_end();
    // Only at the start: names may contain '#'.
    if statement.starts_with('#') {
        return ("#", "");
    }
    let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
    (keyword, rest.trim())
}

/// The words of a statement with numbers, as far as a comment begins.
pub(in crate::load) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split('#').next().unwrap_or_default().split_whitespace()
}

/// A name as written, and without the quotes or the comment that some programs write.
pub(in crate::load) fn spellings(name: &str) -> [&str; 2] {
    let bare = name.split(" #").next().unwrap_or(name).trim_end();
    [name, bare.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(bare)]
}

/// A number, or NaN in the spelling of any compiler, such as `1.#QNAN` and `nan(ind)`; `None` for other words.
pub(in crate::load) fn number(word: &str) -> Option<f64> {
    let is_nan = || {
        let unsigned = word.trim_start_matches(['-', '+']);
        unsigned.contains(".#") || unsigned.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("nan"))
    };
    word.parse().ok().or_else(|| is_nan().then_some(f64::NAN))
}

/// A reference, from 1 or backwards from -1, to one of `all` definitions of which `before` come before the face.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Reference {
    /// There is none.
    Absent,
    /// Its index, from 0.
    To(u32),
    /// It refers to nothing.
    Wrong,
}

impl Reference {
    /// Its index, or [`NONE`].
    pub(super) fn index(self) -> u32 {
        if let Self::To(index) = self { index } else { NONE }
    }

    pub(super) fn parse(word: Option<&str>, before: usize, all: usize) -> Self {
        let Some(word) = word.filter(|word| !word.is_empty()) else { return Self::Absent };
        let Ok(number) = word.parse::<i64>() else { return Self::Wrong };
        let index = if number > 0 { Some(number - 1) } else { (before as i64).checked_add(number) };
        let index = index.and_then(|index| u32::try_from(index).ok()).filter(|&index| (index as usize) < all);
        index.filter(|_| number != 0).map_or(Self::Wrong, Self::To)
    }
}
