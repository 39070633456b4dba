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
fn hdr(side: u32) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n\n-Y {side} +X {side}\n").into_bytes();
    bytes.extend((0..side * side).flat_map(|at| [at as u8 | 128, 9, (at / 7) as u8, 128]));
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

/// 8 × 256² texels of 4 bytes are 2 MiB: they are halved once for 1 MiB, and twice for less than what remains.
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
            "material 'm{at}': textures are reduced for want of memory: texture {at} 'image{at}.png' from \
                            256 × 256 texels to 128 × 128"
        );
        assert!(text.contains(&line), "{line}\n{text}");
    }
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
        ("hdr", hdr(256)),
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
                let line =
                    "material 'm2': textures are reduced for want of memory: map_Kd color2.png from 256 × 256 texels";
                assert_eq!(text.contains(line), text.contains("reduced"), "{text}");
                sides(builder)[0]
            }
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains("a.obj: ")
                        && text.contains("of material '")
                        && text.contains("and 1 others (256 × 256"),
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
    assert!(text.contains("a.ply: 3000 elements 'vertex' needs"), "{text}");
    let (result, peak) = peak(|| within(&path, 4 << 20));
    assert!(result.is_ok() && peak <= 4 << 20, "{peak}");
    let mut report = LoadReport::default();
    let path = folder.write("sky.hdr", hdr(256));
    let options = |bytes| LoadOptions::default().with_memory(Some(bytes));
    let text = EnvironmentDesc::read_with(&path, &mut report, &options(3 << 20)).unwrap_err().to_string();
    assert!(text.contains("sky.hdr: the image of the environment needs"), "{text}");
    assert!(EnvironmentDesc::read_with(&path, &mut report, &options(9 << 20)).is_ok());
}
