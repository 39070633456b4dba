//! Whole images of each format.

use photon_core::TexelFormat;

use super::{exr, png, refused};
use crate::load::image::Image;

fn decoded(bytes: &[u8]) -> Image {
    Image::decode(bytes).unwrap_or_else(|why| panic!("{why}"))
}

fn rgba(image: &Image) -> Vec<[u8; 4]> {
    assert!(!image.is_float);
    image.texels.iter().map(|word| word.to_le_bytes()).collect()
}

#[test]
fn png_of_every_kind_becomes_rgba() {
    use png::{BitDepth, ColorType};
    let of = |color, depth, data: &[u8]| rgba(&decoded(&png(color, depth, [2, 1], data)));
    let eight = BitDepth::Eight;
    assert_eq!(of(ColorType::Grayscale, eight, &[7, 200]), [[7, 7, 7, 255], [200, 200, 200, 255]]);
    assert_eq!(of(ColorType::GrayscaleAlpha, eight, &[7, 1, 9, 2]), [[7, 7, 7, 1], [9, 9, 9, 2]]);
    assert_eq!(of(ColorType::Rgb, eight, &[1, 2, 3, 4, 5, 6]), [[1, 2, 3, 255], [4, 5, 6, 255]]);
    assert_eq!(of(ColorType::Rgba, eight, &[1, 2, 3, 4, 5, 6, 7, 8]), [[1, 2, 3, 4], [5, 6, 7, 8]]);
    assert_eq!(of(ColorType::Grayscale, BitDepth::One, &[0b0100_0000]), [[0, 0, 0, 255], [255; 4]]);
}

#[test]
fn sixteen_bits_are_rounded() {
    // 0x8101 is 128.502 of 255, 0x8000 is 127.502, and 0x007F 0.494.
    let data = [0x81, 0x01, 0x80, 0x00, 0x00, 0x7F, 0xFF, 0xFF];
    let image = decoded(&png(png::ColorType::Rgba, png::BitDepth::Sixteen, [1, 1], &data));
    assert!(image.is_rounded);
    assert_eq!(rgba(&image), [[129, 128, 0, 255]]);
}

#[test]
fn palettes_and_transparent_colours_are_expanded() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 1);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
    encoder.set_trns(vec![9]);
    encoder.write_header().unwrap().write_image_data(&[1, 0, 1]).unwrap();
    assert_eq!(rgba(&decoded(&bytes)), [[4, 5, 6, 255], [1, 2, 3, 9], [4, 5, 6, 255]]);
}

/// Red on the left, blue on the right, 8 × 8 each.
#[track_caller]
fn red_and_blue(bytes: &[u8], right_alpha: u8) {
    let image = decoded(bytes);
    assert_eq!((image.width, image.height), (16, 8));
    for (index, [r, g, b, a]) in rgba(&image).into_iter().enumerate() {
        let (is_red, near_edge) = (index % 16 < 8, (6..10).contains(&(index % 16)));
        let (bright, dark, alpha) = if is_red { (r, b, 255) } else { (b, r, right_alpha) };
        assert!(near_edge || (bright > 240 && dark < 15 && g < 15), "{index}: {r} {g} {b}");
        assert_eq!(a, alpha, "{index}");
    }
}

#[test]
fn jpeg_is_read_baseline_progressive_and_grey() {
    red_and_blue(include_bytes!("baseline.jpg"), 255);
    red_and_blue(include_bytes!("progressive.jpg"), 255);
    let grey = decoded(include_bytes!("grey.jpg"));
    assert!(rgba(&grey).iter().all(|&[r, g, b, a]| r == g && g == b && r.abs_diff(127) <= 1 && a == 255));
    assert!(refused(include_bytes!("cmyk.jpg")).contains("CMYK"));
}

#[test]
fn webp_is_read_lossy_lossless_and_with_alpha() {
    red_and_blue(include_bytes!("lossy.webp"), 255);
    red_and_blue(include_bytes!("alpha.webp"), 127);
    let pixels = [[1_u8, 2, 3, 4], [5, 6, 7, 8]];
    let mut bytes = Vec::new();
    let encoder = image_webp::WebPEncoder::new(&mut bytes);
    encoder.encode(pixels.as_flattened(), 2, 1, image_webp::ColorType::Rgba8).unwrap();
    assert_eq!(rgba(&decoded(&bytes)), pixels);
}

#[test]
fn exr_is_read_with_or_without_alpha_and_grey() {
    let floats = |image: &Image| -> Vec<f32> { image.texels.iter().map(|&word| f32::from_bits(word)).collect() };
    let (r, g, b): (&[f32], &[f32], &[f32]) = (&[0.25, 1e20], &[0.5, 2.0], &[1.0, 1e-20]);
    let image = decoded(&exr(&[("R", r), ("G", g), ("B", b)]));
    assert!(image.is_float && image.repaired == 0);
    assert_eq!(floats(&image), [0.25, 0.5, 1.0, 1.0, 1e20, 2.0, 1e-20, 1.0]);
    assert_eq!(image.linear_rgb(), [[0.25, 0.5, 1.0], [1e20, 2.0, 1e-20]]);
    let image = decoded(&exr(&[("A", &[0.5, 0.0]), ("R", r), ("G", g), ("B", b), ("Z", r)]));
    assert_eq!(floats(&image)[3..5], [0.5, 1e20]);
    let image = decoded(&exr(&[("Y", r)]));
    assert_eq!(floats(&image), [0.25, 0.25, 0.25, 1.0, 1e20, 1e20, 1e20, 1.0]);
    assert!(refused(&exr(&[("Z", r)])).contains("channels"));
}

/// DWA is lossy: a smooth image comes back within a few percent. Damaged files are errors or other images, never panics.
#[test]
fn exr_by_dwa_is_read_and_may_be_damaged() {
    use exr::prelude::{Compression, Encoding, Image as Layers, SpecificChannels, WritableImage, f16};
    let value = |x: usize, y: usize| 1.0 + 0.02 * x as f32 + 0.01 * y as f32;
    for compression in [Compression::DWAA(None), Compression::DWAB(None)] {
        let pixel = |at: exr::math::Vec2<usize>| {
            let value = value(at.x(), at.y());
            (f16::from_f32(value), f16::from_f32(2.0 * value), f16::from_f32(0.5))
        };
        let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
        let layers = Layers::from_encoded_channels((64, 48), encoding, SpecificChannels::rgb(pixel));
        let mut bytes = std::io::Cursor::new(Vec::new());
        layers.write().non_parallel().to_buffered(&mut bytes).unwrap();
        let bytes = bytes.into_inner();
        let image = decoded(&bytes);
        for (i, color) in image.linear_rgb().iter().enumerate() {
            let truth = value(i % 64, i / 64);
            let close = |found: f32, truth: f32| (found / truth - 1.0).abs() < 0.05;
            assert!(close(color[0], truth) && close(color[1], 2.0 * truth) && close(color[2], 0.5), "{i} {color:?}");
        }
        let mut random = photon_core::random::SplitMix64(5);
        // Eight pixels do not shrink.
        let few = Layers::from_encoded_channels((2, 4), encoding, SpecificChannels::rgb(pixel));
        let mut small = std::io::Cursor::new(Vec::new());
        few.write().non_parallel().to_buffered(&mut small).unwrap();
        assert_eq!(decoded(&small.into_inner()).linear_rgb().len(), 8);
        let mut errors = 0;
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random.word() % 4 {
                let place = random.word() as usize % damaged.len();
                damaged[place] = random.word() as u8;
            }
            errors += usize::from(Image::decode(&damaged).is_err());
        }
        assert!(errors > 100, "{errors}");
    }
}

/// A damaged file of this compression made the decoder panic. Found by fuzzing.
#[test]
fn exr_by_b44_is_refused() {
    let mut bytes = exr(&[("Y", &[1.0, 2.0])]);
    let name = b"compression\0compression\0";
    let start = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    // The length, and the number of the method.
    assert_eq!(bytes[start..start + 4], [1, 0, 0, 0]);
    for method in [6, 7] {
        bytes[start + 4] = method;
        let why = refused(&bytes);
        assert!(why.contains("b44") && why.contains("ZIP or PIZ"), "{why}");
    }
}

/// V7: NaN and negative values become 0, infinities the largest number, each texel counted once.
#[test]
fn invalid_floats_are_replaced_and_counted() {
    let bad = [f32::NAN, -1.0, f32::INFINITY, f32::NEG_INFINITY, -0.0, 2.0];
    let image = decoded(&exr(&[("R", &bad), ("G", &bad), ("B", &[1.0; 6])]));
    assert_eq!(image.repaired, 4);
    let red: Vec<f32> = image.linear_rgb().iter().map(|color| color[0]).collect();
    assert_eq!(red, [0.0, 0.0, f32::MAX, 0.0, 0.0, 2.0]);
    assert_eq!(image.texels[16], 0, "a zero has no sign");
}

#[test]
fn other_formats_are_named() {
    for (bytes, name) in [
        (&b"\xabKTX 20\xbb\r\n\x1a\n"[..], "KTX2"),
        (b"DDS |", "DDS"),
        (b"GIF89a", "GIF"),
        (b"\0\0\0\x1cftypavif", "AVIF"),
        (b"BM6\0\0\0\0\0\0\0", "BMP"),
        (b"", "empty"),
        (b"junk, or rather text", "unknown format"),
    ] {
        assert!(refused(bytes).contains(name), "{name}");
    }
}

#[test]
fn bytes_are_encoded_as_their_purpose_says_and_floats_are_not() {
    let grey = png(png::ColorType::Grayscale, png::BitDepth::Eight, [1, 1], &[128]);
    let image = decoded(&grey);
    assert_eq!(image.texture("map", TexelFormat::Linear8).image.format, TexelFormat::Linear8);
    let [[value, _, _]] = image.linear_rgb()[..] else { panic!("one texel") };
    assert!((value - 0.215_860_5).abs() < 1e-6);
    let float = decoded(&exr(&[("R", &[1.0]), ("G", &[1.0]), ("B", &[1.0])]));
    assert_eq!(float.texture("sky", TexelFormat::Srgb8).image.format, TexelFormat::Float32);
}
