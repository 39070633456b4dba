//! The channels that give colours: red, green and blue, or luminance with or without chroma.

use exr::meta::attribute::{Chromaticities, Text};
use exr::meta::header::Header;
use glam::{DMat3, DVec3};

use super::{ImageError, coarse};

const RGB: &[&str] = &["R", "G", "B"];
const CHROMA: &[&str] = &["Y", "RY", "BY"];
const GREY: &[&str] = &["Y"];

/// Luminances of the primaries of Rec. 709, which are those of files that name none.
const REC_709: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Values with 16 bits are rounded by 2⁻¹¹: what is that little below 0 after a conversion is 0.
const ROUNDING: f64 = 1.0 / 2048.0;

/// Channels of a layer.
pub(super) struct Source<'a> {
    pub(super) header: &'a Header,
    /// The names of three channels, or of a luminance.
    pub(super) names: Vec<Text>,
    pub(super) alpha: Option<Text>,
    /// Whether the three are luminance and chroma.
    pub(super) is_chroma: bool,
    /// Whether the file has other layers of colours, too.
    pub(super) has_others: bool,
}

/// Finds the colours of a file: those of the picture itself; else those of its only layer with colours, or of the only one
/// that is named `Combined`, as Blender names what it shows.
pub(super) fn find(headers: &[Header]) -> Result<Source<'_>, ImageError> {
    let plain = [RGB, CHROMA, GREY].into_iter().flat_map(|names| headers.iter().map(move |header| (header, names)));
    let plain = plain.filter_map(|(header, names)| Source::of(header, "", names)).next();
    let mut layers: Vec<(String, Source<'_>)> = Vec::new();
    for header in headers {
        for channel in &header.channels.list {
            let name = channel.name.to_string();
            let Some((layer, _)) = name.rsplit_once('.') else { continue };
            if !layers.iter().any(|(known, source)| known == layer && std::ptr::eq(source.header, header)) {
                layers.extend(Source::of(header, &format!("{layer}."), RGB).map(|source| (layer.to_owned(), source)));
            }
        }
    }
    if let Some(source) = plain {
        let is_other = |header: &Header| !std::ptr::eq(header, source.header) && Source::of(header, "", RGB).is_some();
        let has_others = !layers.is_empty() || headers.iter().any(is_other);
        return Source { has_others, ..source }.checked();
    }
    let has_others = layers.len() > 1;
    let is_combined = |name: &str| name.rsplit('.').next().is_some_and(|last| last.eq_ignore_ascii_case("combined"));
    if layers.iter().filter(|(name, _)| is_combined(name)).count() == 1 {
        layers.retain(|(name, _)| is_combined(name));
    }
    match layers.len() {
        0 => Err(ImageError::new("is an OpenEXR file without the channels R, G and B, or Y")),
        1 => Source { has_others, ..layers.swap_remove(0).1 }.checked(),
        _ => {
            let names: Vec<&str> = layers.iter().map(|(name, _)| name.as_str()).collect();
            let names = names.join(", ");
            Err(ImageError::new(format!(
                "is an OpenEXR file with several layers of colours: {names}; save one of them"
            )))
        }
    }
}

impl<'a> Source<'a> {
    /// The channels of these names, whose letters may be small.
    fn of(header: &'a Header, prefix: &str, names: &[&str]) -> Option<Self> {
        let channel = |name: &str| {
            let name = format!("{prefix}{name}");
            let all = || header.channels.list.iter().map(|channel| &channel.name);
            all()
                .find(|known| **known == *name)
                .or_else(|| all().find(|known| known.eq_case_insensitive(&name)))
                .cloned()
        };
        let found = names.iter().map(|name| channel(name)).collect::<Option<Vec<Text>>>()?;
        Some(Self { header, names: found, alpha: channel("A"), is_chroma: names == CHROMA, has_others: false })
    }

    /// Refuses what would be taken for grey, and samples that are not read.
    fn checked(self) -> Result<Self, ImageError> {
        let has =
            |wanted: &str| self.header.channels.list.iter().any(|channel| channel.name.eq_case_insensitive(wanted));
        if self.names.len() == 1 && has("X") && has("Z") {
            return Err(ImageError::new("is an OpenEXR file of CIE X, Y and Z; save it with R, G and B"));
        }
        coarse::check(self.header)?;
        Ok(self)
    }
}

/// Converts luminance Y and chroma (R − Y)/Y and (B − Y)/Y to colours ("Technical Introduction to OpenEXR",
/// Luminance/Chroma Images).
pub(super) fn from_chroma(texels: &mut [[f32; 4]], primaries: Option<Chromaticities>) {
    let [red, green, blue] = primaries.and_then(luminances).unwrap_or(REC_709);
    for texel in texels {
        let [y, ry, by] = [texel[0], texel[1], texel[2]].map(f64::from);
        let (r, b) = ((ry + 1.0) * y, (by + 1.0) * y);
        let g = (y - red * r - blue * b) / green;
        let settled = [r, g, b].map(|c| if (-4.0 * ROUNDING * y..0.0).contains(&c) { 0.0 } else { c });
        [texel[0], texel[1], texel[2]] = settled.map(|c| c as f32);
    }
}

/// The remark on a picture with these primaries, if they are not those of Rec. 709.
pub(super) fn remark(primaries: Option<Chromaticities>) -> Option<String> {
    let primaries = primaries?;
    let pairs = [primaries.red, primaries.green, primaries.blue, primaries.white].map(|at| [at.x(), at.y()]);
    super::super::primaries_remark(pairs.as_flattened())
}

/// Luminances of primaries whose sum is their white, of luminance 1; `None` for primaries that have none.
fn luminances(Chromaticities { red, green, blue, white }: Chromaticities) -> Option<[f64; 3]> {
    let xyz = |at: exr::math::Vec2<f32>| {
        let (x, y) = (f64::from(at.x()), f64::from(at.y()));
        DVec3::new(x, y, 1.0 - x - y)
    };
    let columns = DMat3::from_cols(xyz(red), xyz(green), xyz(blue));
    let white = xyz(white);
    let shares = columns.inverse() * (white / white.y);
    let luminances = shares * DVec3::new(columns.x_axis.y, columns.y_axis.y, columns.z_axis.y);
    (columns.determinant() != 0.0 && luminances.is_finite() && luminances.y > 0.0).then(|| luminances.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::math::Vec2;

    /// Rec. 709 by its definition, and two primaries of ACEScg.
    #[test]
    fn luminances_follow_from_primaries() {
        let rec_709 = Chromaticities {
            red: Vec2(0.64, 0.33),
            green: Vec2(0.30, 0.60),
            blue: Vec2(0.15, 0.06),
            white: Vec2(0.3127, 0.3290),
        };
        assert_eq!([remark(None), remark(Some(rec_709))], [None, None]);
        let other = remark(Some(Chromaticities { red: Vec2(0.713, 0.293), green: Vec2(0.165, 0.83), ..rec_709 }));
        assert!(other.is_some_and(|text| text.contains("primaries of its own, [0.713, 0.293, 0.165, 0.83,")));
        let found = luminances(rec_709).unwrap();
        assert!(found.iter().zip(REC_709).all(|(found, known)| (found - known).abs() < 1e-4), "{found:?}");
        assert_eq!(luminances(Chromaticities { green: rec_709.red, ..rec_709 }), None);
    }
}
