//! Texture lookup: texture coordinates to texels, with wrap modes and filters.
//!
//! Backends give the same values to the bit: texels of 8 bits are read from tables, and weights are computed with
//! additions and multiplications alone.

use crate::scene::texture::{Filter, TexelFormat, Texture, TextureUse, Wrap};
use crate::shading::math::floor;

/// The values of the bytes of a texel: linear, and decoded from sRGB. See [`byte_values`].
pub type ByteValues = [[f32; 256]; 2];

/// The tables that [`lookup`] decodes bytes with: `value / 255`, and its decoding from sRGB (IEC 61966-2-1).
#[must_use]
pub fn byte_values() -> ByteValues {
    let value = |byte: usize| byte as f64 / 255.0;
    let linear = std::array::from_fn(|byte| value(byte) as f32);
    [linear, std::array::from_fn(|byte| srgb_to_linear(value(byte)) as f32)]
}

/// Decodes sRGB in `[0, 1]` (IEC 61966-2-1).
#[must_use]
pub fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// The coordinates of `used` on its texture, from those of its UV set. Not finite if they overflow.
#[inline]
#[must_use]
pub fn transform(used: &TextureUse, [u, v]: [f32; 2]) -> [f32; 2] {
    used.transform.map(|[a, b, c]| a * u + b * v + c)
}

/// The texture at `uv`: red, green, blue and alpha. Coordinates that are not finite count as 0.
#[inline]
#[must_use]
pub fn lookup(texture: &Texture, values: &ByteValues, uv: [f32; 2]) -> [f32; 4] {
    let (left, right, across) = axis(uv[0], texture.width, texture.wrap[0], texture.filter);
    let (upper, lower, down) = axis(uv[1], texture.height, texture.wrap[1], texture.filter);
    let places = [left, right, upper, lower];
    let shares = [across, down];
    let texels = &*texture.texels;
    let bytes = |colors: &[f32; 256], index: usize| {
        let [r, g, b, a] = texels[index].to_le_bytes().map(usize::from);
        [colors[r], colors[g], colors[b], values[0][a]]
    };
    // The format is looked at once, not for each texel.
    match texture.format {
        TexelFormat::Linear8 => bilinear(texture.width, places, shares, |index| bytes(&values[0], index)),
        TexelFormat::Srgb8 => bilinear(texture.width, places, shares, |index| bytes(&values[1], index)),
        TexelFormat::Float32 => bilinear(texture.width, places, shares, |index| {
            std::array::from_fn(|c| f32::from_bits(texels[4 * index + c]))
        }),
    }
}

/// The mean of four texels by their weights; `texel` has them by index.
#[inline(always)]
fn bilinear(
    width: u32,
    [left, right, upper, lower]: [u32; 4],
    [across, down]: [f32; 2],
    texel: impl Fn(usize) -> [f32; 4],
) -> [f32; 4] {
    let row = |y: u32| {
        let start = y as usize * width as usize;
        let from = texel(start + left as usize);
        if across == 0.0 { from } else { mix(from, texel(start + right as usize), across) }
    };
    let first = row(upper);
    if down == 0.0 { first } else { mix(first, row(lower), down) }
}

/// The two texels of `size` on either side of a coordinate, and the weight of the second, in `[0, 1)`; one texel and 0
/// for [`Filter::Nearest`].
#[inline]
#[must_use]
pub fn axis(coordinate: f32, size: u32, wrap: Wrap, filter: Filter) -> (u32, u32, f32) {
    let t = if coordinate.is_finite() { coordinate } else { 0.0 };
    let inside = match wrap {
        Wrap::Repeat => t - floor(t),
        Wrap::Mirror => {
            let twice = t - 2.0 * floor(0.5 * t);
            if twice > 1.0 { 2.0 - twice } else { twice }
        }
        Wrap::Clamp => t.clamp(0.0, 1.0),
    };
    let last = size - 1;
    let place = inside * size as f32;
    if filter == Filter::Nearest {
        let texel = (place as u32).min(last);
        return (texel, texel, 0.0);
    }
    let from_centre = place - 0.5;
    let below = floor(from_centre);
    let repeats = wrap == Wrap::Repeat;
    let first = if below < 0.0 { if repeats { last } else { 0 } } else { (below as u32).min(last) };
    let second = (below + 1.0) as u32;
    let second = match second > last {
        true if repeats => 0,
        true => last,
        false => second,
    };
    (first, second, from_centre - below)
}

#[inline]
fn mix(from: [f32; 4], to: [f32; 4], share: f32) -> [f32; 4] {
    std::array::from_fn(|c| from[c] * (1.0 - share) + to[c] * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(texels: &[u32], width: u32, wrap: Wrap, filter: Filter) -> Texture {
        let height = texels.len() as u32 / width;
        Texture { texels: texels.into(), width, height, format: TexelFormat::Linear8, wrap: [wrap; 2], filter }
    }

    fn red(texture: &Texture, uv: [f32; 2]) -> f32 {
        lookup(texture, &byte_values(), uv)[0]
    }

    /// G8: texel centres give texels, points between them the mean, whatever lies beyond the edge.
    #[test]
    fn centres_are_texels_and_middles_are_means() {
        let texels = [0, 51, 102, 255];
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let row = grey(&texels, 4, wrap, Filter::Linear);
            for (i, &texel) in texels.iter().enumerate() {
                assert!((red(&row, [(i as f32 + 0.5) / 4.0, 0.7]) - texel as f32 / 255.0).abs() < 1e-7);
            }
            assert!((red(&row, [0.25, 0.0]) - 0.1).abs() < 1e-7);
        }
        let edge = |wrap, u| red(&grey(&texels, 4, wrap, Filter::Linear), [u, 0.5]);
        assert_eq!(edge(Wrap::Repeat, 0.0), 0.5);
        assert_eq!((edge(Wrap::Mirror, 0.0), edge(Wrap::Mirror, 1.0)), (0.0, 1.0));
        assert_eq!((edge(Wrap::Clamp, -3.0), edge(Wrap::Clamp, 7.0)), (0.0, 1.0));
    }

    #[test]
    fn wraps_go_on_beyond_the_edges() {
        let texels = [0, 51, 102, 255];
        let at = |wrap, u| red(&grey(&texels, 4, wrap, Filter::Nearest), [u, 0.0]);
        for whole in [-3.0, -1.0, 0.0, 1.0, 5.0_f32] {
            for (i, &texel) in texels.iter().enumerate() {
                let u = whole + (i as f32 + 0.5) / 4.0;
                let mirrored = if whole.rem_euclid(2.0) == 1.0 { texels[3 - i] } else { texel };
                assert_eq!(at(Wrap::Repeat, u), texel as f32 / 255.0, "{u}");
                assert_eq!(at(Wrap::Mirror, u), mirrored as f32 / 255.0, "{u}");
            }
        }
    }

    /// V8 and V10: one texel, and coordinates of any size.
    #[test]
    fn any_coordinate_gives_a_texel() {
        let texels: Vec<u32> = (0..35).map(|i| i * 7).collect();
        for u in [0.0, -0.0, 1.0, -1e-9, 1e-30, 1e6, -1e30, f32::MAX, f32::NAN, f32::INFINITY, 0.999_999_94] {
            for filter in [Filter::Linear, Filter::Nearest] {
                for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                    let found = red(&grey(&texels, 7, wrap, filter), [u, -u]);
                    assert!((0.0..=1.0).contains(&found), "{u} {wrap:?}");
                    assert!((red(&grey(&[51], 1, wrap, filter), [u, u]) - 0.2).abs() < 1e-7);
                }
            }
        }
    }

    /// G8: half of sRGB.
    #[test]
    fn srgb_is_decoded_and_alpha_is_not() {
        assert!((srgb_to_linear(0.5) - 0.214_041_1).abs() < 1e-7);
        let texels = [0x8040_80FF];
        let texture = Texture { format: TexelFormat::Srgb8, ..grey(&texels, 1, Wrap::Clamp, Filter::Linear) };
        let [r, g, b, a] = lookup(&texture, &byte_values(), [0.3, 0.3]);
        assert_eq!((r, a), (1.0, 128.0 / 255.0));
        assert!((f64::from(g) - srgb_to_linear(128.0 / 255.0)).abs() < 1e-7);
        assert!((f64::from(b) - srgb_to_linear(64.0 / 255.0)).abs() < 1e-7);
    }

    #[test]
    fn floats_keep_their_values() {
        let texels = [1e20_f32, 0.0, 1e-30, 1.0, 3.0, 2.0, 0.5, 0.25].map(f32::to_bits);
        let texture =
            Texture { format: TexelFormat::Float32, width: 2, ..grey(&texels, 8, Wrap::Clamp, Filter::Nearest) };
        assert_eq!(lookup(&texture, &byte_values(), [0.1, 0.5]), [1e20, 0.0, 1e-30, 1.0]);
        assert_eq!(lookup(&texture, &byte_values(), [0.9, 0.5]), [3.0, 2.0, 0.5, 0.25]);
    }
}
