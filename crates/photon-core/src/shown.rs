//! Text of files in messages.

use std::borrow::Cow;

/// Characters of the longest text, and of its beginning where the middle is left out.
const LONGEST: usize = 300;
const BEGINNING: usize = 200;

/// Text of a file for a message: characters that a terminal obeys, or that change the direction of writing, are escaped, and
/// of more than 300 characters the middle is left out.
///
/// ```
/// assert_eq!(photon_core::shown("red\u{1b}[31m"), "red\\u{1b}[31m");
/// assert_eq!(photon_core::shown(&"long ".repeat(1000)).chars().count(), 300);
/// ```
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
    if text.len() <= LONGEST && !text.chars().any(is_unsafe) {
        return Cow::Borrowed(text);
    }
    let mut beginning = String::new();
    let mut count = 0;
    for (at, character) in text.char_indices() {
        let length = length(character);
        if count + length > BEGINNING && escaped_length(&text[at..]) > LONGEST - count {
            let room = LONGEST - 1 - count;
            return Cow::Owned(beginning + "…" + &ending(text, room));
        }
        push(&mut beginning, character);
        count += length;
    }
    Cow::Owned(beginning)
}

/// A number for a message, with an exponent where it would have many digits.
pub(crate) fn number(number: f64) -> String {
    if number == 0.0 || (1e-5..1e16).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") }
}

/// The last characters that fit into `room`.
fn ending(text: &str, mut room: usize) -> String {
    let fits = |&character: &char| {
        let left = room.checked_sub(length(character));
        room = left.unwrap_or(room);
        left.is_some()
    };
    let last: Vec<char> = text.chars().rev().take_while(fits).collect();
    let mut ending = String::new();
    last.into_iter().rev().for_each(|character| push(&mut ending, character));
    ending
}

/// The length when escaped, or more than [`LONGEST`] if it is.
fn escaped_length(text: &str) -> usize {
    text.chars().take(LONGEST + 1).map(length).sum()
}

fn is_unsafe(character: char) -> bool {
    let is_invisible = matches!(
        character,
        '\u{61C}' | '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{2069}' | '\u{FEFF}'
    );
    character.is_control() || is_invisible
}

fn length(character: char) -> usize {
    if is_unsafe(character) { character.escape_default().len() } else { 1 }
}

fn push(text: &mut String, character: char) {
    if is_unsafe(character) {
        text.extend(character.escape_default());
    } else {
        text.push(character);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_reaches_a_terminal_that_it_obeys() {
        for (text, expected) in [
            ("plain, Größe 日本", "plain, Größe 日本"),
            ("a\u{1b}]0;title\u{7}b", "a\\u{1b}]0;title\\u{7}b"),
            ("two\nlines\tand\r", "two\\nlines\\tand\\r"),
            ("\u{202e}gnp.exe \u{9b}", "\\u{202e}gnp.exe \\u{9b}"),
        ] {
            assert_eq!(shown(text), expected);
        }
    }

    #[test]
    fn the_middle_of_long_text_is_left_out() {
        for part in ["a", "ä", "\u{1b}", "日\n"] {
            for count in [1, 60, 150, 299, 300, 301, 1000, 100_000] {
                let text = format!("begin {} end", part.repeat(count));
                let found = shown(&text);
                assert!(found.chars().count() <= LONGEST && found.starts_with("begin ") && found.ends_with(" end"));
                let whole = escaped_length(&text);
                assert_eq!(whole > LONGEST, found.contains('…'), "{part:?} {count}");
            }
        }
    }
}
