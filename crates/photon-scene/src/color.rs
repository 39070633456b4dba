//! Encoding of colours.

/// Decodes sRGB in `[0, 1]` (IEC 61966-2-1).
pub(crate) fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}
