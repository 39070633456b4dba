//! `OpenEXR`: windows, and the channels that give colours.

use super::{exr, exr_within, refused};
use crate::load::image::Image;

fn floats(bytes: &[u8]) -> Vec<[f32; 4]> {
    let image = Image::decode(bytes).unwrap_or_else(|why| panic!("{why}"));
    image.texels.chunks_exact(4).map(|texel| std::array::from_fn(|at| f32::from_bits(texel[at]))).collect()
}

/// A window of 2 × 2 texels of values 1 to 4: in one of 4 × 3, partly and wholly outside, and larger than what is shown.
#[test]
fn texels_are_where_the_data_window_says() {
    let values = [1.0, 2.0, 3.0, 4.0];
    let of = |at, shown| exr_within(&[("R", &values), ("G", &values), ("B", &values)], (at, (2, 2)), shown);
    type Window = ((i32, i32), (usize, usize));
    type Case<'a> = ((i32, i32), Window, &'a [f32], &'a [&'a str]);
    let cases: [Case<'_>; 6] = [
        ((0, 0), ((0, 0), (2, 2)), &[1.0, 2.0, 3.0, 4.0], &[]),
        ((7, -5), ((7, -5), (2, 2)), &[1.0, 2.0, 3.0, 4.0], &[]),
        ((1, 1), ((0, 0), (4, 3)), &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 3.0, 4.0, 0.0], &["is black"]),
        ((-1, 9), ((0, 10), (2, 2)), &[4.0, 0.0, 0.0, 0.0], &["is black", "is cut"]),
        ((-1, -1), ((0, 0), (1, 1)), &[4.0], &["is cut"]),
        ((-1, 0), ((-1, 0), (1, 2)), &[1.0, 3.0], &["is cut"]),
    ];
    for (at, shown, expected, remarks) in cases {
        let bytes = of(at, shown);
        let red: Vec<f32> = floats(&bytes).iter().map(|texel| texel[0]).collect();
        assert_eq!(red, expected, "{at:?} {shown:?}");
        assert!(floats(&bytes).iter().all(|texel| texel[3] == 1.0));
        let image = Image::decode(&bytes).unwrap();
        assert_eq!((image.width as usize, image.height as usize), shown.1);
        assert_eq!(image.remarks.len(), remarks.len(), "{:?}", image.remarks);
        assert!(image.remarks.iter().zip(remarks).all(|(found, part)| found.contains(part)), "{:?}", image.remarks);
    }
    for outside in [(2, 0), (0, -2), (i32::MAX / 4, 0)] {
        assert!(refused(&of(outside, ((0, 0), (2, 2)))).contains("do not overlap"), "{outside:?}");
    }
    // With alpha, nothing is there where there are no texels.
    let bytes = exr_within(&[("A", &[1.0]), ("Y", &[0.5])], ((1, 0), (1, 1)), ((0, 0), (2, 1)));
    assert_eq!(floats(&bytes), [[0.0; 4], [0.5, 0.5, 0.5, 1.0]]);
    // A few bytes do not take the memory of a large picture.
    let why = refused(&of((0, 0), ((0, 0), (8000, 8000))));
    assert!(why.contains("8000 × 8000 texels, more than its"), "{why}");
}

#[test]
fn channels_have_names_in_any_case_and_of_one_layer() {
    let (r, g, b, a): (&[f32], &[f32], &[f32], &[f32]) = (&[1.0], &[2.0], &[3.0], &[0.5]);
    let all = |names: [&'static str; 4]| [(names[0], r), (names[1], g), (names[2], b), (names[3], a)];
    for names in [
        ["r", "g", "b", "a"],
        ["R", "g", "B", "A"],
        ["ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Combined.A"],
        ["beauty.r", "beauty.g", "beauty.b", "beauty.a"],
    ] {
        assert_eq!(floats(&exr(&all(names))), [[1.0, 2.0, 3.0, 0.5]], "{names:?}");
    }
    let others = [("View.DiffCol.R", b), ("View.DiffCol.G", b), ("View.DiffCol.B", b)];
    let combined = [("View.Combined.R", r), ("View.Combined.G", g), ("View.Combined.B", b)];
    assert_eq!(floats(&exr(&[&others[..], &combined].concat())), [[1.0, 2.0, 3.0, 1.0]]);
    assert_eq!(floats(&exr(&[&others[..], &all(["r", "g", "b", "a"])].concat())), [[1.0, 2.0, 3.0, 0.5]]);
    let remarks = |layers: [&[(&'static str, &[f32])]; 2]| Image::decode(&exr(&layers.concat())).unwrap().remarks;
    let plain = all(["R", "G", "B", "A"]);
    assert!(remarks([&combined, &[]]).is_empty() && remarks([&plain, &[("depth.Z", a)]]).is_empty());
    for layers in [[&others[..], &combined[..]], [&others[..], &plain[..]]] {
        assert_eq!(remarks(layers), ["has other layers of colours, which are left out"]);
    }
    assert!(refused(&exr(&[("X", r), ("Y", g), ("Z", b)])).contains("CIE X, Y and Z"));
    let two = others.map(|(name, values)| (name.replace("DiffCol", "Glossy"), values));
    let two: Vec<(&str, &[f32])> = two.iter().map(|(name, values)| (name.as_str(), *values)).collect();
    let why = refused(&exr(&[&others[..], &two].concat()));
    assert!(why.contains("View.DiffCol") && why.contains("View.Glossy") && why.contains("several"), "{why}");
}

/// By the definition: RY = (R − Y)/Y and BY = (B − Y)/Y with Y = 0.2126 R + 0.7152 G + 0.0722 B.
#[test]
fn luminance_and_chroma_become_colours() {
    let colors = [[1.0_f32, 2.0, 3.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.25, 0.25, 0.25]];
    let y = colors.map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b);
    let chroma =
        |at: usize| std::array::from_fn::<f32, 4, _>(|i| if y[i] > 0.0 { colors[i][at] / y[i] - 1.0 } else { 0.0 });
    let found = floats(&exr(&[("Y", &y), ("RY", &chroma(0)), ("BY", &chroma(2))]));
    for (found, expected) in found.iter().flat_map(|texel| &texel[..3]).zip(colors.as_flattened()) {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
}

/// Files of 12 × 40 texels that OpenEXR's own `RgbaOutputFile` wrote with chroma for each 2 × 2 of them; those with alpha
/// have a data window that starts at (2, 4).
const COARSE: [(&str, &[u8]); 8] = [
    ("none", include_bytes!("coarse/none.exr")),
    ("rle", include_bytes!("coarse/rle.exr")),
    ("zips", include_bytes!("coarse/zips.exr")),
    ("zip", include_bytes!("coarse/zip.exr")),
    ("piz", include_bytes!("coarse/piz.exr")),
    ("pxr24", include_bytes!("coarse/pxr24.exr")),
    ("zip with alpha", include_bytes!("coarse/zip_a.exr")),
    ("piz with alpha", include_bytes!("coarse/piz_a.exr")),
];

/// Their colours are linear in place, red and blue by more than 5 % from texel to texel, and so are the samples between those
/// that are stored. The writer's filter takes up to 3.3 % at borders. The last column repeats a chroma, which OpenEXR's own
/// reader shows 11 % wrong.
#[test]
fn coarse_chroma_becomes_colours() {
    for (name, bytes) in COARSE {
        let has_alpha = name.ends_with("alpha");
        let found = floats(bytes);
        assert_eq!(found.len(), 12 * 40);
        for (at, texel) in found.iter().enumerate().filter(|(at, _)| at % 12 < 11) {
            let (x, y) = (at % 12, at / 12);
            let (u, v) = ((x as f32 + 0.5) / 12.0, (y as f32 + 0.5) / 40.0);
            let expected = [0.5 + u, 0.5 + 0.5 * v, 1.5 - u, if has_alpha { 0.25 + 0.5 * u } else { 1.0 }];
            let is_outside = has_alpha && (x < 2 || y < 4);
            let is_near = |(found, value): (&f32, f32)| (found / value - 1.0).abs() < 0.035;
            let holds = if is_outside { *texel == [0.0; 4] } else { texel.iter().zip(expected).all(is_near) };
            assert!(holds, "{name}, texel {x}, {y}: {texel:?}, {expected:?}");
        }
    }
}

#[test]
fn other_samples_are_named() {
    let zip = include_bytes!("coarse/zip.exr");
    let sampling = zip.windows(3).position(|window| window == b"BY\0").unwrap() + 11;
    let mut thirds = zip.to_vec();
    thirds[sampling] = 3;
    let why = refused(&thirds);
    assert!(why.contains("channels BY") && why.contains("R, G and B"), "{why}");
    for bytes in [&include_bytes!("coarse/dwaa.exr")[..], include_bytes!("coarse/dwab.exr")] {
        assert!(refused(bytes).contains("ZIP or PIZ"));
    }
    // A file that ends within a block, and a block that starts at no block's line.
    for length in [zip.len() - 1, zip.len() / 2] {
        assert!(refused(&zip[..length]).contains("cannot be decoded as OpenEXR"));
    }
    let mut moved = zip.to_vec();
    moved[first_block(zip)] = 1;
    assert!(refused(&moved).contains("starts at line 1"));
}

/// The place of the first block of a file with three blocks: the first of the offsets, which end there.
fn first_block(file: &[u8]) -> usize {
    let offset = |at: usize| file.get(at..).and_then(|rest| rest.first_chunk()).map(|bytes| u64::from_le_bytes(*bytes));
    (0..file.len()).find(|&at| offset(at) == Some(at as u64 + 24)).unwrap() + 24
}
