//! STL as text: `solid`, triangles, `endsolid`.

use super::Fault;
use super::corners::Corners;
use crate::load::obj::number;
use crate::load::text::latin_1;

/// Whether it begins as a text does, with `solid`.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    // Padding, and the end-of-file character of DOS.
    let end = bytes.iter().rposition(|byte| !matches!(byte, 0 | 0x1A)).map_or(0, |last| last + 1);
    let bytes = &bytes[..end];
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    let word = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    // Headers of binary files may begin so, too; numbers behind them have zeros.
    word.eq_ignore_ascii_case(b"solid") && !bytes.iter().take(1024).any(|&byte| byte == 0)
}

/// Bytes of the shortest triangle.
const SHORTEST: usize = "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet ".len();

/// The largest number of triangles that the file can have.
pub(super) fn most(bytes: &[u8]) -> u64 {
    let words = bytes.split(u8::is_ascii_whitespace);
    let begun = words.filter(|word| word.eq_ignore_ascii_case(b"facet")).count();
    begun.min(bytes.len() / SHORTEST) as u64
}

/// Reads at most so many triangles, by [`most`].
///
/// # Errors
/// The first word that does not belong there, with its line.
pub(super) fn read(bytes: &[u8], most: usize) -> Result<Corners, Fault> {
    let mut words = Words { rest: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), line: 1 };
    let mut corners = Corners::with_capacity(most);
    // Between solids, and in one.
    let mut is_in = false;
    while let Some(word) = words.next() {
        if word.eq_ignore_ascii_case(b"facet") && is_in {
            let triangle = corners.list.len() / 3;
            let [normal, a, b, c] =
                triangle_of(&mut words).map_err(|what| (format!("triangle {triangle}: {what}"), words.line))?;
            corners.add(normal, [a, b, c]);
        } else if word.eq_ignore_ascii_case(b"endsolid") && is_in {
            words.rest_of_line();
            is_in = false;
        } else if word.eq_ignore_ascii_case(b"solid") && !is_in {
            corners.begin(latin_1(words.rest_of_line().trim_ascii()));
            is_in = true;
        } else if word != [0x1A] && word.iter().any(|&byte| byte != 0) {
            let expected = if is_in { "'facet' or 'endsolid'" } else { "'solid'" };
            return Err((format!("'{}' is in place of {expected}", latin_1(word)), words.line));
        }
    }
    if is_in {
        return Err(("the file ends within a solid, without 'endsolid'".to_owned(), words.line));
    }
    Ok(corners)
}

/// The normal and the corners of a triangle, behind the word `facet`.
fn triangle_of(words: &mut Words<'_>) -> Result<[[f64; 3]; 4], String> {
    words.expect("normal")?;
    let normal = words.numbers()?;
    words.expect("outer")?;
    words.expect("loop")?;
    let mut corners = [[0.0; 3]; 3];
    for corner in &mut corners {
        words.expect("vertex")?;
        *corner = words.numbers()?;
    }
    words.expect("endloop")?;
    words.expect("endfacet")?;
    let [a, b, c] = corners;
    Ok([normal, a, b, c])
}

/// The words of a text that are still to be read, and the line of the last.
struct Words<'a> {
    rest: &'a [u8],
    line: u64,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        while let [space, rest @ ..] = self.rest
            && space.is_ascii_whitespace()
        {
            // That of a return and a line feed counts once.
            self.line += u64::from(*space == b'\n' || (*space == b'\r' && rest.first() != Some(&b'\n')));
            self.rest = rest;
        }
        let length = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (length > 0).then_some(word)
    }

    fn rest_of_line(&mut self) -> &'a [u8] {
        let length = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(length);
        self.rest = rest;
        line
    }

    fn expect(&mut self, keyword: &str) -> Result<(), String> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(keyword.as_bytes()) => Ok(()),
            Some(word) => Err(format!("'{}' is in place of '{keyword}'", latin_1(word))),
            None => Err(format!("the file ends in place of '{keyword}'")),
        }
    }

    fn numbers(&mut self) -> Result<[f64; 3], String> {
        let mut numbers = [0.0; 3];
        for place in &mut numbers {
            let word = self.next().ok_or("the file ends in place of a number")?;
            let parsed = str::from_utf8(word).ok().and_then(number);
            *place = parsed.ok_or_else(|| format!("'{}' is no number", latin_1(word)))?;
        }
        Ok(numbers)
    }
}
