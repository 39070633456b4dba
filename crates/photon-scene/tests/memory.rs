//! The limit on memory of loading: what is reduced or refused, and that no more is allocated than it allows.
#![allow(clippy::unwrap_used, reason = "a test that unwraps fails with the place and the error")]
#![allow(unsafe_code, reason = "an allocator that counts")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

use photon_scene::{
    EnvironmentDesc, LoadOptions, LoadReport, SceneBuilder, SceneError, load_builder, load_builder_with,
};

thread_local! {
    /// Bytes that this thread has allocated, and their peak.
    static COUNT: Cell<(i64, i64)> = const { Cell::new((0, 0)) };
}

fn count(bytes: i64) {
    // A thread that ends has no counter any more.
    let _ = COUNT.try_with(|count| {
        let (now, peak) = count.get();
        count.set((now + bytes, peak.max(now + bytes)));
    });
}

struct Counting;

// SAFETY: all calls go to the system's allocator unchanged; the counter does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The result and the peak of what the thread allocates meanwhile, in bytes.
fn peak<T>(run: impl FnOnce() -> T) -> (T, u64) {
    let (before, _) = COUNT.get();
    COUNT.set((before, before));
    let result = run();
    let (_, peak) = COUNT.get();
    (result, (peak - before) as u64)
}

/// A temporary folder for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("photon-memory-{}-{name}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Each test has a folder of its own; a leftover one does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Bytes of colours in which neighbours differ.
fn texels(side: u32) -> Vec<u8> {
    (0..3 * side * side).map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8).collect()
}

fn png(side: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&texels(side)).unwrap();
    bytes
}

fn webp(side: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = image_webp::WebPEncoder::new(&mut bytes);
    encoder.encode(&texels(side), side, side, image_webp::ColorType::Rgb8).unwrap();
    bytes
}

/// Radiance HDR without runs.
fn hdr(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend((0..width * height).flat_map(|at| [at as u8 | 128, 9, (at / 7) as u8, 128]));
    bytes
}

/// A glTF file of materials `m0`, `m1`, …, each of a triangle and with an image of its own as base colour and in `slot`.
fn gltf(folder: &Folder, images: &[(&str, Vec<u8>)], slot: &str) -> PathBuf {
    let list = |item: &dyn Fn(usize) -> String| (0..images.len()).map(item).collect::<Vec<_>>().join(", ");
    for (name, bytes) in images {
        folder.write(name, bytes);
    }
    let texture = |at: usize| format!(r#""baseColorTexture": {{"index": {at}}}{}"#, slot.replace('#', &at.to_string()));
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    folder.write("a.bin", corners.map(f32::to_le_bytes).as_flattened());
    let mesh = r#""primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": "#;
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 60, "uri": "a.bin"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 24}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
                      {{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}}],
        "images": [{}], "textures": [{}], "materials": [{}], "meshes": [{}], "nodes": [{}], "scenes": [{{"nodes": [{}]}}]}}"#,
        list(&|at| format!(r#"{{"uri": "{}"}}"#, images[at].0)),
        list(&|at| format!(r#"{{"source": {at}}}"#)),
        list(&|at| format!(r#"{{"name": "m{at}", "pbrMetallicRoughness": {{{}}}}}"#, texture(at))),
        list(&|at| format!("{{{mesh}{at}}}]}}")),
        list(&|at| format!(r#"{{"mesh": {at}}}"#)),
        list(&|at| at.to_string()),
    );
    folder.write("scene.gltf", json)
}

fn eight(folder: &Folder, side: u32) -> PathBuf {
    let names: Vec<String> = (0..8).map(|at| format!("image{at}.png")).collect();
    let images: Vec<(&str, Vec<u8>)> = names.iter().map(|name| (name.as_str(), png(side))).collect();
    gltf(folder, &images, "")
}

fn within(path: &Path, bytes: u64) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_builder_with(path, None, &LoadOptions::default().with_memory(Some(bytes)))
}

/// Widths of the textures.
fn sides(builder: SceneBuilder) -> Vec<u32> {
    let scene = builder.build().unwrap_or_else(|error| panic!("{error}"));
    scene.view().shading.textures.iter().map(|image| image.width).collect()
}

#[test]
fn a_limit_that_is_not_reached_changes_nothing() {
    let folder = Folder::new("same");
    let path = eight(&folder, 64);
    let (free, report) = load_builder(&path, None).unwrap();
    let (limited, same) = within(&path, 1 << 30).unwrap();
    assert_eq!(report, same);
    assert_eq!(sides(free), [64; 8]);
    assert_eq!(sides(limited), [64; 8]);
}

/// 8 × 256² texels of 4 bytes are 2 MiB, which 4 MiB hold with an image that is decoded; 2 MiB do not, but hold a quarter.
#[test]
fn textures_are_reduced_and_counted() {
    let folder = Folder::new("reduced");
    let path = eight(&folder, 256);
    let (full, report) = within(&path, 4 << 20).unwrap();
    assert!(report.is_exact(), "{report}");
    assert_eq!(sides(full), [256; 8]);
    let (half, report) = within(&path, 2 << 20).unwrap();
    assert_eq!(sides(half), [128; 8]);
    let text = report.to_string();
    assert!(text.contains("the file: 8 of 8 images of textures are reduced") && !report.is_exact(), "{text}");
    for at in 0..8 {
        let line = format!(
            "material 'm{at}': textures are reduced: texture {at} 'image{at}.png' from \
                            256 × 256 texels to 128 × 128"
        );
        assert!(text.contains(&line), "{line}\n{text}");
    }
}

/// V9: images of 4096² texels, columns of black and white of one bit each; halved while they are read, to the mean in
/// linear light, without ever being whole in memory.
#[test]
fn large_images_are_halved_in_linear_light() {
    let side = 4096;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let rows = vec![0b0101_0101; (side * side / 8) as usize];
    encoder.write_header().unwrap().write_image_data(&rows).unwrap();
    let folder = Folder::new("large");
    let path = gltf(&folder, &[("a.png", bytes.clone()), ("b.png", bytes)], "");
    let limit = 60 << 20;
    let (result, peak) = peak(|| within(&path, limit));
    let (builder, report) = result.unwrap();
    assert!(peak <= limit + DESCRIPTIONS, "{peak}");
    let text = report.to_string();
    assert_eq!(text.matches("from 4096 × 4096 texels to 2048 × 2048 texels").count(), 2, "{text}");
    let scene = builder.build().unwrap();
    // Of one colour now, of which there is no texture: ½, whose code is 188.
    let half = ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4) as f32;
    assert!(scene.view().shading.textures.is_empty());
    assert!(scene.view().materials.iter().all(|material| (material.albedo[0] - half).abs() < 1e-6));
}

/// Cut-outs: columns of opaque red and transparent green. Halved for a material whose alpha is in use they are red, half of
/// it there; for an opaque one, the mean of both.
#[test]
fn cut_outs_keep_the_colours_of_what_is_there() {
    let side = 1024_usize;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side as u32, side as u32);
    encoder.set_color(png::ColorType::Rgba);
    let texel = |at: usize| match at {
        // A corner that differs, so that the image is not of one colour.
        0 => [0, 0, 255, 255],
        _ if at.is_multiple_of(2) => [255, 0, 0, 255],
        _ => [0, 255, 0, 0],
    };
    let texels: Vec<u8> = (0..side * side).flat_map(texel).collect();
    encoder.write_header().unwrap().write_image_data(&texels).unwrap();
    let folder = Folder::new("leaves");
    let path = gltf(&folder, &[("leaf.png", bytes)], "");
    let opaque = fs::read_to_string(&path).unwrap();
    folder.write("a.mtl", "newmtl m\nmap_Kd leaf.png\nmap_d leaf.png\n");
    let obj = folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    let last = |path: &Path| {
        let (builder, report) = within(path, 3 << 20).unwrap();
        assert!(report.to_string().contains("reduced"), "{report}");
        let scene = builder.build().unwrap();
        let image = &scene.view().shading.textures[0];
        assert!(image.width < 1024);
        image.texels.last().unwrap().to_le_bytes()
    };
    assert_eq!(last(&path), [188, 188, 0, 128]);
    for mode in ["BLEND", "MASK"] {
        fs::write(&path, opaque.replace(r#""name": "m0","#, &format!(r#""name": "m0", "alphaMode": "{mode}","#)))
            .unwrap();
        assert_eq!(last(&path), [255, 0, 0, 128], "{mode}");
    }
    assert_eq!(last(&obj), [255, 0, 0, 128]);
}

#[test]
fn what_does_not_fit_is_named_with_its_sizes() {
    let folder = Folder::new("refused");
    let path = eight(&folder, 256);
    let error = within(&path, 300 << 10).map(drop).unwrap_err();
    assert!(matches!(error, SceneError::Memory { limit: 307_200, .. }), "{error:?}");
    let text = error.to_string();
    for part in
        ["scene.gltf", "texture 0 'image0.png' of material 'm0' (256 × 256 texels)", "300.0 KiB", "allow more memory"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    // The file itself.
    let text = within(&path, 10).map(drop).unwrap_err().to_string();
    assert!(text.contains("scene.gltf: the file needs") && text.contains("10 bytes are left"), "{text}");
}

/// The images are hardly read, so that the error takes the memory of one start of a file and no more.
#[test]
fn an_error_comes_before_the_memory_is_taken() {
    let folder = Folder::new("early");
    let path = eight(&folder, 512);
    let (result, peak) = peak(|| within(&path, 300 << 10));
    assert!(matches!(result, Err(SceneError::Memory { .. })), "{:?}", result.map(|(builder, _)| sides(builder)));
    assert!(peak < 200 << 10, "{peak}");
}

/// The descriptions of materials, which the limit does not count: 8 of a few kB.
const DESCRIPTIONS: u64 = 8 * 5 * 1024;

/// What was allocated at the peak is within the limit, for each format and for images that are used in two ways.
#[test]
fn no_more_is_allocated_than_the_limit() {
    let jpeg = |name: &str| fs::read(Path::new("src/load/image/tests").join(name)).unwrap();
    let many = |extension: &str, bytes: &[u8]| -> Vec<(String, Vec<u8>)> {
        (0..8).map(|at| (format!("image{at}.{extension}"), bytes.to_vec())).collect()
    };
    let both = r##", "metallicRoughnessTexture": {"index": #}"##;
    let mut outcomes = Vec::new();
    for (name, bytes) in [
        ("png", png(256)),
        ("webp", webp(256)),
        ("hdr", hdr(256, 256)),
        ("baseline.jpg", jpeg("baseline.jpg")),
        ("progressive.jpg", jpeg("progressive.jpg")),
    ] {
        for slot in ["", both] {
            let folder = Folder::new(&format!("peak-{name}-{}", slot.len()));
            let images = many(name, &bytes);
            let images: Vec<(&str, Vec<u8>)> =
                images.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
            let path = gltf(&folder, &images, slot);
            for kilobytes in [300, 1200, 2400, 4800, 9600, 19_200] {
                let limit = kilobytes << 10;
                let (result, peak) = peak(|| within(&path, limit));
                let kind = match &result {
                    Ok((_, report)) if report.is_exact() => "whole",
                    Ok(_) => "reduced",
                    Err(_) => "refused",
                };
                assert!(peak <= limit + DESCRIPTIONS, "{name} {slot}: {peak} bytes within {limit}, {kind}");
                outcomes.push((name, kind));
            }
        }
    }
    for outcome in [("png", "refused"), ("png", "reduced"), ("png", "whole"), ("hdr", "reduced"), ("webp", "whole")] {
        assert!(outcomes.contains(&outcome), "{outcome:?}: {outcomes:?}");
    }
}

#[test]
fn textures_of_mtl_are_reduced_or_refused_too() {
    let folder = Folder::new("mtl");
    let (mut library, mut faces) = (String::new(), String::new());
    for at in 0..4 {
        folder.write(&format!("color{at}.png"), png(256));
        library += &format!("newmtl m{at}\nmap_Kd color{at}.png\nmap_d color{at}.png\n");
        faces += &format!("usemtl m{at}\nf 1/1 2/2 3/3\n");
    }
    folder.write("rough.png", png(256));
    library += "newmtl rough\nmap_Pr rough.png\nnorm rough.png\n";
    folder.write("a.mtl", library);
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1";
    let path = folder.write("a.obj", format!("mtllib a.mtl\n{corners}\n{faces}"));
    let mut kinds = Vec::new();
    for kilobytes in [400, 2000, 8000] {
        let limit = kilobytes << 10;
        let (result, peak) = peak(|| within(&path, limit));
        assert!(peak <= limit + DESCRIPTIONS, "{peak} bytes within {limit}");
        kinds.push(match result {
            Ok((builder, report)) => {
                let text = report.to_string();
                let line = "material 'm2': textures are reduced: map_Kd color2.png from 256 × 256 texels";
                assert_eq!(text.contains(line), text.contains("reduced"), "{text}");
                sides(builder)[0]
            }
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains("a.obj: ")
                        && text.contains("of material '")
                        && text.contains("and another (256 × 256"),
                    "{text}"
                );
                0
            }
        });
    }
    assert!(kinds[0] == 0 && [128, 64].contains(&kinds[1]) && kinds[2] == 256, "{kinds:?}");
}

#[test]
fn meshes_and_environments_count() {
    let folder = Folder::new("mesh");
    let positions: String = (0..3000).map(|at| format!("{at} 0 0\n")).collect();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3000\nproperty float x\nproperty float y\nproperty float z\nend_header\n{positions}"
    );
    let path = folder.write("a.ply", ply);
    let text = within(&path, 300 << 10).map(drop).unwrap_err().to_string();
    assert!(text.contains("a.ply: reading its vertices and faces needs"), "{text}");
    let (result, peak) = peak(|| within(&path, 4 << 20));
    assert!(result.is_ok() && peak <= 4 << 20, "{peak}");
    let mut report = LoadReport::default();
    let path = folder.write("sky.hdr", hdr(362, 181));
    let options = |bytes| LoadOptions::default().with_memory(Some(bytes));
    let text = EnvironmentDesc::read_with(&path, &mut report, &options(3 << 20)).unwrap_err().to_string();
    assert!(text.contains("sky.hdr: the image of the environment needs"), "{text}");
    assert!(EnvironmentDesc::read_with(&path, &mut report, &options(9 << 20)).is_ok());
}

/// The textures get what the meshes leave: 2 MiB of texels and 60,000 vertices, 60000 · (12 + 8) bytes in the file and
/// 60000 · (24 + 16 + 4) in the scene, 3.7 MiB.
#[test]
fn textures_leave_room_for_the_meshes() {
    let folder = Folder::new("geometry");
    let path = eight(&folder, 256);
    let count = 60_000;
    let json = fs::read_to_string(&path).unwrap().replace(r#""count": 3"#, &format!(r#""count": {count}"#));
    let json = json.replace(r#""byteLength": 60"#, &format!(r#""byteLength": {}"#, 20 * count));
    let json = json.replace(r#""byteLength": 36"#, &format!(r#""byteLength": {}"#, 12 * count));
    let json = json.replace(
        r#""byteOffset": 36, "byteLength": 24"#,
        &format!(r#""byteOffset": {}, "byteLength": {}"#, 12 * count, 8 * count),
    );
    // One node of the eight.
    let json = json.replace(r#""nodes": [0, 1, 2, 3, 4, 5, 6, 7]"#, r#""nodes": [0]"#);
    fs::write(&path, json).unwrap();
    let corners = (0..count).flat_map(|at| [at as f32, (at % 7) as f32, 0.0]).chain((0..2 * count).map(|_| 0.5));
    folder.write("a.bin", corners.flat_map(f32::to_le_bytes).collect::<Vec<u8>>());
    let mut kinds = Vec::new();
    for kilobytes in [3000, 5000, 6000, 9000] {
        match within(&path, kilobytes << 10) {
            Ok((_, report)) => kinds.push(if report.is_exact() { "whole" } else { "reduced" }),
            Err(error) => {
                let text = error.to_string();
                assert!(text.contains("the geometry needs") || text.contains("of geometry,"), "{text}");
                kinds.push("refused");
            }
        }
    }
    assert_eq!(kinds, ["refused", "reduced", "reduced", "whole"]);
}

/// A PNG with so many bytes of another chunk before its texels.
fn with_chunk(png: &[u8], bytes: usize) -> Vec<u8> {
    // The signature and IHDR.
    let (start, rest) = png.split_at(33);
    let mut chunk = b"prVt".to_vec();
    chunk.resize(4 + bytes, 7);
    let sum = chunk.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (0xEDB8_8320 * (sum & 1)))
    });
    [start, &(bytes as u32).to_be_bytes(), &chunk, &(!sum).to_be_bytes(), rest].concat()
}

/// Images whose size is not known are not decoded, and hardly read.
#[test]
fn an_image_without_a_header_takes_no_memory() {
    let unknown = vec![b'x'; 40 << 20];
    let far = with_chunk(&png(64), 40 << 20);
    for (bytes, cause) in [(unknown, "of an unknown format"), (far, "no header within its first 16.0 MiB")] {
        let folder = Folder::new(&format!("header-{}", bytes[0]));
        folder.write("color.png", &bytes);
        folder.write("a.mtl", "newmtl m\nmap_Kd color.png\n");
        let obj = folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
        for path in [gltf(&folder, &[("color.png", bytes.clone())], ""), obj] {
            let (result, peak) = peak(|| within(&path, 20 << 20));
            let (_, report) = result.unwrap();
            assert!(report.to_string().contains(cause), "{report}");
            assert!(peak < 20 << 20, "{peak}");
        }
        let sky = EnvironmentDesc::read_with(
            &folder.0.join("color.png"),
            &mut LoadReport::default(),
            &LoadOptions::default().with_memory(Some(20 << 20)),
        );
        let text = sky.unwrap_err().to_string();
        assert!(text.contains(cause), "{text}");
    }
    // A megabyte before the header is found.
    let folder = Folder::new("header-near");
    let path = gltf(&folder, &[("color.png", with_chunk(&png(64), 1 << 20))], "");
    assert!(within(&path, 20 << 20).unwrap().1.is_exact());
}

/// Files with few kinds of statements, of which each byte becomes as many bytes as possible.
#[test]
fn dense_text_and_binary_files_are_counted() {
    let folder = Folder::new("dense");
    let ascii = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    let faces = format!("255{}\n", " 0".repeat(255)).repeat(400);
    let list = "element face 400\nproperty list uchar uchar vertex_indices\nend_header\n";
    let mut binary = format!("{}{list}", ascii.replace("ascii", "binary_little_endian")).into_bytes();
    binary.extend([0; 12]);
    for _ in 0..400 {
        binary.push(255);
        binary.extend([0; 255]);
    }
    let values = "0,".repeat(100_000) + "0";
    let nodes = "{},".repeat(20_000) + "{}";
    let facet = "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet ";
    let mut stl = [&[b' '; 80][..], &4000_u32.to_le_bytes()].concat();
    stl.extend((0..4000 * 25_u32).flat_map(|at| [at as u8, 60]));
    let files = [
        folder.write("text.stl", format!("solid a\n{}endsolid", facet.repeat(4000))),
        folder.write("facets.stl", format!("solid {}\nendsolid", "facet ".repeat(40_000))),
        folder.write("binary.stl", stl),
        folder.write("text.ply", format!("{ascii}{list}0 0 0\n{faces}")),
        folder.write("binary.ply", binary),
        folder.write("fan.obj", format!("v 0 0 0\nf{}\n", " 1".repeat(200_000))),
        folder.write("faces.obj", format!("v 0 0 0\nvn 0 0 1\nvt 0 0\n{}", "f 1/1/1 1/1/1 1/1/1\n".repeat(20_000))),
        folder.write("vertices.obj", "v 0 0 0 0 0 0\n".repeat(20_000)),
        folder.write("values.gltf", format!(r#"{{"asset": {{"version": "2.0"}}, "extras": [{values}]}}"#)),
        folder.write("nodes.gltf", format!(r#"{{"asset": {{"version": "2.0"}}, "nodes": [{nodes}]}}"#)),
    ];
    for path in files {
        let mut kinds = Vec::new();
        for kilobytes in [10_u64, 200, 1000, 4000, 8000, 16_000, 32_000, 64_000] {
            let limit = kilobytes << 10;
            let (result, peak) = peak(|| within(&path, limit));
            assert!(peak <= limit + DESCRIPTIONS, "{}: {peak} bytes within {limit}", path.display());
            kinds.push(result.is_ok());
        }
        assert!(!kinds[0] && kinds[7] && kinds.is_sorted(), "{}: {kinds:?}", path.display());
    }
    // The materials, and what overrides them.
    folder.write("large.mtl", "# \n".repeat(1 << 20));
    let path = folder.write("large.obj", "mtllib large.mtl\n");
    let text = within(&path, 2 << 20).map(drop).unwrap_err().to_string();
    assert!(text.contains("large.mtl: the file needs"), "{text}");
    let path = folder.write("large.toml", "# \n".repeat(1 << 20));
    let options = LoadOptions::default().with_memory(Some(2 << 20));
    let text = photon_scene::Overrides::read_with(&path, &options).map(drop).unwrap_err().to_string();
    assert!(text.contains("large.toml: the file needs"), "{text}");
}
