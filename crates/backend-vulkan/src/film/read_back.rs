//! Planes of the film on their way back to the host: copied to memory that the host sees, a range of pixels of all planes at
//! a time, and made into records there by all cores.

use photon_core::{Error, Result, parallel};

use crate::device::{Memory, READ_BACK};
use crate::vulkan::Vulkan;

/// The words of one pixel in several planes.
pub(super) struct PixelWords<'a> {
    /// The words of a range of pixels, plane after plane.
    words: &'a [u32],
    /// Length of the range.
    length: usize,
    pixel: usize,
}

impl PixelWords<'_> {
    /// The word of a plane.
    pub(super) fn word(&self, plane: usize) -> u32 {
        self.words[plane * self.length + self.pixel]
    }

    /// A sum of two floats: the high part in plane `plane`, the low part `low` planes further on.
    pub(super) fn sum(&self, plane: usize, low: usize) -> f64 {
        let float = |plane: usize| f64::from(f32::from_bits(self.word(plane)));
        float(plane) + float(plane + low)
    }
}

/// Reads planes of words, given as memory and plane index, and calls `unpack` for each of `pixels`.
pub(super) fn planes<T: Send>(
    on: &mut Vulkan,
    planes: &[(&Memory, usize)],
    pixels: &mut [T],
    unpack: impl Fn(&PixelWords<'_>, &mut T) + Sync,
) -> Result<()> {
    let all = pixels.len();
    let block = (READ_BACK as usize / (4 * planes.len().max(1))).min(all).max(1);
    let mut start = 0;
    for pixels in pixels.chunks_mut(block) {
        let length = pixels.len();
        let parts: Vec<_> = planes.iter().map(|&(memory, plane)| (memory, (plane * all + start) as u64 * 4)).collect();
        let mut fits = true;
        on.read_parts(&parts, length as u64 * 4, |bytes| {
            // Allocators place buffers at multiples of what the device asks for, which is at least 4.
            let Ok(words) = bytemuck::try_cast_slice(bytes) else {
                fits = false;
                return;
            };
            parallel::for_each_part(pixels, |first, pixels| {
                for (i, pixel) in pixels.iter_mut().enumerate() {
                    unpack(&PixelWords { words, length, pixel: first + i }, pixel);
                }
            });
        })?;
        if !fits {
            return Err(Error::Backend { backend: "vulkan", source: "memory for downloads is not aligned".into() });
        }
        start += length;
    }
    Ok(())
}
