use std::io::Write as _;

use super::super::{nvdb, vol};
use super::*;

/// A file of Mitsuba, with `data` behind the header.
fn vol_file(encoding: i32, cells: [i32; 3], channels: i32, corners: [f32; 6], data: &[u8]) -> Vec<u8> {
    let mut file = b"VOL\x03".to_vec();
    for word in [encoding, cells[0], cells[1], cells[2], channels] {
        file.extend(word.to_le_bytes());
    }
    for part in corners {
        file.extend(part.to_le_bytes());
    }
    file.extend(data);
    file
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

const CORNERS: [f32; 6] = [-1.0, 0.0, 1.0, 3.0, 2.0, 4.0];

fn read(name: &str, bytes: &[u8], memory: Option<u64>) -> Result<GridDesc, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    GridDesc::read(&path, &LoadOptions::default().with_memory(memory))
}

#[test]
fn vol_has_densities_of_three_encodings_and_a_box() {
    let data = floats(&[0.0, 0.25, 0.5, 1.0, 2.0, 3.0]);
    let grid = read("a.vol", &vol_file(1, [1, 2, 3], 1, CORNERS, &data), None).unwrap();
    assert_eq!((grid.cells, &*grid.densities), ([1, 2, 3], &[0.0, 0.25, 0.5, 1.0, 2.0, 3.0][..]));
    let expected = [[4.0, 0.0, 0.0, -1.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 3.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
    assert_eq!(grid.transform, expected);
    let halves: Vec<u8> = [0x3C00_u16, 0x3800].iter().flat_map(|half| half.to_le_bytes()).collect();
    let grid = read("a.vol", &vol_file(2, [2, 1, 1], 1, [0.0; 6], &halves), None).unwrap();
    assert_eq!(&*grid.densities, &[1.0, 0.5]);
    // Without a box, the unit cube.
    assert_eq!(grid.transform, GridDesc::new([1; 3], [0.0]).transform);
    let grid = read("a.vol", &vol_file(3, [1, 1, 2], 1, CORNERS, &[255, 51]), None).unwrap();
    assert_eq!(&*grid.densities, &[1.0, 0.2]);
}

/// Each error has the file, what is wrong, and a remedy.
#[test]
fn files_are_refused_with_their_fault() {
    let two = floats(&[1.0, 2.0]);
    let good = vol_file(1, [2, 1, 1], 1, CORNERS, &two);
    let mut old = good.clone();
    old[3] = 2;
    let mut version = nvdb_file("density", 0);
    version[8..12].copy_from_slice(&(29_u32 << 21).to_le_bytes());
    let with = |at: usize, word: u32| {
        let mut file = nvdb_file("density", 0);
        file[at..at + 4].copy_from_slice(&word.to_le_bytes());
        file
    };
    let body = (HEADER + METADATA + 7) as usize;
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("a.vol", good[..40].to_vec(), "ends after 40 bytes"),
        ("a.vol", good[..52].to_vec(), "4 bytes of densities, too few for [2, 1, 1] cells"),
        ("a.vol", b"VDB\x03".to_vec(), "does not begin with VOL"),
        ("a.vol", old, "version 2 instead of 3"),
        ("a.vol", vol_file(7, [2, 1, 1], 1, CORNERS, &two), "encoding 7"),
        ("a.vol", vol_file(1, [2, 1, 1], 3, CORNERS, &two), "3 channels"),
        ("a.vol", vol_file(1, [-2, 1, 1], 1, CORNERS, &two), "[0, 1, 1] cells"),
        ("a.vol", vol_file(1, [i32::MAX; 3], 1, CORNERS, &two), "too few for [2147483647"),
        ("a.vol", vol_file(1, [2, 1, 1], 1, CORNERS, &floats(&[1.0, f32::NAN])), "density NaN in cell 1"),
        ("a.vol", vol_file(1, [2, 1, 1], 1, CORNERS, &floats(&[-1.0, 0.0])), "density -1 in cell 0"),
        ("a.vdb", good.clone(), "unknown format"),
        ("a.nvdb", good, "is a grid of densities of Mitsuba"),
        ("a.nvdb", b"NanoDB00".to_vec(), "does not begin with NanoVDB0"),
        ("a.nvdb", version, "version 29"),
        ("a.nvdb", nvdb_file("density", 0)[..5000].to_vec(), "ends within its tables"),
        ("a.nvdb", with(HEADER as usize + 32, 6), "type 6"),
        ("a.nvdb", with(HEADER as usize + 168, 2), "BLOSC"),
        ("a.nvdb", with(body + 632, 1), "level set"),
        // Active voxels far apart, in a small file.
        ("a.nvdb", with(body + 672 + 64 + 12, 1 << 30), "cells"),
    ];
    for (name, bytes, fault) in cases {
        let text = read(name, &bytes, None).unwrap_err().to_string();
        assert!(text.contains(name) && text.contains(fault) && text.contains(';'), "{fault}: {text}");
    }
    let needs = read("a.vol", &vol_file(1, [100, 1, 1], 1, CORNERS, &floats(&[1.0; 100])), Some(800)).unwrap_err();
    assert!(matches!(needs, SceneError::Memory { .. }), "{needs}");
}

const HEADER: u64 = 16;
const METADATA: u64 = 176;

/// A tree with one root tile at −4096 of density 3, and one node of each level: active voxels from (−2, 0, 0) to (9, 8, 1),
/// the lower node's tile at y = 8 of density 5, and the leaf at the origin with the densities 100 z + 10 y + x over 1000.
fn tree() -> Vec<u8> {
    let (root, upper) = (672 + 64, 672 + 64 + 64 + 2 * 32);
    let lower = upper + 270_400;
    let leaf = lower + 33_856;
    let mut file = vec![0_u8; leaf + 2144];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"NanoVDB0");
    put(16, &(32_u32 << 21 | 3 << 10).to_le_bytes());
    for axis in 0..3 {
        put(384 + 32 * axis, &0.5_f64.to_le_bytes());
        put(528 + 8 * axis, &(axis as f64).to_le_bytes());
    }
    put(632, &2_u32.to_le_bytes());
    put(636, &1_u32.to_le_bytes());
    put(672 + 24, &64_u64.to_le_bytes());
    for (at, coordinate) in [-2_i32, 0, 0, 9, 8, 1].into_iter().enumerate() {
        put(root + 4 * at, &coordinate.to_le_bytes());
    }
    put(root + 24, &2_u32.to_le_bytes());
    // x of −4096 is 0xFFFFF in the upper 20 bits.
    put(root + 64, &(0xF_FFFF_u64 << 42).to_le_bytes());
    put(root + 64 + 20, &3.0_f32.to_le_bytes());
    put(root + 96 + 8, &((upper - root) as u64).to_le_bytes());
    put(upper + 4128, &1_u64.to_le_bytes());
    put(upper + 8256, &((lower - upper) as u64).to_le_bytes());
    put(lower + 544, &1_u64.to_le_bytes());
    put(lower + 1088, &((leaf - lower) as u64).to_le_bytes());
    // Children are in the order of x, y, z with 16 along each: y = 8 is number 16.
    put(lower + 1088 + 8 * 16, &5.0_f32.to_le_bytes());
    for x in 0..8_usize {
        for y in 0..8_usize {
            for z in 0..8_usize {
                let density = (100 * z + 10 * y + x) as f32 / 1000.0;
                put(leaf + 96 + 4 * (64 * x + 8 * y + z), &density.to_le_bytes());
            }
        }
    }
    file
}

/// A file with that tree.
fn nvdb_file(name: &str, codec: u16) -> Vec<u8> {
    let tree = tree();
    let body = if codec == 1 {
        let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        packer.write_all(&tree).unwrap();
        let packed = packer.finish().unwrap();
        [&(packed.len() as u64).to_le_bytes(), &packed[..]].concat()
    } else {
        tree.clone()
    };
    let mut file = b"NanoVDB0".to_vec();
    file.extend((32_u32 << 21 | 3 << 10).to_le_bytes());
    file.extend(1_u16.to_le_bytes());
    file.extend(codec.to_le_bytes());
    let mut metadata = vec![0_u8; METADATA as usize];
    metadata[0..8].copy_from_slice(&(tree.len() as u64).to_le_bytes());
    metadata[8..16].copy_from_slice(&(body.len() as u64).to_le_bytes());
    metadata[32..36].copy_from_slice(&1_u32.to_le_bytes());
    metadata[136..140].copy_from_slice(&(name.len() as u32).to_le_bytes());
    metadata[168..170].copy_from_slice(&codec.to_le_bytes());
    file.extend(metadata);
    file.extend(name.as_bytes());
    file.extend(body);
    file
}

#[test]
fn nvdb_has_the_densities_of_leaves_and_tiles() {
    let raw = {
        let mut raw = tree();
        raw[..8].copy_from_slice(b"NanoVDB1");
        raw
    };
    for bytes in [nvdb_file("smoke", 0), nvdb_file("density", 1), raw] {
        let grid = read("a.nvdb", &bytes, None).unwrap();
        assert_eq!(grid.cells, [12, 9, 2]);
        for (index, &density) in grid.densities.iter().enumerate() {
            let [x, y, z] = [index % 12, index / 12 % 9, index / 108];
            let expected = match (x, y) {
                (0 | 1, _) => 3.0,
                (2..=9, 0..=7) => (100 * z + 10 * y + (x - 2)) as f32 / 1000.0,
                (2..=9, 8) => 5.0,
                _ => 0.0,
            };
            assert_eq!(density, expected, "{x} {y} {z}");
        }
        // Voxels of 0.5 whose centres are at the integers, and a shift by (0, 1, 2).
        let at = |row: usize| (grid.transform[row][row], grid.transform[row][3]);
        assert_eq!([at(0), at(1), at(2)], [(6.0, -1.25), (4.5, 0.75), (1.0, 1.75)]);
    }
}

/// Cut or changed anywhere, files are refused or have valid densities.
#[test]
fn damaged_files_do_no_harm() {
    let budget = Budget::new(&LoadOptions::default().with_memory(Some(1 << 24)));
    let [plain, packed] = [nvdb_file("density", 0), nvdb_file("density", 1)];
    let volume = vol_file(1, [2, 1, 1], 1, CORNERS, &floats(&[1.0, 2.0]));
    for cut in (0..packed.len()).step_by(7) {
        assert!(nvdb::parse(&packed[..cut], &budget).is_err());
    }
    for cut in 0..volume.len() {
        assert!(vol::parse(&volume[..cut], &budget).is_err());
    }
    let mut numbers = photon_core::random::SplitMix64(9);
    for _ in 0..400 {
        let mut file = plain.clone();
        // In headers, the root, and the first words of nodes.
        let at = (numbers.word() % 1200) as usize;
        file[at] ^= 1 << (numbers.word() % 8);
        let _ = nvdb::parse(&file, &Budget::new(&LoadOptions::default().with_memory(Some(1 << 24))));
    }
}
