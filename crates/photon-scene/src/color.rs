//! Encoding of colours.

/// Decodes sRGB in `[0, 1]` (IEC 61966-2-1).
pub(crate) fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// Encodes in `[0, 1]` as sRGB, the inverse of [`srgb_to_linear`].
#[cfg(feature = "files")]
pub(crate) fn linear_to_srgb(value: f64) -> f64 {
    if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 }
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;

    #[test]
    fn the_curves_are_inverse() {
        assert!((srgb_to_linear(0.5) - 0.214_041_14).abs() < 1e-8);
        for byte in 0..=255 {
            let value = f64::from(byte) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(value)) - value).abs() < 1e-6, "{byte}");
        }
    }
}
