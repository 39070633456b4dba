//! Radiance HDR: encodings, exposure and orientation.

use super::refused;
use crate::load::image::Image;

fn file(resolution: &str, body: &[u8]) -> Vec<u8> {
    let header = format!("#?RADIANCE\n# comment\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n");
    [header.as_bytes(), body].concat()
}

#[track_caller]
fn red(bytes: &[u8]) -> Vec<f32> {
    let image = Image::decode(bytes).unwrap_or_else(|why| panic!("{why}"));
    image.linear_rgb().iter().map(|color| color[0]).collect()
}

#[test]
fn mantissas_and_exponents_are_values() {
    // 128 · 2^(129 − 136) = 1; an exponent of 0 is black.
    let image = Image::decode(&file("-Y 1 +X 2", &[128, 64, 32, 129, 200, 200, 200, 0])).unwrap();
    assert_eq!(image.linear_rgb(), [[1.0, 0.5, 0.25], [0.0; 3]]);
    assert!(image.is_float && image.texels[3] == 1.0_f32.to_bits());
    let smallest = red(&file("-Y 1 +X 1", &[128, 0, 0, 1]));
    assert_eq!(smallest, [2.0_f32.powi(-128)]);
}

#[test]
fn old_runs_repeat_the_texel_before() {
    let one = [128, 0, 0, 129];
    let two = [128, 0, 0, 130];
    let body = [&one[..], &[1, 1, 1, 2], &two[..]].concat();
    assert_eq!(red(&file("-Y 1 +X 4", &body)), [1.0, 1.0, 1.0, 2.0]);
    // Counts in a row are digits to the base 256.
    let body = [&one[..], &[1, 1, 1, 1, 1, 1, 1, 1]].concat();
    assert_eq!(red(&file("-Y 1 +X 258", &body)).len(), 258);
    assert!(refused(&file("-Y 1 +X 4", &[&one[..], &[1, 1, 1, 4]].concat())).contains("damaged"));
    assert!(refused(&file("-Y 1 +X 4", &[1, 1, 1, 4])).contains("damaged"));
}

/// A scanline of 8 texels: red in runs, the others literal.
fn line(red: [u8; 2]) -> Vec<u8> {
    let literal = |value: u8| [&[8][..], &[value; 8]].concat();
    let runs = [128 + 3, red[0], 128 + 5, red[1]];
    [&[2, 2, 0, 8][..], &runs, &literal(0), &literal(0), &literal(129)].concat()
}

#[test]
fn new_runs_are_read_channel_by_channel() {
    assert_eq!(red(&file("-Y 1 +X 8", &line([128, 64]))), [1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 0.5]);
    let mut wrong = line([128, 64]);
    wrong[3] = 9;
    assert!(refused(&file("-Y 1 +X 8", &wrong)).contains("damaged"));
    let mut long = line([128, 64]);
    long[4] = 128 + 9;
    assert!(refused(&file("-Y 1 +X 8", &long)).contains("damaged"));
}

#[test]
fn every_orientation_of_rows_is_turned_upright() {
    let body = [line([128, 64]), line([64, 128])].concat();
    let (first, second) = ([1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 0.5], [0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
    let turned = |row: [f32; 8]| -> Vec<f32> { row.into_iter().rev().collect() };
    assert_eq!(red(&file("-Y 2 +X 8", &body)), [first, second].concat());
    assert_eq!(red(&file("+Y 2 +X 8", &body)), [second, first].concat());
    assert_eq!(red(&file("-Y 2 -X 8", &body)), [turned(first), turned(second)].concat());
    assert!(refused(&file("+X 8 -Y 2", &body)).contains("resolution"));
}

#[test]
fn exposures_are_undone_and_other_formats_refused() {
    let with = |line: &str| format!("#?RGBE\n{line}\n\n-Y 1 +X 1\n");
    let body = [128, 0, 0, 129];
    let bytes = |line: &str| [with(line).as_bytes(), &body].concat();
    assert_eq!(red(&bytes("EXPOSURE= 4.0\nEXPOSURE=0.5")), [0.5]);
    for bad in ["EXPOSURE=0", "EXPOSURE=nan", "EXPOSURE=-1", "EXPOSURE=x"] {
        assert!(refused(&bytes(bad)).contains("exposure"), "{bad}");
    }
    for bad in ["COLORCORR=1 1", "COLORCORR=1 1 1 1", "COLORCORR= 1 0 1"] {
        assert!(refused(&bytes(bad)).contains("colour correction"), "{bad}");
    }
    // Each channel, as often as the line occurs.
    let texel = [128, 64, 32, 129];
    let corrected = [with("COLORCORR= 2 1 0.5\nEXPOSURE=2\nCOLORCORR=1 4 1").as_bytes(), &texel].concat();
    assert_eq!(Image::decode(&corrected).unwrap().linear_rgb(), [[0.25, 0.0625, 0.25]]);
    for (primaries, is_said) in [
        ("0.64 0.33 0.29 0.6 0.15 0.06 0.333 0.333", false),
        ("0.7 0.29 0.17 0.79 0.13 0.04 0.3127 0.329", true),
        ("0.64", true),
    ] {
        let image = Image::decode(&bytes(&format!("PRIMARIES= {primaries}"))).unwrap();
        assert_eq!(!image.remarks.is_empty(), is_said, "{primaries}: {:?}", image.remarks);
    }
    // Names in the encodings of old systems.
    let latin = [&b"#?RADIANCE\nVIEW= caf\xe9\n\n-Y 1 +X 1\n"[..], &body].concat();
    assert_eq!(red(&latin), [1.0]);
    assert!(refused(&bytes("FORMAT=32-bit_rle_xyze")).contains("xyze"));
}
