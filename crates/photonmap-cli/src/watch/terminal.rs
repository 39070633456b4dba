//! The picture so far in the terminal: two pixels for each character, as its colour and that of its background.

use std::fmt::Write as _;

use console::Term;
use photon_core::{Display, DisplayImage, Film, decode_srgb, encode_srgb};

use super::Sink;
use crate::command::picture::Look;
use crate::exposure;
use crate::fault::Fault;

/// Lines that are left for progress and messages.
const FREE_LINES: usize = 3;

pub(super) struct Terminal {
    look: Look,
    /// Lines of the last picture, which the next one covers.
    lines: usize,
}

impl Terminal {
    pub(super) fn new(look: Look) -> Result<Self, Fault> {
        if !Term::stderr().is_term() {
            return Err(Fault::input("--show: standard error is not a terminal; --preview writes to a file"));
        }
        Ok(Self { look, lines: 0 })
    }
}

impl Sink for Terminal {
    fn display(&self) -> Option<Display> {
        // The background is black.
        self.look.display().map(|display| Display { transparent: false, ..display })
    }

    fn show(&mut self, film: &Film) -> Result<Option<String>, String> {
        let stops = self.look.exposure.stops(&exposure::measured(&film.beauty(), &film.alpha()));
        let display = Display { exposure: stops, tone_map: self.look.tonemap.into(), transparent: false };
        self.show_image(&film.display(&display))
    }

    fn show_image(&mut self, image: &DisplayImage) -> Result<Option<String>, String> {
        let (rows, columns) = Term::stderr().size();
        let limit = (usize::from(columns).max(1), usize::from(rows).saturating_sub(FREE_LINES).max(1));
        let lines = half_blocks(image, limit);
        // Up to the first line of the last picture.
        let up = if self.lines > 0 { format!("\x1b[{}A\r", self.lines) } else { String::new() };
        self.lines = lines.len();
        Ok(Some(up + &lines.join("\n")))
    }
}

/// Lines of upper half blocks, each with two pixels, of at most `limit` columns and lines. Each pixel is the mean of the
/// light that its part of the picture shows.
fn half_blocks(picture: &DisplayImage, (columns, lines): (usize, usize)) -> Vec<String> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let scale = (columns as f64 / width as f64).min(2.0 * lines as f64 / height as f64).min(1.0);
    let scaled = |size: usize| ((size as f64 * scale).round() as usize).max(1);
    let (wide, high) = (scaled(width).min(columns), scaled(height).min(2 * lines));
    let linear: [f32; 256] = std::array::from_fn(|byte| decode_srgb(byte as f32 / 255.0));
    let pixel = |x: usize, y: usize| {
        let (x0, x1) = (x * width / wide, ((x + 1) * width / wide).max(x * width / wide + 1));
        let (y0, y1) = (y * height / high, ((y + 1) * height / high).max(y * height / high + 1));
        let mut sum = [0.0f32; 3];
        for row in y0..y1 {
            for value in &picture.pixels[row * width + x0..row * width + x1] {
                (0..3).for_each(|c| sum[c] += linear[usize::from(value[c])]);
            }
        }
        sum.map(|sum| encode_srgb(sum / ((x1 - x0) * (y1 - y0)) as f32))
    };
    let line = |row: usize| {
        let mut line = String::new();
        for x in 0..wide {
            let [r, g, b] = pixel(x, 2 * row);
            // Writing to a string does not fail.
            let _ = write!(line, "\x1b[38;2;{r};{g};{b}m");
            let _ = match (2 * row + 1 < high).then(|| pixel(x, 2 * row + 1)) {
                Some([r, g, b]) => write!(line, "\x1b[48;2;{r};{g};{b}m▀"),
                None => write!(line, "\x1b[49m▀"),
            };
        }
        line + "\x1b[0m\x1b[K"
    };
    (0..high.div_ceil(2)).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(width: u32, height: u32, colours: Vec<[u8; 3]>, limit: (usize, usize)) -> Vec<String> {
        let pixels = colours.into_iter().map(|[r, g, b]| [r, g, b, 255]).collect();
        half_blocks(&DisplayImage::new(width, height, 1, pixels).unwrap(), limit)
    }

    #[test]
    fn a_character_has_the_pixels_above_each_other() {
        let found = lines(1, 3, vec![[1, 2, 3], [4, 5, 6], [7, 8, 9]], (80, 24));
        assert_eq!(found, ["\x1b[38;2;1;2;3m\x1b[48;2;4;5;6m▀\x1b[0m\x1b[K", "\x1b[38;2;7;8;9m\x1b[49m▀\x1b[0m\x1b[K"]);
    }

    #[test]
    fn a_large_picture_fits_and_is_averaged() {
        // A white column, a black one and two grey ones. Half of white's light is 188.
        let row = [[255; 3], [0; 3], [90; 3], [90; 3]];
        let found = lines(4, 4, [row; 4].concat(), (2, 10));
        let [both, grey] = [188, 90].map(|c| format!("\x1b[38;2;{c};{c};{c}m\x1b[48;2;{c};{c};{c}m▀"));
        assert_eq!(found, [both + &grey + "\x1b[0m\x1b[K"]);
        for (size, limit) in [((1000, 7), (80, 24)), ((7, 1000), (80, 24)), ((3, 5), (1, 1))] {
            let found = lines(size.0, size.1, vec![[0; 3]; (size.0 * size.1) as usize], limit);
            let wide = found.iter().map(|line| line.matches('▀').count()).max().unwrap();
            assert!((1..=limit.1).contains(&found.len()) && (1..=limit.0).contains(&wide), "{size:?}: {wide}");
        }
    }
}
