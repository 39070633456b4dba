//! Truncated, changed and oversized images: an error, and no memory for what is not there.

use super::{exr, png, refused};
use crate::load::image::Image;

fn all() -> Vec<(&'static str, Vec<u8>)> {
    let data: Vec<u8> = (0..64 * 3).collect();
    let mut lossless = Vec::new();
    image_webp::WebPEncoder::new(&mut lossless).encode(&data, 8, 8, image_webp::ColorType::Rgb8).unwrap();
    let ramp: Vec<f32> = (0..16).map(|x| x as f32).collect();
    let hdr = b"#?RADIANCE\n\n-Y 2 +X 8\n\x02\x02\0\x08\x88\x80\x88\x40\x88\0\x08\x81\x81\x81\x81\x81\x81\x81\x81";
    vec![
        ("png", png(png::ColorType::Rgb, png::BitDepth::Eight, [8, 8], &data)),
        ("jpeg", include_bytes!("baseline.jpg").to_vec()),
        ("progressive jpeg", include_bytes!("progressive.jpg").to_vec()),
        ("webp", include_bytes!("lossy.webp").to_vec()),
        ("webp with alpha", include_bytes!("alpha.webp").to_vec()),
        ("lossless webp", lossless),
        ("exr", exr(&[("R", &ramp), ("G", &ramp), ("B", &ramp)])),
        ("exr with coarse chroma, zip", include_bytes!("coarse/zip.exr").to_vec()),
        ("exr with coarse chroma, piz", include_bytes!("coarse/piz_a.exr").to_vec()),
        ("hdr", [&hdr[..], &hdr[hdr.len() - 19..]].concat()),
    ]
}

#[test]
fn cut_images_are_refused_or_whole() {
    for (name, whole) in all() {
        let image = Image::decode(&whole).unwrap_or_else(|why| panic!("{name}: {why}"));
        let mut refusals = 0;
        for length in 0..whole.len() {
            match Image::decode(&whole[..length]) {
                Err(_) => refusals += 1,
                // What is missing at the end says nothing about texels.
                Ok(found) => assert_eq!((found.width, found.height), (image.width, image.height), "{name} {length}"),
            }
        }
        assert!(refusals > whole.len() / 2, "{name}: {refusals} of {}", whole.len());
    }
}

#[test]
fn no_changed_byte_brings_a_decoder_down() {
    for (name, whole) in all() {
        let mut survivors = 0;
        for place in 0..whole.len() {
            for flip in [0x01, 0x10, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[place] ^= flip;
                if let Ok(image) = Image::decode(&damaged) {
                    let words = if image.is_float { 4 } else { 1 };
                    assert_eq!(image.texels.len(), image.width as usize * image.height as usize * words, "{name}");
                    survivors += 1;
                }
            }
        }
        assert!(survivors < 4 * whole.len(), "{name}: {survivors}");
    }
}

/// V8: sizes of 0, and headers that promise more than any memory.
#[test]
fn sizes_are_checked_in_the_header() {
    let mut bytes = png(png::ColorType::Grayscale, png::BitDepth::Eight, [1, 1], &[0]);
    for (width, height) in [(65_537_u32, 1_u32), (65_535, 65_535), (0x7FFF_FFFF, 0x7FFF_FFFF), (0, 1)] {
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let why = refused(&bytes);
        let reasons = ["texels", "dimensions", "limits are exceeded"];
        assert!(reasons.iter().any(|reason| why.contains(reason)), "{width}: {why}");
    }
    // A size within the limit, of which there is no data: the memory is not taken either.
    bytes[16..24].copy_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0]);
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    assert!(refused(&bytes).contains("PNG"));
    for resolution in ["-Y 65536 +X 65536", "-Y 0 +X 1", "-Y 1 +X 99999999999", "-Y 8193 +X 8193"] {
        let why = refused(format!("#?RADIANCE\n\n{resolution}\n").as_bytes());
        assert!(why.contains("texels") || why.contains("resolution"), "{why}");
    }
    // The size of a JPEG is in 16 bits: 65535 × 65535 is beyond 1 GiB.
    let mut jpeg = include_bytes!("baseline.jpg").to_vec();
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff; 4]);
    assert!(refused(&jpeg).contains("65535 × 65535 texels"));
    // 4095 × 4095 is within it, but not of 292 bytes.
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x0f, 0xff, 0x0f, 0xff]);
    assert!(refused(&jpeg).contains("more than its 292 bytes can hold"));
    let mut file = exr(&[("Y", &[1.0])]);
    let windows: Vec<usize> =
        file.windows(6).enumerate().filter(|(_, text)| text == b"box2i\0").map(|(at, _)| at).collect();
    for at in windows {
        // The type, four bytes of length, and the lower corner come before the upper one.
        file[at + 18..at + 26].copy_from_slice(&[0xff, 0x0f, 0, 0, 0xff, 0x0f, 0, 0]);
    }
    assert!(refused(&file).contains("bytes can hold"), "{}", refused(&file));
}

/// The checksum of PNG chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

/// V8: 1 × 1, and one row as long as is allowed.
#[test]
fn extreme_shapes_are_read() {
    for size in [[1, 1], [1, 16_384], [65_536, 1]] {
        let bytes = png(png::ColorType::Grayscale, png::BitDepth::Eight, size, &vec![9; (size[0] * size[1]) as usize]);
        let image = Image::decode(&bytes).unwrap();
        assert_eq!([image.width, image.height], size);
    }
}
