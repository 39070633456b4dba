//! Tone curves by name, for pictures of eight bits.

/// Tone curve that maps radiance to `[0, 1]`: [`photon_core::ToneMap`] as an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum ToneMap {
    /// Clamp at 1.
    None,
    /// `x / (1 + x)` on luminance (Reinhard et al. 2002, equation 3).
    Reinhard,
    /// A rational fit of a film-like curve (Narkowicz 2016), channel by channel.
    Aces,
    /// Linear up to 0.8, then a shoulder on the brightest channel that preserves hue and desaturates towards
    /// white (after Khronos' PBR Neutral, 2024).
    Neutral,
    /// A logarithmic curve over 16.5 stops on mixed channels (after Sobotka's AgX, 2022).
    Agx,
}

impl From<ToneMap> for photon_core::ToneMap {
    fn from(option: ToneMap) -> Self {
        match option {
            ToneMap::None => Self::None,
            ToneMap::Reinhard => Self::Reinhard,
            ToneMap::Aces => Self::Aces,
            ToneMap::Neutral => Self::Neutral,
            ToneMap::Agx => Self::Agx,
        }
    }
}

/// Maps one colour to `[0, 1]`, still linear; see [`photon_core::ToneMap::map`].
#[must_use]
pub fn map(curve: ToneMap, exposure: f32, colour: [f32; 3]) -> [f32; 3] {
    photon_core::ToneMap::from(curve).map(exposure, colour)
}

/// The sRGB curve, quantized to eight bits (IEC 61966-2-1).
#[must_use]
pub fn encode(linear: f32) -> u8 {
    photon_core::encode_srgb(linear)
}
