//! Any glTF file, with several limits on memory: an error with a message, or a valid scene.
#![no_main]

use photon_scene::LoadOptions;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    // Both containers: the binary one is recognised by its first bytes.
    let name = if data.starts_with(b"glTF") { "a.glb" } else { "a.gltf" };
    let options = LoadOptions::default().with_memory([None, Some(16 << 10), Some(1 << 20)][data.len() % 3]);
    let loaded = photon_scene::load_builder_with(&photon_fuzz::file(name, data), None, &options);
    photon_fuzz::check(loaded.and_then(|(builder, report)| Ok((builder.build()?, report))));
});
