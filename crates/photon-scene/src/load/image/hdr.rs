//! Radiance HDR (RGBE): flat scanlines, and both kinds of run-length encoding (Ward, "Real pixels", Graphics Gems II).

use std::borrow::Cow;

use super::header::Header;
use super::{Image, ImageError, check_size, primaries_remark};

/// Widths for which the newer encoding is defined.
const RUN_WIDTHS: std::ops::RangeInclusive<usize> = 8..=0x7FFF;

pub(super) fn header(file: &[u8]) -> Result<Header, ImageError> {
    let mut reader = Reader { rest: file };
    lines(&mut reader)?;
    let size = orientation(&reader.line()?)?.size;
    // Mirrored images are copied.
    Ok(Header { size, words: 4, decoding: 3 * Header::floats(size) + 4096, is_by_rows: false })
}

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
    let mut reader = Reader { rest: file };
    let Lines { factors, remarks } = lines(&mut reader)?;
    let Orientation { size, flip_x, flip_y } = orientation(&reader.line()?)?;
    let [width, height] = size.map(|side| side as usize);
    // Grows with the data, so that a short file does not take the memory of a large image.
    let mut texels: Vec<[f32; 4]> = Vec::new();
    texels
        .try_reserve_exact(width.saturating_mul(height).min(4 * file.len()))
        .map_err(|_| ImageError::new("is too large"))?;
    let mut row = vec![[0_u8; 4]; width];
    for _ in 0..height {
        reader.scanline(&mut row)?;
        let values = row.iter().map(|&texel| linear(texel, factors));
        if flip_x { texels.extend(values.rev()) } else { texels.extend(values) }
    }
    if flip_y {
        let rows: Vec<&[[f32; 4]]> = texels.chunks_exact(width).rev().collect();
        texels = rows.concat();
    }
    Ok(Image { remarks, ..Image::of_floats(size, texels) })
}

/// Contents of the lines before the resolution.
struct Lines {
    /// Those by which red, green and blue were multiplied.
    factors: [f32; 3],
    remarks: Vec<String>,
}

fn lines(reader: &mut Reader<'_>) -> Result<Lines, ImageError> {
    let (mut factors, mut remarks) = ([1.0_f32; 3], Vec::new());
    loop {
        let line = reader.line()?;
        let line = line.trim();
        if line.is_empty() {
            return Ok(Lines { factors, remarks });
        }
        if let Some(format) = line.strip_prefix("FORMAT=") {
            if format.trim() != "32-bit_rle_rgbe" {
                return Err(ImageError::new(format!("is a Radiance file of the format {format}; only RGBE is read")));
            }
            continue;
        }
        let (name, value) = line.split_once('=').unwrap_or((line, ""));
        let mut given = value.split_whitespace().map(|number| number.parse().unwrap_or(0.0_f32));
        let mut number = || given.next().unwrap_or(0.0);
        let more = match name.trim_end() {
            "EXPOSURE" => [number(); 3],
            "COLORCORR" => [number(), number(), number()],
            "PRIMARIES" => {
                remarks.extend(primaries_remark(&given.collect::<Vec<_>>()));
                continue;
            }
            _ => continue,
        };
        factors.iter_mut().zip(more).for_each(|(factor, more)| *factor *= more);
        if !(factors.iter().all(|factor| factor.is_normal() && *factor > 0.0) && given.next().is_none()) {
            let what = if name.starts_with('E') { "exposure" } else { "colour correction" };
            return Err(ImageError::new(format!("has the {what} '{value}', which must be positive numbers")));
        }
    }
}

struct Orientation {
    size: [u32; 2],
    flip_x: bool,
    flip_y: bool,
}

/// Parses a line such as `-Y 512 +X 1024`.
fn orientation(line: &str) -> Result<Orientation, ImageError> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let invalid =
        || ImageError::new(format!("has the resolution '{line}'; rows along x are read, as in '-Y 512 +X 1024'"));
    let [y @ ("-Y" | "+Y"), rows, x @ ("-X" | "+X"), columns] = words[..] else { return Err(invalid()) };
    let (Ok(height), Ok(width)) = (rows.parse::<u32>(), columns.parse::<u32>()) else { return Err(invalid()) };
    let size = check_size(width.into(), height.into(), 4)?;
    Ok(Orientation { size, flip_x: x == "-X", flip_y: y == "+Y" })
}

/// The value of a texel; its mantissas are whole numbers of 256ths.
fn linear([r, g, b, exponent]: [u8; 4], factors: [f32; 3]) -> [f32; 4] {
    if exponent == 0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    // In f64, where no exponent underflows.
    let unit = libm::exp2(f64::from(exponent) - 136.0);
    let value = |mantissa: u8, factor: f32| (f64::from(mantissa) * (unit / f64::from(factor))) as f32;
    [value(r, factors[0]), value(g, factors[1]), value(b, factors[2]), 1.0]
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn truncated() -> ImageError {
        ImageError::new("cannot be decoded as Radiance HDR: it is truncated or damaged")
    }

    /// A line of the header, in which names and comments may have any encoding.
    fn line(&mut self) -> Result<Cow<'a, str>, ImageError> {
        // Headers have short lines.
        let end = self.rest.iter().take(4096).position(|&byte| byte == b'\n').ok_or_else(Self::truncated)?;
        let line = &self.rest[..end];
        self.rest = &self.rest[end + 1..];
        Ok(String::from_utf8_lossy(line))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], ImageError> {
        let (first, rest) = self.rest.split_first_chunk().ok_or_else(Self::truncated)?;
        self.rest = rest;
        Ok(*first)
    }

    fn scanline(&mut self, row: &mut [[u8; 4]]) -> Result<(), ImageError> {
        let is_run = self.rest.starts_with(&[2, 2]) && self.rest.get(2).is_some_and(|high| high & 0x80 == 0);
        if RUN_WIDTHS.contains(&row.len()) && is_run { self.channels(row) } else { self.texels(row) }
    }

    /// The newer encoding: four channels one after the other, each in runs and literal stretches.
    fn channels(&mut self, row: &mut [[u8; 4]]) -> Result<(), ImageError> {
        let [_, _, high, low] = self.take()?;
        if usize::from(high) << 8 | usize::from(low) != row.len() {
            return Err(Self::truncated());
        }
        for channel in 0..4 {
            let mut place = 0;
            while place < row.len() {
                let [count] = self.take()?;
                let is_run = count > 128;
                let length = usize::from(if is_run { count - 128 } else { count });
                let stretch = row.get_mut(place..place + length).filter(|stretch| !stretch.is_empty());
                let stretch = stretch.ok_or_else(Self::truncated)?;
                if is_run {
                    let [value] = self.take()?;
                    stretch.iter_mut().for_each(|texel| texel[channel] = value);
                } else {
                    for texel in stretch {
                        [texel[channel]] = self.take()?;
                    }
                }
                place += length;
            }
        }
        Ok(())
    }

    /// Flat texels, and the older encoding: (1, 1, 1, n) repeats the previous texel n times; the count of each further
    /// one in a row is shifted by 8 bits more.
    fn texels(&mut self, row: &mut [[u8; 4]]) -> Result<(), ImageError> {
        let mut place = 0;
        let mut shift = 0;
        while place < row.len() {
            let texel: [u8; 4] = self.take()?;
            if let [1, 1, 1, count] = texel {
                let length = usize::from(count).checked_shl(shift).unwrap_or(usize::MAX);
                let previous = *place.checked_sub(1).and_then(|before| row.get(before)).ok_or_else(Self::truncated)?;
                let end = place.checked_add(length).ok_or_else(Self::truncated)?;
                row.get_mut(place..end).ok_or_else(Self::truncated)?.fill(previous);
                place = end;
                // Four runs of count 0 in a row mean nothing any more.
                shift = (shift + 8).min(32);
            } else {
                row[place] = texel;
                place += 1;
                shift = 0;
            }
        }
        Ok(())
    }
}
