//! Conversion of radiance to 8-bit sRGB: exposure, tone curve, sRGB. Twin of `tone_map.glsl`.

/// Tone curve that maps radiance to `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
// Backends compile a kernel for each.
#[repr(u32)]
pub enum ToneMap {
    /// Clamp at 1.
    None = 0,
    /// `x / (1 + x)` on luminance (Reinhard et al. 2002, equation 3).
    Reinhard = 1,
    /// A rational fit of a film-like curve (Narkowicz 2016), channel by channel.
    Aces = 2,
    /// Linear up to 0.8, then a shoulder on the brightest channel that preserves hue and desaturates towards
    /// white (after Khronos' PBR Neutral, 2024).
    #[default]
    Neutral = 3,
    /// A logarithmic curve over 16.5 stops on mixed channels (after Sobotka's AgX, 2022).
    Agx = 4,
}

impl ToneMap {
    /// All curves.
    pub const ALL: [Self; 5] = [Self::None, Self::Reinhard, Self::Aces, Self::Neutral, Self::Agx];

    /// Maps one colour, linear RGB, to `[0, 1]`, still linear. `exposure` is in stops: a factor of a power of two.
    /// NaN becomes 0.
    #[must_use]
    pub fn map(self, exposure: f32, colour: [f32; 3]) -> [f32; 3] {
        let scale = exposure.exp2();
        // Of a scale beyond f32 and 0, or the other way round, the product is NaN too.
        let exposed = colour.map(|c| c * scale);
        let [r, g, b] = exposed.map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1e30) });
        let mapped = match self {
            Self::None => [r, g, b],
            Self::Reinhard => {
                let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
                [r, g, b].map(|c| c / (1.0 + luminance))
            }
            Self::Aces => [r, g, b].map(|c| {
                let c = c.min(1e6);
                c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
            }),
            Self::Neutral => neutral([r, g, b]),
            Self::Agx => agx([r, g, b]),
        };
        mapped.map(|c| c.clamp(0.0, 1.0))
    }
}

fn neutral(colour: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.76;
    const PALE: f32 = 0.15;
    let low = colour.into_iter().fold(f32::INFINITY, f32::min);
    // The Fresnel reflection of a dielectric, 4 %, is subtracted, smoothly near black.
    let foot = if low < 0.08 { low - 6.25 * low * low } else { 0.04 };
    let colour = colour.map(|c| c - foot);
    let peak = colour.into_iter().fold(0.0, f32::max);
    if peak < START {
        return colour;
    }
    let rest = 1.0 - START;
    let new = 1.0 - rest * rest / (peak + rest - START);
    let white = 1.0 - 1.0 / (PALE * (peak - new) + 1.0);
    colour.map(|c| c * (new / peak) * (1.0 - white) + new * white)
}

fn agx(colour: [f32; 3]) -> [f32; 3] {
    // Rows sum to 1, so that grey stays grey: each channel is mixed with the others, and unmixed
    // after the curve.
    const MIX: [[f32; 3]; 3] = [[0.8425, 0.0784, 0.0791], [0.0423, 0.8786, 0.0791], [0.0423, 0.0784, 0.8793]];
    const UNMIX: [[f32; 3]; 3] = [[1.1966, -0.0980, -0.0986], [-0.0529, 1.1515, -0.0986], [-0.0529, -0.0980, 1.1509]];
    const DARKEST: f32 = -12.473_93;
    const BRIGHTEST: f32 = 4.026_069;
    let apply = |rows: [[f32; 3]; 3], v: [f32; 3]| rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let encoded = apply(MIX, colour).map(|c| {
        let x = ((c.max(1e-10).log2() - DARKEST) / (BRIGHTEST - DARKEST)).clamp(0.0, 1.0);
        // A smooth S-curve through 0, middle grey and 1.
        let s = x * x * (3.0 - 2.0 * x);
        (0.35 * x + 0.65 * s).powf(1.25)
    });
    // The curve gives display values; the sRGB curve is applied later, hence its inverse here.
    apply(UNMIX, encoded).map(|c| decode_srgb(c.clamp(0.0, 1.0)))
}

/// The inverse of the sRGB curve, of a channel in `[0, 1]` (IEC 61966-2-1).
#[must_use]
pub fn decode_srgb(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB curve of a channel, quantized to eight bits (IEC 61966-2-1).
#[must_use]
pub fn encode_srgb(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_and_keep_grey_grey() {
        for curve in ToneMap::ALL {
            assert_eq!(curve.map(0.0, [0.0; 3]).map(encode_srgb), [0; 3], "{curve:?}");
            let mut before = -1.0;
            for step in 0..2000 {
                let x = (step as f32 * 0.01 - 10.0).exp2();
                let [r, g, b] = curve.map(0.0, [x; 3]);
                assert!((r - g).abs() < 2e-4 && (g - b).abs() < 2e-4, "{curve:?} {x}: {r} {g} {b}");
                assert!(r >= before - 1e-6 && (0.0..=1.0).contains(&r), "{curve:?} {x}: {r} after {before}");
                before = r;
            }
            assert!(before > 0.95, "{curve:?} ends at {before}");
        }
    }

    #[test]
    fn nonsense_gives_a_colour() {
        for curve in ToneMap::ALL {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, f32::MAX] {
                for c in [3.0, 200.0, -200.0].into_iter().flat_map(|stops| curve.map(stops, [bad, 0.5, 0.0])) {
                    assert!((0.0..=1.0).contains(&c), "{curve:?} {bad}: {c}");
                }
            }
        }
    }

    #[test]
    fn exposure_counts_in_stops() {
        assert_eq!(ToneMap::None.map(1.0, [0.25; 3]), [0.5; 3]);
        assert_eq!((encode_srgb(0.0), encode_srgb(1.0), encode_srgb(0.215_861)), (0, 255, 128));
    }
}
