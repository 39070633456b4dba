//! Means of texels in linear light.

use std::sync::LazyLock;

use photon_core::TexelFormat;

use crate::color::{linear_to_srgb, srgb_to_linear};

/// Decodes and encodes texels.
pub(super) struct Channels {
    format: TexelFormat,
    /// Linear values of the bytes of a colour.
    values: [f64; 256],
    /// The same of alpha.
    alphas: [f64; 256],
    /// Whether colours count by their alpha.
    weighs: bool,
}

impl Channels {
    /// With `weighs`, the mean colour is that of what is there (alpha coverage): texels count by their alpha, so that hidden
    /// colours do not darken edges. Where nothing is there, all count the same.
    pub(super) fn new(format: TexelFormat, weighs: bool) -> Self {
        let curve = if format == TexelFormat::Srgb8 { srgb_to_linear } else { |value| value };
        let values = |curve: fn(f64) -> f64| std::array::from_fn(|byte| curve(byte as f64 / 255.0));
        Self { format, values: values(curve), alphas: values(|value| value), weighs }
    }

    /// The means of two rows, or of one row where the number is odd.
    pub(super) fn half_row(&self, above: &[u32], below: Option<&[u32]>, texels: &mut Vec<u32>) {
        let width = above.len() / self.format.words();
        for column in (0..width).step_by(2) {
            let (mut sum, mut weighed) = ([0.0; 4], [0.0; 3]);
            let mut count = 0.0;
            for row in [Some(above), below].into_iter().flatten() {
                for x in column..width.min(column + 2) {
                    let texel = self.read(row, x);
                    sum = std::array::from_fn(|channel| sum[channel] + texel[channel]);
                    weighed = std::array::from_fn(|channel| weighed[channel] + texel[3] * texel[channel]);
                    count += 1.0;
                }
            }
            let mut mean = sum.map(|part: f64| part / count);
            if self.weighs && sum[3] > 0.0 {
                mean = [weighed[0] / sum[3], weighed[1] / sum[3], weighed[2] / sum[3], mean[3]];
            }
            self.write(texels, mean);
        }
    }

    fn read(&self, texels: &[u32], index: usize) -> [f64; 4] {
        if self.format == TexelFormat::Float32 {
            return std::array::from_fn(|channel| f64::from(f32::from_bits(texels[4 * index + channel])));
        }
        let [r, g, b, a] = texels[index].to_le_bytes().map(usize::from);
        [self.values[r], self.values[g], self.values[b], self.alphas[a]]
    }

    fn write(&self, texels: &mut Vec<u32>, [r, g, b, a]: [f64; 4]) {
        match self.format {
            TexelFormat::Float32 => texels.extend([r, g, b, a].map(|part| (part as f32).to_bits())),
            TexelFormat::Srgb8 => {
                let [r, g, b] = [r, g, b].map(|part| CODES.nearest(part));
                texels.push(u32::from_le_bytes([r, g, b, byte(a)]));
            }
            _ => texels.push(u32::from_le_bytes([r, g, b, a].map(byte))),
        }
    }
}

fn byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}

/// The nearest sRGB code of each linear value in `[0, 1]`, without the power of each texel.
struct Codes {
    /// The least value of each code.
    least: [f64; 256],
    /// The code at the start of each interval of equal length.
    starts: [u8; INTERVALS + 1],
}

const INTERVALS: usize = 4096;

static CODES: LazyLock<Codes> = LazyLock::new(Codes::new);

impl Codes {
    fn new() -> Self {
        // Bisection over the bits, which are in the order of positive numbers.
        let least = |code: usize| {
            let (mut below, mut above) = (0.0_f64.to_bits(), 1.0_f64.to_bits());
            while below + 1 < above {
                let middle = below.midpoint(above);
                if usize::from(exact(f64::from_bits(middle))) < code { below = middle } else { above = middle }
            }
            f64::from_bits(above)
        };
        Self {
            least: std::array::from_fn(|code| if code == 0 { 0.0 } else { least(code) }),
            starts: std::array::from_fn(|at| exact(at as f64 / INTERVALS as f64)),
        }
    }

    fn nearest(&self, value: f64) -> u8 {
        let start = usize::from(self.starts[((value * INTERVALS as f64) as usize).min(INTERVALS)]);
        let more = self.least[start + 1..].iter().take_while(|least| value >= **least).count();
        (start + more) as u8
    }
}

/// By the definition.
fn exact(value: f64) -> u8 {
    byte(linear_to_srgb(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table has the codes of the definition: for means of two and four codes, and on both sides of each step.
    #[test]
    fn codes_are_those_of_the_definition() {
        let linear: [f64; 256] = std::array::from_fn(|code| srgb_to_linear(code as f64 / 255.0));
        for (code, value) in linear.iter().enumerate() {
            assert_eq!(usize::from(CODES.nearest(*value)), code);
            for (other, second) in linear.iter().enumerate() {
                let third = linear[(31 * code + 7 * other) % 256];
                for mean in [(value + second) / 2.0, (value + second + third + third) / 4.0] {
                    assert_eq!(CODES.nearest(mean), exact(mean), "{mean}");
                }
            }
        }
        for code in 1..=255_u8 {
            let step = CODES.least[usize::from(code)];
            assert_eq!([step.next_down(), step].map(|value| CODES.nearest(value)), [code - 1, code]);
            assert_eq!([step.next_down(), step].map(exact), [code - 1, code]);
        }
        assert_eq!([0.0, 1.0].map(|value| CODES.nearest(value)), [0, 255]);
    }
}
