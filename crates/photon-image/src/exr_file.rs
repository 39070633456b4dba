//! OpenEXR output and input: linear, layered, with the render settings as attributes.

use std::path::Path;

use exr::prelude::*;
use photon_core::{ConfidenceInterval, Film, Layer as Part};

use crate::atomic_write;
use crate::fault::{Fault, check_kind, check_regular};

/// Writes one part of f32 channels: `R G B`, which is the sum of `emission.*`, `direct.*`,
/// `caustic.*` and `indirect.*`, then `depth.Z`, `N.*`, `albedo.*` and `error.Y`, the standard error
/// of the mean; if errors were asked for, `stderr.Y`, `bias.Y`, `claimed.Y` and `flag.Y` as in
/// [`ConfidenceInterval`]; with `alpha`, `A`, with which the colours are premultiplied as OpenEXR requires; and
/// `attributes`. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write(path: &Path, film: &Film, alpha: bool, attributes: &[(String, String)]) -> std::result::Result<(), Fault> {
    write_as(path, film, film.beauty(), alpha, attributes)
}

/// Writes a film like [`write()`], with another picture of as many pixels in `R G B`, for example a denoised one.
///
/// # Errors
/// Those of [`write()`].
pub fn write_as(
    path: &Path,
    film: &Film,
    picture: Vec<[f32; 3]>,
    alpha: bool,
    attributes: &[(String, String)],
) -> std::result::Result<(), Fault> {
    let mut channels: Vec<(String, Vec<f32>)> = Vec::new();
    let mut triple = |names: [String; 3], values: Vec<[f32; 3]>| {
        for (axis, name) in names.into_iter().enumerate() {
            channels.push((name, values.iter().map(|v| v[axis]).collect()));
        }
    };
    triple(["R", "G", "B"].map(str::to_owned), picture);
    for part in Part::ALL {
        triple(["R", "G", "B"].map(|c| format!("{}.{c}", part.name())), film.layer(part));
    }
    triple(["N.X", "N.Y", "N.Z"].map(str::to_owned), film.normal());
    triple(["albedo.R", "albedo.G", "albedo.B"].map(str::to_owned), film.albedo());
    if alpha {
        channels.push(("A".to_owned(), film.alpha()));
    }
    channels.push(("depth.Z".to_owned(), film.depth()));
    channels.push(("error.Y".to_owned(), film.standard_error()));
    if let Some(intervals) = film.confidence_intervals() {
        let mut details = |name: &str, of: fn(&ConfidenceInterval) -> f32| {
            channels.push((name.to_owned(), intervals.iter().map(of).collect()));
        };
        details("stderr.Y", |interval| interval.standard_error as f32);
        details("bias.Y", |interval| interval.bias as f32);
        details("claimed.Y", |interval| interval.half_width as f32);
        details("flag.Y", |interval| interval.flags.bits() as f32);
    }

    let size = (film.width as usize, film.height as usize);
    let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .into_iter()
        .map(|(name, samples)| AnyChannel::new(Text::new_or_panic(&name), FlatSamples::F32(samples)))
        .collect();
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::SMALL_LOSSLESS };
    let mut layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(list));
    layer.attributes.software_name = Text::new_or_none(concat!("photonmap ", env!("CARGO_PKG_VERSION")));
    for (name, value) in attributes {
        if let (Some(name), Some(value)) = (Text::new_or_none(name), Text::new_or_none(value)) {
            layer.attributes.other.insert(name, attribute::AttributeValue::Text(value));
        }
    }
    atomic_write::write(path, |file| Ok(Image::from_layer(layer).write().to_buffered(file)?))
}

/// A picture in linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Linear RGB, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// Writes the channels `R`, `G` and `B` in f32. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_picture(path: &Path, picture: &Picture) -> std::result::Result<(), Fault> {
    let of = |position: Vec2<usize>| {
        let [r, g, b] = picture.pixels[position.y() * picture.width + position.x()];
        (r, g, b)
    };
    let image = Image::from_encoded_channels(
        (picture.width, picture.height),
        Encoding { compression: Compression::ZIP16, ..Encoding::SMALL_LOSSLESS },
        SpecificChannels::rgb(of),
    );
    atomic_write::write(path, |file| Ok(image.write().to_buffered(file)?))
}

/// Reads the channels `R`, `G` and `B` of the first layer; other channels and layers are ignored.
///
/// # Errors
/// [`Fault::Input`], which names the file: it cannot be read, is not an OpenEXR file, or lacks one of the channels.
pub fn read(path: &Path) -> std::result::Result<Picture, Fault> {
    let wrong = |what: String| Fault::input(format!("{}: {what}", path.display()));
    check_regular(path)?;
    check_kind(path, "exr", "an OpenEXR picture (.exr)")?;
    let image = read_first_flat_layer_from_file(path)
        .map_err(|why| wrong(format!("cannot be read as an OpenEXR picture (.exr): {why}")))?;
    let layer = image.layer_data;
    let (width, height) = (layer.size.width(), layer.size.height());
    let channel = |name: &str| -> std::result::Result<Vec<f32>, Fault> {
        let found = layer.channel_data.list.iter().find(|channel| channel.name.eq_case_insensitive(name));
        let values: Option<Vec<f32>> = found.map(|channel| channel.sample_data.values_as_f32().collect());
        let values = values.ok_or_else(|| wrong(format!("has no channel {name}")))?;
        if values.len() == width * height { Ok(values) } else { Err(wrong(format!("channel {name} is subsampled"))) }
    };
    let (red, green, blue) = (channel("R")?, channel("G")?, channel("B")?);
    let pixels = (0..width * height).map(|at| [red[at], green[at], blue[at]]).collect();
    Ok(Picture { width, height, pixels })
}
