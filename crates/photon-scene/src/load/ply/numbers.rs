//! The numbers after the header of a PLY file, one after another.

use photon_core::parallel;

use super::header::{Encoding, Fault, Kind};
use crate::load::obj::number;

/// Rows that a thread takes at a time.
const PART: usize = 1 << 14;

/// The numbers of a file that are still to be read.
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    /// Name and number of the present element, for messages.
    pub(super) element: (&'a str, u64),
    /// An element did not begin on a line of its own.
    is_run_on: bool,
}

const ENDS: &str = "the file ends within it";

impl<'a> Numbers<'a> {
    /// Those that begin at byte `at`.
    pub(super) fn new(bytes: &'a [u8], at: usize, encoding: Encoding) -> Self {
        Self { bytes, at, encoding, element: ("", 0), is_run_on: false }
    }

    /// Begins the element of that number.
    pub(super) fn begin(&mut self, name: &'a str, index: u64) {
        self.element = (name, index);
        if self.encoding == Encoding::Text {
            let is_first = self.at == 0 || matches!(self.bytes[self.at - 1], b'\n' | b'\r');
            let from = self.at;
            self.skip_space();
            let has_end = self.bytes[from..self.at].iter().any(|byte| matches!(byte, b'\n' | b'\r'));
            self.is_run_on |= !is_first && !has_end;
        }
    }

    /// The next number. Integers of 64 bits are rounded.
    pub(super) fn float(&mut self, kind: Kind) -> Result<f64, Fault> {
        if self.encoding == Encoding::Text {
            let word = self.word()?;
            return number(word).ok_or_else(|| self.fault(&format!("'{word}' is no number")));
        }
        let found = decode(self.encoding, kind, &self.bytes[self.at..]).ok_or_else(|| self.fault(ENDS))?;
        self.at += kind.bytes();
        Ok(found)
    }

    /// The next `count` elements of a binary file, if they are there, as rows of `stride` bytes. They are still to be read.
    pub(super) fn rows(&self, count: usize, stride: usize) -> Option<Rows<'a>> {
        let bytes = self.bytes[self.at..].get(..count.checked_mul(stride)?)?;
        let is_binary = self.encoding != Encoding::Text && stride > 0;
        is_binary.then_some(Rows { bytes, stride, encoding: self.encoding })
    }

    /// The next number as the length of a list; each of its numbers takes a byte at least.
    pub(super) fn length(&mut self, kind: Kind) -> Result<usize, Fault> {
        let length = self.float(kind)?;
        if !(0.0..=self.bytes.len() as f64).contains(&length) || length.fract() != 0.0 {
            return Err(self.fault(&format!("a list of {length} numbers is longer than the file, or no list")));
        }
        Ok(length as usize)
    }

    /// Skips `count` numbers.
    pub(super) fn skip(&mut self, kind: Kind, count: usize) -> Result<(), Fault> {
        if self.encoding == Encoding::Text {
            return (0..count).try_for_each(|_| self.word().map(drop));
        }
        let end = count.checked_mul(kind.bytes()).and_then(|length| self.at.checked_add(length));
        self.at = end.filter(|&end| end <= self.bytes.len()).ok_or_else(|| self.fault(ENDS))?;
        Ok(())
    }

    /// Number of bytes, or of words of a text, that are left over at the end.
    ///
    /// # Errors
    /// A text with words left over, of which some lines have more numbers than the header says.
    pub(super) fn rest(&mut self) -> Result<usize, Fault> {
        let rest = &self.bytes[self.at..];
        if self.encoding != Encoding::Text {
            return Ok(rest.len());
        }
        let left = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty() && *word != [0x1A]).count();
        let is_aligned =
            rest.iter().take_while(|byte| byte.is_ascii_whitespace()).any(|byte| matches!(byte, b'\n' | b'\r'))
                || self.at == 0
                || matches!(self.bytes[self.at - 1], b'\n' | b'\r');
        if left > 0 && (self.is_run_on || !is_aligned) {
            return Err(self.fault("there are more numbers than the header says"));
        }
        Ok(left)
    }

    /// Names the present element and, in a text, the line.
    pub(super) fn fault(&self, what: &str) -> Fault {
        let line = match self.encoding {
            Encoding::Text => {
                let read = &self.bytes[..self.at.min(self.bytes.len())];
                let read = read.trim_ascii_end();
                let ends = read.windows(2).filter(|pair| pair[0] == b'\n' || (pair[0] == b'\r' && pair[1] != b'\n'));
                ends.count() as u64 + 1
            }
            _ => 0,
        };
        let (name, index) = self.element;
        (format!("{name} {index}: {what}"), line)
    }

    fn skip_space(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
    }

    fn word(&mut self) -> Result<&'a str, Fault> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.fault(ENDS));
        }
        self.at += length;
        str::from_utf8(&rest[..length]).map_err(|_| self.fault("a word is no number"))
    }
}

/// The number at the start of `bytes`; `None` if they end within it.
fn decode(encoding: Encoding, kind: Kind, bytes: &[u8]) -> Option<f64> {
    macro_rules! binary {
        ($number:ty) => {{
            let bytes = *bytes.first_chunk()?;
            let little = encoding == Encoding::LittleEndian;
            (if little { <$number>::from_le_bytes(bytes) } else { <$number>::from_be_bytes(bytes) }) as f64
        }};
    }
    Some(match kind {
        Kind::I8 => binary!(i8),
        Kind::U8 => binary!(u8),
        Kind::I16 => binary!(i16),
        Kind::U16 => binary!(u16),
        Kind::I32 => binary!(i32),
        Kind::U32 => binary!(u32),
        Kind::I64 => binary!(i64),
        Kind::U64 => binary!(u64),
        Kind::F32 => binary!(f32),
        Kind::F64 => binary!(f64),
    })
}

/// Elements of equal lengths in a binary file, which several threads read.
pub(super) struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    encoding: Encoding,
}

/// A number in each row: its first byte, its type, and its place in what is made of the row.
pub(super) type Field = (usize, Kind, usize);

impl Rows<'_> {
    /// Reads these fields of all rows.
    pub(super) fn read<const N: usize>(&self, list: &mut [[f64; N]], fields: &[Field]) {
        let parts = list.chunks_mut(PART).zip(self.bytes.chunks(PART * self.stride));
        parallel::for_each(parallel::threads(), parts, |_, (list, rows)| {
            for (row, to) in rows.chunks_exact(self.stride).zip(list) {
                for &(from, kind, place) in fields {
                    to[place] = decode(self.encoding, kind, &row[from..]).unwrap_or_default();
                }
            }
        });
    }

    /// The lists of rows that consist of one of `sides` vertices each; `None` if one is of another length or refers to a vertex
    /// that does not exist.
    pub(super) fn polygons(&self, [length, kind]: [Kind; 2], sides: usize, vertices: u64) -> Option<Vec<u32>> {
        let mut corners = vec![0_u32; self.bytes.len() / self.stride * sides];
        let number = |kind, bytes: &[u8]| decode(self.encoding, kind, bytes);
        let of = |rows: &[u8], corners: &mut [u32]| {
            rows.chunks_exact(self.stride).zip(corners.chunks_exact_mut(sides)).all(|(row, corners)| {
                number(length, row) == Some(sides as f64)
                    && row[length.bytes()..].chunks_exact(kind.bytes()).zip(corners).all(|(bytes, to)| {
                        let vertex = number(kind, bytes).and_then(|number| existing(number, vertices));
                        *to = vertex.unwrap_or_default();
                        vertex.is_some()
                    })
            })
        };
        let parts = self.bytes.chunks(PART * self.stride).zip(corners.chunks_mut(PART * sides));
        let are_right = parallel::map(parallel::threads(), parts, |_, (rows, corners)| of(rows, corners));
        are_right.into_iter().all(|is_right| is_right).then_some(corners)
    }
}

/// A number of the file as the index of one of its vertices.
pub(super) fn existing(number: f64, vertices: u64) -> Option<u32> {
    (number >= 0.0 && number < vertices as f64 && number.fract() == 0.0).then_some(number as u32)
}
